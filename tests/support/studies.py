"""Studies for tests, and a session of one that says which runs it has kept."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from msmrta_opt.isolation import Worker
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.maps import write_map
from msmrta_opt.studies import comparison, runner
from msmrta_opt.studies.ledger import Ledger
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.runner import run_study
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study


def write_study(folder: Path, text: str, name: str = "study.toml") -> Path:
    """A study file in `folder`, beside an open map of 4×4 cells."""
    write_map(GridMap([[True] * 4] * 4, name="open"), folder / "open.map")  # type: ignore[arg-type]
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def many_runs(folder: Path, n_seeds: int) -> Path:
    """A study of `n_seeds` tiny runs."""
    seeds = list(range(n_seeds))
    return write_study(
        folder,
        f"""
        title = "Many tiny runs"
        [[instances]]
        maps = "open.map"
        robots = 2
        victims = 2
        [[planners]]
        planner = "random"
        seed = {seeds}
        """,
    )


def do(path: Path, **options: object) -> list[Record]:
    """Run the study at `path` to its end; returns what was done now."""
    study = Study.read(path)
    with Ledger(study.ledger) as ledger:
        return list(run_study(study, runs(study), ledger, **options))  # type: ignore[arg-type]


def kept(path: Path) -> list[Record]:
    """The ledger of the study at `path`."""
    with Ledger(Study.read(path).ledger, read_only=True) as ledger:
        return list(ledger.records())


@contextmanager
def solved_here() -> Iterator[None]:
    """Solves and runs are done in this process: quicker, and what comes of them is the same."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (comparison, runner):
            patch.setattr(module, "locally", lambda jobs=1: runner.here)
        yield


STOPPED = "stopped"
"""What a session says when it waits to be killed."""


def stop_at(step: str, number: int) -> None:
    """Wait for ever at a step of a session, the `number`-th time that it comes there."""
    homes: dict[str, tuple[type, str]] = {
        "open": (Ledger, "keep_missions"),
        "claim": (Ledger, "claim"),
        "call": (Worker, "__init__"),
        "add": (Ledger, "add"),
        "insert": (Ledger, "_execute"),
        "commit": (Ledger, "add"),
    }
    home, name = homes[step]
    original, count = getattr(home, name), 0

    def stopping(self: object, *arguments: object, **options: object) -> object:
        nonlocal count
        if step == "insert" and "INSERT OR IGNORE INTO runs" not in str(arguments[0]):
            return original(self, *arguments, **options)
        count += 1
        if step == "add" and count == number:
            wait()
        done = original(self, *arguments, **options)
        if count == number:
            wait()
        return done

    def wait() -> None:
        print(STOPPED, flush=True)
        sys.stdin.read()

    setattr(home, name, stopping)


if __name__ == "__main__":
    # A session that can be killed: it prints the key of each run once the ledger has it.
    if len(sys.argv) > 2:
        what, how_many = sys.argv[2].split()
        stop_at(what, int(how_many))
    # The planner that makes random plans needs none of the heavy libraries but the one that compiles.
    runner.preload = lambda: ("msmrta_opt.studies.perform", "msmrta_opt.mission.breadth_first")
    study = Study.read(sys.argv[1])
    with (
        Ledger(study.ledger) as ledger,
        closing(run_study(study, runs(study), ledger, jobs=2)) as session,
    ):
        for record in session:
            print(record.key, flush=True)
