"""Studies of policies: plans executed seed by seed, kept as one record, resumable as all others."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.studies import do, kept, write_study

from msmrta_opt import cli
from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study
from msmrta_opt.studies.study import study as open_study

PLAIN = """
title = "Policies"
[[instances]]
maps = "open.map"
robots = 2
victims = 3
[[planners]]
planner = "ssi"
"""
POLICIES = """
[[scenarios]]
file = "rough.toml"
runs = 3
hindsight = 1
[[policies]]
blocked = ["wait", "skip"]
"""
SCENARIO = """
[[speed]]
distribution = "lognormal"
sigma = 0.5
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "rough.toml").write_text(SCENARIO)
    return write_study(tmp_path, PLAIN + POLICIES)


def test_a_study_executes_each_plan_by_each_policy_on_the_same_seeds(path: Path) -> None:
    wait, skip = do(path)
    assert [record.contender for record in (wait, skip)] == [
        "keep, blocked = wait", "keep, blocked = skip",
    ]  # fmt: skip
    assert (wait.method, wait.scenario, wait.policy) == ("execution", "rough", "keep")
    assert wait.executions["seeds"] == [0, 1, 2]
    # No cell is blocked, so both policies do the same in the same world, and in each another.
    assert wait.executions["makespan"] == skip.executions["makespan"]
    assert len(set(wait.executions["makespan"])) == 3
    assert wait.metrics["makespan"] == pytest.approx(sum(wait.executions["makespan"]) / 3)
    best = zip(wait.executions["hindsight_best"], wait.executions["total_time"], strict=True)
    assert all(0 < allowed <= came * (1 + 1e-9) for allowed, came in best)
    assert do(path) == []
    assert [record.executions for record in kept(path)]


def test_regret_follows_the_metric_of_quality(path: Path) -> None:
    total = [run.key for run in runs(Study.read(path))]
    path.write_text(path.read_text() + '[report]\nquality = "makespan"\n')
    assert not set(total) & {run.key for run in runs(Study.read(path))}
    wait, skip = do(path)
    bests = wait.executions["hindsight_best"]
    assert all(best <= came for best, came in zip(bests, wait.executions["makespan"], strict=True))
    assert wait.executions["hindsight_problem"] == skip.executions["hindsight_problem"]
    page = open_study(path).report(path.parent / "report").read_text(encoding="utf-8")
    assert "By makespan: what runs are above the best" in page


def test_another_scenario_is_another_run_and_the_planners_run_is_as_before(path: Path) -> None:
    keys = [run.key for run in runs(Study.read(path))]
    (path.parent / "rough.toml").write_text(SCENARIO.replace("0.5", "0.4"))
    assert not set(keys) & {run.key for run in runs(Study.read(path))}
    plain = runs(Study.read(write_study(path.parent, PLAIN, "plain.toml")))
    assert [run.contender for run in plain] == ["ssi"]
    assert "policy" not in str(plain[0].task)


def test_the_report_compares_the_policies(path: Path) -> None:
    do(path)
    page = open_study(path).report(path.parent / "report").read_text(encoding="utf-8")
    assert "What runs come to" in page
    assert "In pairs, under rough" in page


UNFIT = """
[[service]]
kind = "Water"
value = 2.0
[[lost]]
robot = 7
time = 3.0
"""


def test_a_scenario_that_fits_no_mission_is_refused_before_anything_is_run(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each mistake once, with the scenario's file, the field and the missions it is one for."""
    path.write_text(path.read_text().replace("victims = 3", "victims = [3, 4]"))
    (path.parent / "rough.toml").write_text(UNFIT)
    assert cli.run(["study", "run", str(path)]) == 2
    rough = path.parent / "rough.toml"
    robot, kind = sorted(capsys.readouterr().err.splitlines())
    first = runs(Study.read(write_study(path.parent, PLAIN, "plain.toml")))[0].mission.name
    assert (
        robot
        == f"error: {rough}: lost[0].robot: 7; the mission has robots 0, 1 (mission {first} and 1 more)"
    )
    assert kind.startswith(f"error: {rough}: service[0].kind: 'Water'; the mission has ")
    assert not path.with_suffix(".sqlite").exists()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (PLAIN + "[[policies]]\n", "scenarios: is missing; [[policies]] need some"),
        (PLAIN + '[[scenarios]]\nfile = "rough.toml"\n', "policies: is missing"),
        (PLAIN + POLICIES.replace("rough", "no"), "scenarios[0]: "),
        (PLAIN + POLICIES + '[[policies]]\npolicy = "kep"\n', "policies[1]"),
        (PLAIN + POLICIES.replace("runs = 3", "runs = 0"), "scenarios[0].runs"),
        (PLAIN + POLICIES.replace("wait", "skip"), "give one of them a name of its own"),
    ],
)
def test_mistakes_are_told_in_a_line_before_anything_is_run(
    path: Path, text: str, said: str
) -> None:
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        runs(Study.read(path))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
