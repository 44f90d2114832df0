"""What commands read and write: one line for what cannot be, and nothing lost or replaced."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.maps import write_map
from msmrta_opt.mission.plan import Plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]

FULL = Path("/dev/full")
needs_full_device = pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full here")
posix = pytest.mark.skipif(os.name != "posix", reason="devices are those of POSIX")

WRONG: dict[str, tuple[bytes, str]] = {
    "number of 5000 digits": (b'{"id": ' + b"1" * 5000 + b"}", "line 1: a number of more than 300"),
    "2000 lists in each other": (b"[" * 2000, "nested too deep; give at most 100 levels"),
    "key given twice": (b'{"name": "a", "name": "b"}', "name: is given twice; give it once"),
    "not UTF-8": (b'{"name": "\xff"}', "not a UTF-8 text file"),
    "not finite": (b'{"speed": NaN}', "speed: NaN; give a finite number"),
    "half a document": (b'{"name": ', "broken JSON: Expecting value: line 1 column 10"),
    "nothing": (b"", "broken JSON: Expecting value"),
    "a list": (b"[]", "give"),
}


@pytest.mark.parametrize(
    "command", [("check",), ("plan",), ("exact",), ("solve", "cluster_printed")]
)
@pytest.mark.parametrize("wrong", WRONG)
def test_a_file_that_cannot_be_read_is_one_line_and_exit_status_2(
    wrong: str, command: tuple[str, ...], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    data, problem = WRONG[wrong]
    path = tmp_path / "file.json"
    path.write_bytes(data)
    assert msmrta(*command, path) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.splitlines()
    assert all(line.startswith(f"error: {path}: ") for line in lines)
    assert problem in said.err
    # Of numbers all are told, with whatever else is wrong in the file.
    assert len(lines) == 1 or wrong == "not finite"


@pytest.mark.parametrize(
    "wrong", ["number of 5000 digits", "2000 lists in each other", "not UTF-8"]
)
def test_baselines_and_studies_are_read_with_the_same_limits(
    wrong: str, msmrta: Run, tmp_path: Path, corridor_file: Path, capsys: Capture
) -> None:
    data, problem = WRONG[wrong]
    baseline, study = tmp_path / "base.json", tmp_path / "study.toml"
    baseline.write_bytes(data)
    study.write_bytes(
        b"a = " + data.removeprefix(b'{"id": ').removeprefix(b'{"name": ').rstrip(b"}")
    )
    for path, arguments in {
        baseline: ("compare", corridor_file, "--against", baseline),
        study: ("study", "status", study),
    }.items():
        assert msmrta(*arguments) == 2
        said = capsys.readouterr().err
        assert said.startswith(f"error: {path}: ")
        assert problem in said
        assert said.count("\n") == 1


@posix
def test_neither_a_pipe_nor_an_endless_device_is_waited_for(
    msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    os.mkfifo(tmp_path / "pipe")
    mission = tmp_path / "mission.json"
    mission.write_text('{"map": "/dev/zero", "capabilities": []}')
    for path, about in {
        tmp_path / "pipe": "pipe",
        "/dev/zero": "/dev/zero",
        mission: "/dev/zero",
    }.items():
        assert msmrta("check", path) == 2
        assert f"{about}: cannot be read (not a regular file)" in capsys.readouterr().err


@posix
def test_an_output_that_is_a_device_or_a_link_stays_one(
    msmrta: Run, corridor_file: Path, tmp_path: Path
) -> None:
    link = tmp_path / "link.json"
    link.symlink_to("plan.json")
    for output in (Path("/dev/null"), link):
        assert msmrta("plan", corridor_file, "--planner", "greedy", "--json", output) == 0
    assert Path("/dev/null").is_char_device()
    assert link.is_symlink()
    assert Plan.read(tmp_path / "plan.json").planner == "greedy"


@posix
def test_no_output_overwrites_what_the_command_reads(
    msmrta: Run,
    corridor_file: Path,
    tmp_path: Path,
    capsys: Capture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from msmrta_opt.mission.instance import Instance

    monkeypatch.chdir(tmp_path)
    mission = Instance.read(corridor_file)
    write_map(mission.map, "ground.map")
    document = mission.document() | {"map": "ground.map"}
    Instance.from_document(document).save("mission.json")
    Path("link.json").symlink_to("mission.json")
    inputs = {name: Path(name).read_bytes() for name in ("mission.json", "ground.map")}
    for arguments, output in [
        (("plan", "mission.json", "--json", "mission.json"), "mission.json"),
        (
            ("plan", "mission.json", "--json", "../" + tmp_path.name + "/mission.json"),
            "mission.json",
        ),
        (("plan", "link.json", "--json", "mission.json"), "mission.json"),
        (("plan", "mission.json", "--json", "link.json"), "link.json"),
        (("plan", "mission.json", "--json", "ground.map"), "ground.map"),
        (("exact", "mission.json", "--json", "mission.json"), "mission.json"),
        (("scout", "mission.json", "--json", "mission.json"), "mission.json"),
        (("tradeoff", "mission.json", "--csv", "mission.json"), "mission.json"),
        (("compare", "mission.json", "--csv", "mission.json"), "mission.json"),
        (
            (
                "generate",
                "--map",
                "ground.map",
                "--robots",
                "1",
                "--victims",
                "1",
                "-o",
                "ground.map",
            ),
            "ground.map",
        ),
    ]:
        assert msmrta(*arguments) == 2, arguments
        assert (
            f"{output}: would overwrite what is read; give another file" in capsys.readouterr().err
        )
        assert {name: Path(name).read_bytes() for name in inputs} == inputs


def test_one_file_is_not_given_for_two_outputs(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    out = tmp_path / "out.svg"
    assert msmrta("plan", corridor_file, "--json", out, "--figure", out) == 2
    assert "is given for two outputs; give two files" in capsys.readouterr().err
    assert not out.exists()


MODEL = """
import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec

SPEC = Spec(stage="cluster", title="a row in odd units")


def build(data):
    taken = cp.Variable(data.w.shape, boolean=True, name="x")
    x = cp.Variable(integer=True, bounds=[0, None], name="n")
    y = cp.Variable(boolean=True, name="y")
    return cp.Problem(cp.Minimize(x + y + cp.sum(taken)), [({row}).set_label("at least one second")])
"""


@pytest.mark.parametrize("suffix", [".lp", ".mps"])
@pytest.mark.parametrize(
    ("row", "written"),
    [
        ("1e-9 * x >= 1", True),
        ("1e-12 * x + 1e-9 * y >= 1e-3", True),
        ("3e15 * x >= 6e15", True),
        ("x <= 1e16 * y", False),
        ("1e-9 * x + 99 * y >= 1", False),
    ],
)
def test_export_scales_a_row_in_odd_units_or_names_it_with_its_coefficient(
    row: str,
    written: bool,
    suffix: str,
    msmrta: Run,
    paper_file: Path,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    model = tmp_path.name  # another one each time
    (tmp_path / f"{model}.py").write_text(MODEL.format(row=row))
    output = tmp_path / f"program{suffix}"
    status = msmrta("export", model, paper_file, "--models", tmp_path, "-o", output)
    said = capsys.readouterr().err
    assert output.exists() is written
    if written:
        assert status == 0, said
        return
    assert status == 2
    assert "row 'at least one second': coefficient 1e" in said
    assert "no scaling helps; give other units" in said
    assert said.count("\n") == 1


@posix
def test_a_reader_that_has_left_is_no_error(corridor_file: Path) -> None:
    command = (
        "import sys; from msmrta_opt import cli; sys.exit(cli.run(['plan', sys.argv[1], "
        "'--planner', 'greedy', '--json', '/dev/stdout']))"
    )
    with subprocess.Popen(
        [sys.executable, "-c", command, str(corridor_file)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0


@needs_full_device
def test_an_output_that_cannot_be_written_costs_neither_the_others_nor_the_screen(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    """What could not be written is said at the end, and that it was written is not."""
    figure, copy = tmp_path / "plan.svg", tmp_path / "plan.json"
    assert msmrta("plan", corridor_file, "--json", FULL, "--figure", figure) == 2
    said = capsys.readouterr()
    assert said.err == f"error: {FULL}: cannot be written (No space left on device)\n"
    assert f"picture written to {figure}" in said.out
    assert f"written to {FULL}" not in said.out
    assert "Certificates" in said.out
    assert figure.read_text().endswith("</svg>\n")
    # What comes after is as ever.
    assert msmrta("plan", corridor_file, "--json", copy) == 0
    Plan.read(copy)
