"""The commands plan, planners, check and scout, as a user types them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt import cli, mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan, ScoutingReport
from msmrta_opt.planners import plan, planners

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


def rows(text: str, title: str) -> list[list[str]]:
    """The cells of the table under `title`; they are apart by two spaces or more."""
    lines = iter(text.splitlines())
    assert any(line.startswith(title) for line in lines), text
    body = []
    for line in lines:
        if line.strip() and not line.strip().strip("─"):
            break
    for line in lines:
        if not line.strip():
            break
        body.append([cell.strip() for cell in line.split("  ") if cell.strip()])
    return body


# plan


def test_plan_prints_table_1_as_in_the_paper(
    msmrta: Run, paper_file: Path, capsys: Capture
) -> None:
    assert msmrta("plan", paper_file) == 0
    table = rows(capsys.readouterr().out, "Table 1")
    assert [row[0] for row in table] == [str(v) for v in range(10)]
    assert table[0] == ["0", "(16, 7)", "C0", "[0, 1, 1, 0, 0, 0]", "[∅, [0], [1], ∅, ∅, ∅]"]
    assert table[1] == ["1", "(15, 12)", "C0", "[0, 0, 0, 1, 1, 0]", "[∅, ∅, ∅, [0, 3], [1, 2], ∅]"]
    assert table[4] == ["4", "(0, 1)", "C1", "[1, 1, 0, 0, 0, 0]", "[[1, 3], [0], ∅, ∅, ∅, ∅]"]


def test_plan_prints_table_2_with_stage_b2_of_the_authors_program(
    msmrta: Run, paper_file: Path, capsys: Capture
) -> None:
    assert msmrta("plan", paper_file, "--preset", "authors", "--psi", "0.95") == 0
    told = capsys.readouterr().out
    table = rows(told, "Table 2")
    assert [row[2] for row in table] == [
        "[0, 1, 0, 1, 0, 0]",
        "[1, 0, 1, 0, 1, 0]",
        "[0, 0, 0, 0, 1, 0]",
        "[1, 0, 0, 1, 0, 0]",
    ]
    assert [row[5] for row in table] == ["C0", "C2", "C1", "C3"]
    assert [row[6] for row in table] == ["[1, 0]", "∅", "∅", "[9]"]
    assert "Deferred by the wall check, from stage B2 to the next: victims [8, 2]." in told


def test_plan_prints_metrics_what_is_unserved_and_certificates(
    msmrta: Run, paper_file: Path, capsys: Capture
) -> None:
    assert msmrta("plan", paper_file) == 0
    told = capsys.readouterr().out
    metrics = dict(row[:2] for row in rows(told, "Metrics"))
    assert metrics["available requirements served"] == "18 of 18 (100%)"
    assert metrics["victims fully served"] == "8 of 10"
    assert rows(told, "Unserved") == [
        [v, "FireExtinguisher", "no robot has it"] for v in ("2", "5")
    ]
    certificates = [row for row in rows(told, "Certificates") if row[0].startswith("Eq.")]
    assert [row[:3] for row in certificates] == [
        ["Eq. 1", "cluster_one_to_one", "max"],
        ["Eq. 2", "victim_one_to_one", "min"],
    ]
    for row in certificates:
        assert row[3] == row[4]
        assert row[5:8] == ["0", "optimal", "passed"]


def test_plan_prints_the_metrics_of_the_corridor(
    msmrta: Run, corridor_file: Path, capsys: Capture
) -> None:
    # Greedy: 1 move, 2 of service, 4 moves, 2 of service; victims are done at 3 and 9.
    assert msmrta("plan", corridor_file, "--planner", "greedy") == 0
    told = capsys.readouterr().out
    metrics = dict(row[:2] for row in rows(told, "Metrics"))
    assert metrics["distance"] == "5 cells (0: 5)"
    assert metrics["total time, travel and service"] == "9 time units"
    assert metrics["makespan"] == "9 time units"
    assert metrics["latency, completion times summed by priority"] == "12 time units"
    assert metrics["mean completion time of victims"] == "6 time units"
    assert "Certificates" not in told


@pytest.mark.parametrize(
    "arguments",
    [
        ["--preset", "authors", "--psi", "0.5", "--seed", "3"],
        ["--direct", "--option", "award=sequential", "--option", "pinned-clusters=false"],
        ["--planner", "mrga", "--option", "alpha=0.5"],
        ["--planner", "random", "--seed", "7"],
        ["--planner", "greedy", "--option", "improve=true", "--objective", "makespan"],
    ],
)
def test_the_json_of_a_plan_reproduces_it(
    arguments: list[str], msmrta: Run, paper_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = tmp_path / "plan.json"
    assert msmrta("plan", paper_file, *arguments, "--json", file) == 0
    assert f"plan written to {file}" in capsys.readouterr().out
    made = Plan.read(file)
    assert made.instance == Instance.read(paper_file)
    assert plan(made.instance, planner=made.planner, **made.options).same_as(made)
    assert msmrta("check", file) == 0


def test_plan_takes_its_options_to_the_planner(
    msmrta: Run, paper_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / "plan.json"
    named = ["--psi", "0.25", "--beta", "0.75", "--cluster-model", "cluster_printed"]
    named += ["--victim-model", "victim_covering", "--through-centre", "--option", "walk=levy"]
    assert msmrta("plan", paper_file, *named, "--json", file) == 0
    options = Plan.read(file).options
    assert (options["psi"], options["beta"]) == (0.25, 0.75)
    assert options["cluster_model"] == "cluster_printed"
    assert options["victim_model"] == "victim_covering"
    assert (options["through_centre"], options["walk"]) == (True, "levy")


def test_improve_makes_a_random_plan_no_worse(
    msmrta: Run, paper_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = tmp_path / "plan.json"
    arguments = ["--planner", "random", "--improve", "0.2", "--objective", "latency"]
    assert msmrta("plan", paper_file, *arguments, "--json", file) == 0
    made = Plan.read(file)
    assert made.options["improve"] == 0.2
    before = plan(made.instance, planner="random")
    assert made.metrics.latency <= before.metrics.latency
    head = next(line for line in capsys.readouterr().out.splitlines() if "L_full" in line)
    assert head.split()[-2:] == ["cluster", "improved"]


def test_plan_draws_a_picture(msmrta: Run, corridor_file: Path, tmp_path: Path) -> None:
    assert msmrta("plan", corridor_file, "--figure", tmp_path / "plan.svg") == 0
    assert "<svg" in (tmp_path / "plan.svg").read_text(encoding="utf-8")


def test_planners_lists_each_with_its_options(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("planners") == 0
    told = capsys.readouterr().out
    listed = {row[0]: row for row in rows(told, "Planners") if len(row) == 3}
    assert set(planners()) <= set(listed)
    assert listed["mrga"][2] == "distances=table, alpha=0.25, beta=0.2, seed=0"
    assert listed["greedy"][2] == "seed=0"
    assert listed["msmrta"][2].startswith("preset=paper, psi=0.95, beta=0.5,")


# check


def test_check_says_that_instances_and_plans_hold(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = tmp_path / "plan.json"
    plan(Instance.read(corridor_file)).save(file)
    assert msmrta("check", corridor_file, file) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{corridor_file}: a valid instance (1 robot, 2 victims, 0 scouts)",
        f"{file}: the plan holds (2 requirements served)",
    ]


def tampered(document: dict[str, Any], how: str) -> dict[str, Any]:
    visits = document["routes"][0]["visits"]
    if how == "late":
        visits[0]["departure"] += 1
    elif how == "jump":
        del visits[1]["cells"][1]
    elif how == "idle":
        visits[1]["served"] = []
    return document


@pytest.mark.parametrize(
    ("how", "wrong"),
    [
        ("late", "leaves at 4, which should be 3"),
        ("jump", "jumps from (0, 0) to (0, 2)"),
        ("idle", "FirstAids of victim 1 is served 0× and unserved 0×"),
    ],
)
def test_check_says_what_is_wrong_with_a_tampered_plan(
    how: str, wrong: str, msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    made = plan(Instance.read(corridor_file), planner="greedy")
    made.save(good)
    bad.write_text(json.dumps(tampered(made.document(), how)))
    assert msmrta("check", bad, good) == 1
    told = capsys.readouterr()
    assert f"{bad}: " in told.err
    assert wrong in told.err
    assert told.out == f"{good}: the plan holds (2 requirements served)\n"


# scout


def test_scout_prints_and_writes_who_found_whom(
    msmrta: Run, instances_dir: Path, tmp_path: Path, capsys: Capture
) -> None:
    json_file, figure = tmp_path / "report.json", tmp_path / "report.svg"
    mission = instances_dir / "scouted.json"
    assert msmrta("scout", mission, "--json", json_file, "--figure", figure) == 0
    told = capsys.readouterr().out
    assert [row[:2] for row in rows(told, "Victims found")] == [["0", "0"]]
    assert "1 of 2 victims found" in told
    assert "Not found: 1." in told
    report = ScoutingReport.model_validate_json(json_file.read_text(encoding="utf-8"))
    assert (report.not_found, report.ended) == ((1,), "covered")
    assert "<svg" in figure.read_text(encoding="utf-8")


# Bad input


BAD: list[tuple[list[str], str]] = [
    (["plan", "none.json"], "none.json: no such file"),
    (["plan", "."], "cannot be read"),
    (["plan", "broken.json"], "broken.json"),
    (["plan", "number.json"], "number.json"),
    (["plan", "PAPER", "--psi", "1.5"], "psi: 1.5; give a number from 0 to 1"),
    (["plan", "PAPER", "--psi", "nan"], "psi: nan; give a number from 0 to 1"),
    (["plan", "PAPER", "--psi", "high"], "'--psi'"),
    (["plan", "PAPER", "--beta", "-0.1"], "beta: -0.1; give a number from 0 to 1"),
    (["plan", "PAPER", "--seed", "-1"], "seed: -1; give a whole number"),
    (["plan", "PAPER", "--seed", "1.5"], "'--seed'"),
    (["plan", "PAPER", "--preset", "mine"], "preset: 'mine'; give one of paper, authors"),
    (["plan", "PAPER", "--planner", "mine"], "planner: 'mine'; give one of "),
    (["plan", "PAPER", "--planner", "greedy", "--psi", "0.5"], "psi: planner greedy has no such"),
    (["plan", "PAPER", "--cluster-model", "mine"], "no formulation 'mine'"),
    (["plan", "PAPER", "--victim-model", "cluster_printed"], "not a victim one"),
    (["plan", "PAPER", "--option", "colour=red"], "colour: planner msmrta has no such option"),
    (["plan", "PAPER", "--option", "colour"], "'colour'; give NAME=VALUE"),
    (["plan", "PAPER", "--option", "=1"], "'=1'; give NAME=VALUE"),
    (["plan", "PAPER", "--option", "walk=[1]"], "give a number, a word, true, false or null"),
    (["plan", "PAPER", "--option", "seed=1", "--option", "seed=2"], "'seed' is given twice"),
    (["plan", "PAPER", "--seed", "1", "--option", "seed=2"], "'seed' is already given"),
    (["plan", "PAPER", "--option", "planner=mrga"], "'planner' is already given"),
    (["plan", "PAPER", "--option", "instance=1"], "'instance' is already given"),
    (["plan", "PAPER", "--improve", "-1"], "improve: -1.0; give true, false, or a finite number"),
    (["plan", "PAPER", "--improve", "long"], "'--improve'"),
    (["plan", "PAPER", "--improve", "1", "--objective", "cost"], "objective: 'cost'; give one of"),
    (["plan", "PAPER", "--objective", "latency"], "give improve with it"),
    (["plan", "PAPER", "--unknown"], "No such option: --unknown"),
    (["plan"], "Missing argument"),
    (["check", "none.json"], "none.json: no such file"),
    (["check", "broken.json"], "broken.json: broken JSON: "),
    (["check", "list.json"], "list.json: not a JSON object"),
    (["check", "half.json"], "half.json: "),
    (["check"], "Missing argument"),
    (["scout", "none.json"], "none.json: no such file"),
    (["scout", "CORRIDOR"], "has no scouts"),
    (["scout", "PAPER", "--walk", "straight"], "unknown walk 'straight'"),
    (["scout", "PAPER", "--until", "bored"], "unknown condition 'bored'"),
    (["scout", "PAPER", "--steps", "-1"], "max_steps: -1"),
    (["scout", "PAPER", "--seed", "-1"], "seed: -1"),
]


def refused(arguments: list[str], problem: str, msmrta: Run, folder: Path, capsys: Capture) -> None:
    """The command gets one line, status 2 and no output; nothing is written."""
    before = sorted(folder.iterdir())
    assert msmrta(*arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ")
    assert told.err.count("\n") == 1
    assert problem in told.err
    assert sorted(folder.iterdir()) == before


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An own folder to work in, with files that are wrong."""
    (tmp_path / "broken.json").write_text('{"format": ')
    (tmp_path / "number.json").write_text("7")
    (tmp_path / "list.json").write_text("[]")
    (tmp_path / "half.json").write_text(
        '{"format": "msmrta-plan/1", "planner": "mine", "routes": []}'
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("arguments", "problem"), BAD, ids=lambda x: " ".join(x).replace("/", "|"))
def test_bad_input_gets_one_line_and_status_2_and_writes_nothing(
    arguments: list[str],
    problem: str,
    msmrta: Run,
    folder: Path,
    instances_dir: Path,
    capsys: Capture,
) -> None:
    names = {"PAPER": instances_dir / "paper.json", "CORRIDOR": instances_dir / "corridor.json"}
    given = [str(names.get(text, text)) for text in arguments]
    output = ["--json", "result.json"] if arguments[0] != "check" else []
    refused([*given, *output], problem, msmrta, folder, capsys)


@pytest.mark.parametrize(
    ("outputs", "problem"),
    [
        (["--json", "none/result.json"], "no folder 'none'"),
        (["--json", "."], "is a folder; give a file"),
        (["--json", "result.json", "--figure", "result.txt"], "unknown picture format '.txt'"),
        (["--json", "result.json", "--figure", "result"], "unknown picture format ''"),
        (["--json", "result.json", "--figure", "none/result.png"], "no folder 'none'"),
    ],
)
@pytest.mark.parametrize("command", ["plan", "scout"])
def test_outputs_that_cannot_be_written_are_refused_before_any_work(
    command: str,
    outputs: list[str],
    problem: str,
    msmrta: Run,
    folder: Path,
    paper_file: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    def work(*_: object, **__: object) -> None:
        raise AssertionError("nothing should be planned")

    monkeypatch.setattr("msmrta_opt.planners.plan", work)
    monkeypatch.setattr("msmrta_opt.stages.scouting.scouting", work)
    refused([command, str(paper_file), *outputs], problem, msmrta, folder, capsys)


def test_schema_prints_the_published_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["schema"]) == 0
    published = Path(mission.__file__).with_name("instance.schema.json")
    assert capsys.readouterr().out == published.read_text(encoding="utf-8")
