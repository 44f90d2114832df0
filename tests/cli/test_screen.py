"""Files are written whatever becomes of the screen: a reader that left, a full device, no stream."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from msmrta_opt.mission.plan import Plan
from msmrta_opt.optimise import registry

Run = Callable[..., int]
Patch = pytest.MonkeyPatch

FULL = Path("/dev/full")
needs_full_device = pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full here")
posix = pytest.mark.skipif(sys.platform == "win32", reason="the shell is not a POSIX one")


def full() -> io.TextIOWrapper:
    return open(FULL, "w", encoding="utf-8")


def left_by_its_reader() -> io.TextIOWrapper:
    reader, writer = os.pipe()
    os.close(reader)
    return open(writer, "w", encoding="utf-8")


def encoded(name: str) -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(), encoding=name)


GENERATE = ["generate", "--map", "map0", "--robots", "2", "--victims", "1"]
SHOWING = {
    "check": ["check", "MISSION"],
    "show": ["show", "cluster_fair", "MISSION"],
    "models": ["models", "MISSION"],
    "solvers": ["solvers"],
    "planners": ["planners"],
    "solve": ["solve", "cluster_fair", "MISSION"],
    "explain": ["explain", "cluster_fair", "MISSION"],
    "schema": ["schema"],
    "plan --help": ["plan", "--help"],
    "generate": GENERATE,
}
"""Lines that only show something."""
COMPARE = ["compare", "MISSION", "--models", "cluster_fair", "--solvers", "highs", "--no-scores"]
WRITING = {
    "plan": ["plan", "MISSION", "--json", "p.json", "--figure", "p.svg"],
    "exact": ["exact", "MISSION", "--time-limit", "5", "--json", "p.json"],
    "compare": [*COMPARE, "--json", "r.json", "--csv", "t.csv", "--save", "b.json"],
    "tradeoff": ["tradeoff", "MISSION", "--csv", "t.csv"],
    "export": ["export", "cluster_fair", "MISSION", "-o", "p.lp"],
    "generate": [*GENERATE, "-o", "m.json"],
    "compare-plans": ["compare-plans", "MISSION", "--seconds", "0", "--figure", "p.svg"],
}
"""Lines that also write files."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: Patch, corridor_file: Path) -> Path:
    """Where the files are written; ``MISSION`` lies elsewhere."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def line(words: Sequence[str], mission: Path) -> list[object]:
    return [mission if word == "MISSION" else word for word in words]


def assert_written(words: Sequence[str], folder: Path) -> None:
    """Each file is there and whole, and no scrap beside them."""
    files = [folder / word for word in words if word.endswith((".json", ".svg", ".csv", ".lp"))]
    assert sorted(folder.iterdir()) == sorted(files)
    assert all(file.read_text(encoding="utf-8") for file in files)
    if (folder / "p.json") in files:
        Plan.read(folder / "p.json")


@needs_full_device
@pytest.mark.parametrize("name", WRITING)
def test_a_full_device_costs_no_file_and_is_one_line(
    name: str, msmrta: Run, corridor_file: Path, folder: Path, monkeypatch: Patch
) -> None:
    said = io.StringIO()
    monkeypatch.setattr(sys, "stdout", full())
    monkeypatch.setattr(sys, "stderr", said)
    assert msmrta(*line(WRITING[name], corridor_file)) == 2
    assert said.getvalue().splitlines()[-1] == "error: standard output: No space left on device"
    assert_written(WRITING[name], folder)


@needs_full_device
@pytest.mark.parametrize("name", SHOWING)
def test_a_full_device_is_one_line(
    name: str, msmrta: Run, corridor_file: Path, monkeypatch: Patch
) -> None:
    said = io.StringIO()
    monkeypatch.setattr(sys, "stdout", full())
    monkeypatch.setattr(sys, "stderr", said)
    assert msmrta(*line(SHOWING[name], corridor_file)) == 2
    assert said.getvalue() == "error: standard output: No space left on device\n"


@pytest.mark.parametrize("name", WRITING)
def test_a_reader_that_left_costs_no_file(
    name: str, msmrta: Run, corridor_file: Path, folder: Path, monkeypatch: Patch
) -> None:
    monkeypatch.setattr(sys, "stdout", left_by_its_reader())
    monkeypatch.setattr(sys, "stderr", left_by_its_reader())
    assert msmrta(*line(WRITING[name], corridor_file)) == 0
    assert_written(WRITING[name], folder)


@pytest.mark.parametrize("name", WRITING)
def test_closed_streams_cost_no_file(
    name: str, msmrta: Run, corridor_file: Path, folder: Path, monkeypatch: Patch
) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert msmrta(*line(WRITING[name], corridor_file)) == 0
    assert_written(WRITING[name], folder)


@pytest.mark.parametrize("name", SHOWING)
def test_closed_streams_give_0(
    name: str, msmrta: Run, corridor_file: Path, monkeypatch: Patch
) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert msmrta(*line(SHOWING[name], corridor_file)) == 0


@pytest.mark.parametrize(
    ("name", "encoding"),
    [*((name, "ascii") for name in SHOWING), ("show", "latin-1"), ("show", "cp1252")],
)
def test_what_an_encoding_has_not_is_replaced(
    name: str, encoding: str, msmrta: Run, corridor_file: Path, monkeypatch: Patch
) -> None:
    shown = encoded(encoding)
    monkeypatch.setattr(sys, "stdout", shown)
    assert msmrta(*line(SHOWING[name], corridor_file)) == 0
    shown.flush()
    assert shown.buffer.getvalue()  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("name", "encoding"), [("plan", "ascii"), ("tradeoff", "latin-1"), ("compare", "cp1252")]
)
def test_files_are_utf_8_whatever_the_screen_is(
    name: str, encoding: str, msmrta: Run, corridor_file: Path, folder: Path, monkeypatch: Patch
) -> None:
    monkeypatch.setattr(sys, "stdout", encoded(encoding))
    assert msmrta(*line(WRITING[name], corridor_file)) == 0
    assert_written(WRITING[name], folder)


# As a shell has it: the process as a whole, its descriptors, and what Python does at exit.


def shell(pipeline: str, *arguments: object, **environment: str) -> tuple[int, str, str]:
    """Run `pipeline` in a shell, where ``"$@"`` is the program with `arguments`."""
    root = str(Path(__file__).parents[2])
    own = {name: x for name, x in os.environ.items() if not name.startswith(("PYTHON", "LC_"))}
    call = [sys.executable, "-c", "from msmrta_opt.cli import main; main()", *arguments]
    ended = subprocess.run(
        ["sh", "-c", pipeline, "sh", *map(str, call)],
        capture_output=True,
        check=False,
        env={**own, "PYTHONPATH": root, **environment},
    )
    return ended.returncode, ended.stdout.decode("latin-1"), ended.stderr.decode("latin-1")


@needs_full_device
def test_a_full_device_gives_2_at_exit_and_no_more_words(corridor_file: Path) -> None:
    status, _, said = shell('"$@" >/dev/full', "check", corridor_file)
    assert (status, said) == (2, "error: standard output: No space left on device\n")
    assert shell('"$@" >/dev/full 2>/dev/full', "check", corridor_file)[0] == 2
    assert shell('"$@" 2>/dev/full', "check", corridor_file)[0] == 0
    assert shell('"$@" 2>/dev/full', "check", "none.json")[0] == 2


@posix
def test_what_libraries_print_goes_into_no_file_where_standard_output_is_closed(
    corridor_file: Path, folder: Path
) -> None:
    """Its number would be that of the next file that is opened."""
    status, _, said = shell('"$@" >&-', *line(WRITING["plan"], corridor_file))
    assert (status, said) == (0, "")
    assert_written(WRITING["plan"], folder)
    assert shell('"$@" <&- >&- 2>&-', "check", corridor_file) == (0, "", "")


@posix
def test_what_libraries_print_is_in_no_document_on_standard_output(
    corridor_file: Path, folder: Path
) -> None:
    text = registry.get("cluster_fair").path.read_text()
    noise = 'import os\n\nos.write(1, b"a library says so\\n")\n'
    (folder / "noisy.py").write_text(text.replace("import cvxpy", noise + "import cvxpy", 1))
    asked = ("solve", "noisy", corridor_file, "--models", folder, "--json", "-")
    status, shown, said = shell('"$@"', *asked)
    assert (status, json.loads(shown)["status"]) == (0, "optimal")
    assert said == "a library says so\n"
    assert "a library says so" not in shell('"$@"', *asked[:-2])[1]


@posix
def test_a_reader_that_left_gives_0(corridor_file: Path, folder: Path) -> None:
    words = line(WRITING["exact"], corridor_file)
    assert shell('{ "$@" 2>&1; echo $? >status; } | head -1; cat status', *words)[0] == 0
    assert (folder / "status").read_text() == "0\n"
    (folder / "status").unlink()
    assert_written(WRITING["exact"], folder)


@posix
def test_in_a_locale_without_letters_of_other_scripts_they_are_question_marks() -> None:
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    status, shown, said = shell('"$@"', "plan", "--help", **plain)
    assert (status, said) == (0, "")
    assert "? of Eq. 1" in shown
