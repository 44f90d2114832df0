"""The command generate, and the suite that it wrote."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan
from msmrta_opt.stages.requirement_analysis import missing_capabilities, requirement_analysis
from msmrta_opt.stages.situation import Situation

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]

SUITE = Path(__file__).parents[2] / "instances" / "suite"
README = (SUITE / "README.md").read_text(encoding="utf-8")
LINES = [line for line in README.splitlines() if line.startswith("msmrta ")]
NAMES = [line.split()[-1] for line in LINES]
LACKING = {"cut_off.json": (2, 0), "lacking.json": (0, 5)}  # a tenth of 20 victims, of 48 needs
CALL = "from msmrta_opt.cli import main; main()"
SMALL = ("--robots", "3", "--victims", "6")


def missing(mission: Instance) -> tuple[int, int]:
    """By the requirement analysis: victims that no robot reaches, requirements that none can meet."""
    potential = requirement_analysis(mission.P, mission.Q).potential
    reach = Situation.of(mission).reach
    lacking = missing_capabilities(mission.Q, potential, reach)
    cut_off = {v for v, _ in lacking.unreachable}
    assert cut_off == {v for v in range(mission.n_victims) if not reach[:, v].any()}
    return len(cut_off), len(lacking.unavailable)


# The suite


def test_the_readme_of_the_suite_tells_of_every_file() -> None:
    assert sorted(NAMES) == sorted(path.name for path in SUITE.glob("*.json"))
    for name in NAMES:
        mission = Instance.read(SUITE / name)
        (row,) = [line for line in README.splitlines() if line.startswith(f"| `{name}` |")]
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[1:3] == [str(mission.n_robots), str(mission.n_victims)]
        assert mission.name == name.removesuffix(".json")


@pytest.mark.parametrize("line", LINES, ids=NAMES)
def test_each_file_of_the_suite_is_written_by_its_line_to_the_byte(
    line: str, msmrta: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert msmrta(*shlex.split(line)[1:]) == 0
    (written,) = tmp_path.iterdir()
    assert written.read_bytes() == (SUITE / written.name).read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_each_mission_of_the_suite_can_be_solved_but_for_what_it_says(name: str) -> None:
    mission = Instance.read(SUITE / name)
    n_cut_off, n_unmet = LACKING.get(name, (0, 0))
    assert missing(mission) == (n_cut_off, n_unmet)
    said = r"(\d+) of \d+ victims out of reach; (\d+) of \d+ requirements .*"
    found = re.fullmatch(said, mission.description)
    assert found is not None
    assert [int(count) for count in found.groups()] == [n_cut_off, n_unmet]


@pytest.mark.parametrize("name", NAMES)
def test_each_mission_of_the_suite_is_planned_and_the_plan_holds(name: str) -> None:
    made = plan(Instance.read(SUITE / name), planner="msmrta")
    assert problems(made) == []
    assert made.metrics.served_share == 1.0
    assert bool(made.unserved) == (name in LACKING)


def test_a_mission_tells_the_command_that_makes_it_again(
    msmrta: Run, capsys: Capture, tmp_path: Path
) -> None:
    source = Instance.read(SUITE / "cut_off.json").source
    assert msmrta(*shlex.split(source)[1:]) == 0
    assert capsys.readouterr().out.encode() == (SUITE / "cut_off.json").read_bytes()


# The command


def test_the_mission_is_printed_or_written_the_same_in_every_process(
    msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    arguments = ["generate", "--map", "rubble", "--size", "12x15", *SMALL, "--seed", "3"]
    arguments += ["--unreachable", "0.34", "--unmeetable", "0.25", "--priorities", "1-3"]
    assert msmrta(*arguments, "-o", tmp_path / "mission.json") == 0
    told = capsys.readouterr().out
    assert told == (
        f"mission written to {tmp_path / 'mission.json'}: 3 robots, 6 victims; 2 of 6 victims out "
        "of reach; 3 of 12 requirements of kinds that no robot has.\n"
    )
    assert missing(Instance.read(tmp_path / "mission.json")) == (2, 3)
    for hash_seed in ("1", "2"):
        done = subprocess.run(
            [sys.executable, "-c", CALL, *arguments],
            env={**os.environ, "PYTHONHASHSEED": hash_seed},
            capture_output=True,
            check=True,
        )
        assert done.stdout == (tmp_path / "mission.json").read_bytes()
        assert done.stderr == b""


@pytest.mark.parametrize(
    "options",
    [
        "--map map1",
        "--map own.map",
        "--map rooms --size 20x20 --room 3 --openings 0.5",
        "--map rubble --size 9x20 --density 0.3",
        "--map maze --size 9x21 --openings 0.1",
    ],
)
def test_missions_stand_on_known_maps_files_and_generated_ones(
    options: str, msmrta: Run, tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.map").write_text("type octile\nheight 3\nwidth 5\nmap\n.....\n..@..\n.....\n")
    assert msmrta("generate", *options.split(), *SMALL, "--kinds", "7") == 0
    mission = Instance.from_document(json.loads(capsys.readouterr().out))
    assert (mission.n_robots, mission.n_victims, mission.n_kinds) == (3, 6, 7)
    assert missing(mission) == (0, 0)
    if "own" in options:
        assert mission.map.rows == (".....", "..@..", ".....")
    if "--size" in options:
        assert "x".join(map(str, mission.map.shape)) in options


@pytest.mark.parametrize("layout", ["rooms", "rubble", "maze"])
def test_a_generated_map_gets_a_pocket_for_victims_out_of_reach(
    layout: str, msmrta: Run, capsys: Capture
) -> None:
    density = ("--density", "0") if layout == "rubble" else ()
    options = ("--map", layout, "--size", "21x21", *density, "--unreachable", "0.5")
    assert msmrta("generate", *options, *SMALL) == 0
    assert missing(Instance.from_document(json.loads(capsys.readouterr().out))) == (3, 0)


BAD = [
    ("--map map9", "no known map (did you mean 'map3'?); known: map0, map1, map2, map3"),
    ("--map broken.map", "broken.map: header: no line 'map'"),
    ("--map rooms", "size: missing; map rooms needs one, rows and columns"),
    ("--map rooms --size 9by9", "--size: '9by9'; give ROWSxCOLS"),
    ("--map rooms --size 3x3", "size: 3x3; give 6 to 1000 rows and columns"),
    ("--map rooms --size 9x9 --room 2", "room: 2; give"),
    ("--map maze --size 10x11", "size: 10x11; a maze's passages and walls take odd numbers"),
    ("--map rubble --size 9x9 --density 1.5", "density: 1.5; give a number from 0 to 1"),
    ("--map rubble --size 9x9 --density 0.95", "map: 9 robots and victims within reach on "),
    ("--map rubble --size 9x9 --openings 0.1", "openings: not for map rubble; it is for rooms"),
    ("--map map0 --size 9x9", "size: not for map map0; it is for rooms or rubble or maze"),
    ("--map maze --size 5x5 --unreachable 1", "pocket: 6 of 7 connected cells to wall off"),
    ("--map map0 --unreachable 0.5", "unreachable: 3 victims out of reach, but the map has 0"),
    ("--map map0 --unreachable nan", "unreachable: nan; give a number from 0 to 1"),
    ("--map map0 --unmeetable 2", "unmeetable: 2.0; give a number from 0 to 1"),
    ("--map map0 --kinds 10", "kinds: 10 kinds, but at most 3 for each of 3 robots make only 9"),
    ("--map map0 --robots 1", "kinds: 6 kinds, but at most 3 for each of 1 robot make only 3"),
    ("--map map0 --per-robot 3", "--per-robot: '3'; give LOW-HIGH, such as 1-3"),
    ("--map map0 --per-victim 2-9", "per_victim: (2, 9); give 0 ≤ minimum ≤ maximum ≤ 6"),
    ("--map map0 --priorities 5-1", "priorities: (5, 1); give 0 ≤ minimum ≤ maximum"),
    ("--map map0 --speeds fast", "--speeds: 'fast'; give numbers, such as 0.2,0.3"),
    ("--map map0 --speeds 0.2,0", "speeds: [0.2, 0.0]; give cells per time unit above 0"),
    ("--map map0 --seed -1", "seed: -1; give a whole number"),
    ("--map map0 --victims -1", "counts: at least one robot and no fewer than no victims"),
    ("--map map0 -o none/mission.json", "no folder 'none' to write it in"),
    ("--map map0 -o .", "is a folder; give a file"),
]


@pytest.mark.parametrize(("options", "message"), BAD, ids=[options for options, _ in BAD])
def test_bad_input_gets_one_line_and_nothing_is_written(
    options: str,
    message: str,
    msmrta: Run,
    tmp_path: Path,
    capsys: Capture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("broken.map").write_text("....\n")
    out = () if "-o" in options else ("-o", "mission.json")
    assert msmrta("generate", *SMALL, *options.split(), *out) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ")
    assert message in told.err
    assert told.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["broken.map"]
