"""What a study costs beside its runs: the ledger's time a run, and the coordinator's memory.

    python benchmarks/studying.py [--runs 10000]

All runs of a study are handed back at once with a row made beforehand, so that what is measured is the
claim, the row and the two transactions. Then a few hundred real runs, of a planner that takes next to no
time, each in a process of its own.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Generator, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import psutil

from msmrta_opt.isolation import Limits
from msmrta_opt.studies.ledger import Ledger
from msmrta_opt.studies.perform import perform
from msmrta_opt.studies.runner import run_study
from msmrta_opt.studies.runs import Run, runs
from msmrta_opt.studies.specification import Study

REAL_RUNS = 300
STUDY = """
title = "Tiny runs"
[[instances]]
maps = "map0"
robots = 2
victims = 2
[[planners]]
planner = "random"
seed = {seeds}
"""


def memory() -> float:
    """MiB of resident memory of this process."""
    return float(psutil.Process().memory_info().rss) / 2**20


def study_of(n_runs: int, folder: Path) -> Study:
    path = folder / f"{n_runs}.toml"
    path.write_text(STUDY.format(seeds=list(range(n_runs))), encoding="utf-8")
    return Study.read(path)


def ledger_alone(n_runs: int, folder: Path) -> None:
    study = study_of(n_runs, folder)
    todo = runs(study)
    made = perform(todo[0])

    def execute(waiting: Iterable[Run], _: Limits) -> Generator[tuple[Run, Any], None, None]:
        for run in waiting:
            yield run, replace(made, key=run.key, run=run.run)

    tenth = n_runs // 10
    parts, memories = [], []
    with Ledger(study.ledger) as ledger:
        began = time.perf_counter()
        for n, _ in enumerate(run_study(study, todo, ledger, execute=execute), start=1):
            if n % tenth == 0:
                parts.append((time.perf_counter() - began) / tenth)
                memories.append(memory())
                began = time.perf_counter()
    print(
        f"ledger, {n_runs} runs: {statistics.median(parts) * 1e3:.2f} ms a run"
        f" (tenths: {min(parts) * 1e3:.2f} to {max(parts) * 1e3:.2f}); memory"
        f" {memories[0]:.0f} MiB after the first tenth, {memories[-1]:.0f} MiB after the last;"
        f" file {study.ledger.stat().st_size / n_runs / 1024:.1f} KiB a run"
    )


def real_runs(folder: Path) -> None:
    study = study_of(REAL_RUNS, folder)
    todo = runs(study)
    for jobs in (1, 2):
        study.ledger.unlink(missing_ok=True)
        with Ledger(study.ledger) as ledger:
            results = run_study(study, todo, ledger, jobs=jobs)
            next(results)  # the first loads the libraries
            began = time.perf_counter()
            n = sum(1 for _ in results)
            each = (time.perf_counter() - began) / n
        print(f"{n} real runs, each in its own process, --jobs {jobs}: {each * 1e3:.1f} ms a run")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10_000)
    with tempfile.TemporaryDirectory() as folder:
        ledger_alone(parser.parse_args().runs, Path(folder))
        real_runs(Path(folder))


if __name__ == "__main__":
    main()
