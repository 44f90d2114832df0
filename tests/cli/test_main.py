"""The command line as a whole: help, errors, exit statuses, interruption, pipes."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.errors import CheckError, InputError, ModelError, SolverError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]

COMMANDS = [
    "plan",
    "planners",
    "check",
    "scout",
    "models",
    "show",
    "new-model",
    "solvers",
    "export",
    "generate",
    "study",
]
CALL = "from msmrta_opt.cli import main; main()"
INTERRUPTED = (
    "import os, signal, msmrta_opt.planners as planners, msmrta_opt.cli as cli\n"
    "planners.plan = lambda *_, **__: os.kill(os.getpid(), signal.SIGINT)\n"
    "cli.main()"
)


def start(*arguments: object, program: str = CALL) -> subprocess.Popen[str]:
    """The command line as a process of its own."""
    root = str(Path(__file__).parents[2])
    return subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        env={**os.environ, "PYTHONPATH": root, "PYTHONIOENCODING": "utf-8"},
    )


def failing(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Let planning raise `error`."""

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("msmrta_opt.planners.plan", fail)


def test_help_names_every_command(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("--help") == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert all(command in told.out for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command: str, msmrta: Run, capsys: Capture) -> None:
    assert msmrta(command, "--help") == 0
    assert f"msmrta {command}" in capsys.readouterr().out


def test_without_a_command_help_is_all_that_is_shown(msmrta: Run, capsys: Capture) -> None:
    assert msmrta() == 2
    told = capsys.readouterr()
    assert "plan" in told.out + told.err
    assert "error" not in told.err


def test_an_unknown_command_gets_one_line(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("frobnicate") == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == "error: No such command 'frobnicate'.\n"


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (InputError("0; give 1 or more", field="robots"), 2),
        (ModelError("Eq. 1 is not linear"), 2),
        (SolverError("scip is not installed"), 2),
        (CheckError("the plan jumps"), 1),
        (InputError("two\nlines"), 2),
    ],
)
def test_an_error_gets_one_line_and_its_status(
    error: Exception,
    status: int,
    msmrta: Run,
    corridor_file: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    failing(monkeypatch, error)
    assert msmrta("plan", corridor_file) == status
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == f"error: {' '.join(str(error).split())}\n"


def test_an_error_of_the_system_is_told_with_its_file_and_without_its_number(
    msmrta: Run, corridor_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    failing(monkeypatch, OSError(errno.ENOSPC, "No space left on device", "plan.json"))
    assert msmrta("plan", corridor_file) == 2
    assert capsys.readouterr().err == "error: plan.json: No space left on device\n"


def test_a_file_name_that_is_too_long_gets_one_line(
    msmrta: Run, corridor_file: Path, capsys: Capture
) -> None:
    assert msmrta("plan", corridor_file, "--json", "x" * 5000) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert told.count("\n") == 1


def test_a_defect_of_the_program_is_not_hidden(
    msmrta: Run, corridor_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failing(monkeypatch, ZeroDivisionError("a bug"))
    with pytest.raises(ZeroDivisionError):
        msmrta("plan", corridor_file)


def test_ctrl_c_gives_130(
    msmrta: Run, corridor_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    failing(monkeypatch, KeyboardInterrupt())
    assert msmrta("plan", corridor_file) == 130
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == "interrupted\n"


def test_ctrl_c_ends_the_process_with_130_and_no_traceback(corridor_file: Path) -> None:
    process = start("plan", corridor_file, program=INTERRUPTED)
    out, err = process.communicate()
    assert process.returncode == 130
    assert out == ""
    assert err == "interrupted\n"


def test_the_package_runs_as_a_module() -> None:
    line = [sys.executable, "-m", "msmrta_opt", "planners", "--help"]
    found = subprocess.run(line, capture_output=True, text=True, check=True)
    assert "msmrta planners" in found.stdout


def test_exit_statuses_reach_the_shell(corridor_file: Path, tmp_path: Path) -> None:
    made = plan(Instance.read(corridor_file)).document()
    made["routes"][0]["visits"][0]["arrival"] += 1
    tampered = tmp_path / "plan.json"
    tampered.write_text(json.dumps(made))
    processes = {
        0: start("check", corridor_file),
        1: start("check", tampered),
        2: start("check", tmp_path / "none.json"),
    }
    told = {status: process.communicate() for status, process in processes.items()}
    assert [process.returncode for process in processes.values()] == [0, 1, 2]
    assert told[0][1] == ""
    assert "arrives at" in told[1][1]
    assert "no such file" in told[2][1]
    assert all("Traceback" not in err for _, err in told.values())
