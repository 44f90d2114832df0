"""Every command that prints a table: as JSON, and at any width of a terminal, in one run of each."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import re
import struct
import sys
import termios
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from support.commands import commands
from support.studies import solved_here

from msmrta_opt import cli
from msmrta_opt.cli import console, tables
from msmrta_opt.mission.examples import example
from msmrta_opt.planners import plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]
Table = tuple[tuple[Any, ...], dict[str, Any]]

WIDTHS = (60, 80, 100, 120, 200)
STYLE = re.compile("\x1b\\[[0-9;]*m")

COMMANDS: dict[str, tuple[str, ...]] = {
    "instances": ("instances",),
    "planners": ("planners",),
    "solvers": ("solvers",),
    "models": ("models", "corridor"),
    "show": ("show", "cluster_printed", "corridor"),
    "solve": ("solve", "victim_balanced", "two_rooms"),
    "plan": ("plan", "split"),
    "exact": ("exact", "corridor", "--time-limit", "5"),
    "scout": ("scout", "scouted"),
    "tradeoff": ("tradeoff", "two_rooms"),
    "regions": ("tradeoff", "corridor", "--over", "psi,beta"),
    "compare-plans": ("compare-plans", "corridor", "--seconds", "0"),
    "diff-plans": ("diff-plans", "A", "B"),
    "convergence": ("convergence", "C"),
    "workload": ("workload", "A"),
    "study status": ("study", "status", "STUDY"),
    "study run": ("study", "run", "STUDY"),
    "compare": ("compare", "two_rooms", "--solvers", "auto,highs", "--prove"),
    "map": ("map", "FLOOR"),
    "policies": ("policies",),
    "run": ("run", "A"),
    "runs": ("run", "A", "--policy", "keep", "--policy", "repair", "--runs", "3"),
}
"""Lines that print tables; solves and runs are done in this process."""
LINES = {"check", "explain", "diff", "watch", "study export"}
"""Commands with JSON that print lines alone."""
NO_JSON = {
    *("new-model", "new-mission", "generate", "export", "export-plan", "replay", "study report")
}
"""Commands that write a file and print a line that says so."""
DOCUMENTS = {"schema", "checker"}
"""Commands that print a file."""
LISTS = {"instances", "planners", "policies", "solvers", "models", "compare", "workload"}
STUDY = """
title = "one planner"
instances = [{ files = ["corridor", "split"] }]
planners = [{ planner = "random" }]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where A, B and C are plans, and STUDY is a study of which nothing is done."""
    from msmrta_opt.studies.ledger import Ledger

    folder = tmp_path_factory.mktemp("shown")
    for name, planner in (("A", "greedy"), ("B", "msmrta")):
        plan(example("two_rooms"), planner=planner).save(folder / name)
    plan(example("corridor"), planner="exact").save(folder / "C")
    (folder / "STUDY").write_text(STUDY)
    Ledger(folder / "STUDY.sqlite").close()
    (folder / "FLOOR").write_text("type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n")
    return folder


@pytest.fixture(autouse=True, scope="module")
def here() -> Iterator[None]:
    with solved_here():
        yield


def test_every_command_that_prints_a_table_has_json_and_is_tried_here() -> None:
    all_of_them = commands()
    with_json = {name for name, options in all_of_them.items() if "--json" in options}
    assert with_json == (COMMANDS.keys() - {"regions", "runs"}) | LINES
    assert all_of_them.keys() - with_json == NO_JSON | DOCUMENTS


def test_every_command_that_takes_a_formulation_takes_folders_parameters_and_options() -> None:
    all_of_them = commands()
    takes = {name for name, options in all_of_them.items() if "--models" in options}
    chosen = {"model", "model_a", "--model", "--victim-model"}
    named = {name for name, options in all_of_them.items() if chosen & options}
    assert takes - named == {"models", "compare", "check", "new-model"}  # by other arguments
    assert named < takes
    for name in takes - {"new-model"}:
        assert {"--param", "--option"} <= all_of_them[name], name


@pytest.fixture(scope="module")
def shown(folder: Path) -> dict[str, list[Table]]:
    """The tables of each command."""
    found: dict[str, list[Table]] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, words in COMMANDS.items():
            found[name] = []
            for module in (console, tables):
                patch.setattr(module, "table", lambda *a, n=name, **b: found[n].append((a, b)))
            assert cli.run(list(words)) == 0, name
    return found


@contextmanager
def terminal(width: int, patch: pytest.MonkeyPatch) -> Iterator[Callable[[], str]]:
    """A pseudo-terminal of that many columns as standard input and output; gives what it shows."""
    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 50, width, 0, 0))
    kept = os.dup(0)
    os.dup2(follower, 0)  # whose size is asked for first
    screen = os.fdopen(follower, "w", encoding="utf-8")
    patch.delenv("COLUMNS", raising=False)
    patch.setenv("TERM", "xterm-256color")
    patch.setattr(sys, "stdout", screen)
    console._console.cache_clear()
    parts: list[bytes] = []

    def read() -> str:
        screen.flush()
        os.set_blocking(leader, False)
        try:
            while part := os.read(leader, 65536):
                parts.append(part)
        except BlockingIOError:
            pass
        return STYLE.sub("", b"".join(parts).decode()).replace("\r\n", "\n")

    try:
        yield read
    finally:
        os.dup2(kept, 0)
        os.close(kept)
        screen.close()
        os.close(leader)
        console._console.cache_clear()


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", COMMANDS)
def test_no_number_is_cropped_or_broken_on_a_terminal(
    name: str, width: int, shown: dict[str, list[Table]], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert shown[name]
    for (title, columns, *rest), options in shown[name]:
        rows = [tuple(row) for row in rest[0]]
        with terminal(width, monkeypatch) as read:
            console.table(title, columns, rows, **options)
            text = read()
        assert width < console.WIDTH_OF_FILES
        words = text.split()
        for row in rows:
            for value in row:
                if isinstance(value, (int, float)) and not isinstance(value, bool):
                    assert console.number(value) in words or str(value) in words
        assert "…" not in text.replace("…", "", sum("…" in str(x) for row in rows for x in row))
        for line in text.splitlines()[1:]:
            if "─" in line:
                assert len(line) <= width


@pytest.mark.parametrize("name", COMMANDS)
def test_json_alone_is_on_standard_output_and_one_shape(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(folder)
    assert cli.run([*COMMANDS[name], "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert isinstance(document, list if name in LISTS else dict)
    if name in LISTS:
        assert all(isinstance(record, dict) for record in document)
        assert len({tuple(record) for record in document}) == 1  # the same fields in each


@pytest.mark.parametrize("name", ["planners", "solve", "tradeoff"])
def test_json_goes_to_a_file_and_the_tables_are_printed(
    name: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(folder)
    assert cli.run([*COMMANDS[name], "--json", str(tmp_path / "x.json")]) == 0
    assert json.loads((tmp_path / "x.json").read_text())
    assert "───" in capsys.readouterr().out


def test_after_json_alone_the_next_command_prints_again(capsys: Capture) -> None:
    assert cli.run(["planners", "--json", "-"]) == 0
    capsys.readouterr()
    assert cli.run(["planners"]) == 0
    assert "Planners" in capsys.readouterr().out


def test_numbers_that_json_has_not_are_null(capsys: Capture) -> None:
    console.write_json(Path("-"), {"a": [float("inf"), float("nan"), 1.5], 3: ("x", None)})
    assert json.loads(capsys.readouterr().out) == {"a": [None, None, 1.5], "3": ["x", None]}


def test_what_is_piped_has_no_colour(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FORCE_COLOR", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    console._console.cache_clear()
    console.console().print("wrong", style="bold red")
    console.table("Title", ["a"], [(1,)])
    assert "\x1b" not in capsys.readouterr().out
    console._console.cache_clear()


def test_a_terminal_has_colour(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FORCE_COLOR", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    with terminal(80, monkeypatch):
        assert console.console().is_terminal
        assert console.console().width == 80


def test_the_version_is_that_of_the_package(capsys: Capture) -> None:
    import msmrta_opt

    assert cli.run(["--version"]) == 0
    assert capsys.readouterr().out == f"msmrta_opt {msmrta_opt.__version__}\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_its_completion(
    shell: str, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setenv("_MSMRTA_COMPLETE", f"source_{shell}")
    with pytest.raises(SystemExit) as ended:
        cli.run(["--help"])
    assert ended.value.code == 0
    assert "_MSMRTA_COMPLETE=complete_" + shell in capsys.readouterr().out
