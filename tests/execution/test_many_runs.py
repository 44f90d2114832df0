"""Many runs: the same on any number of jobs, and what they say with its intervals."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt import cli
from msmrta_opt.cli import console
from msmrta_opt.execution import many_runs
from msmrta_opt.execution.distributions import difference, paired, probability, quantile
from msmrta_opt.execution.many_runs import Outcome, execute_many
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.scenario import Scenario
from msmrta_opt.planners import plan as make_plan

NOISE = """format = "msmrta-scenario/1"

[[speed]]
distribution = "lognormal"
sigma = 0.3

[[lost]]
rate = 0.002
"""


@pytest.fixture(scope="module")
def plan(paper) -> Plan:  # type: ignore[no-untyped-def]
    return make_plan(paper, planner="greedy")


@pytest.fixture
def files(plan: Plan, tmp_path: Path) -> tuple[str, str]:
    plan.save(tmp_path / "plan.json")
    (tmp_path / "noise.toml").write_text(NOISE)
    return str(tmp_path / "plan.json"), str(tmp_path / "noise.toml")


def test_outcomes_are_the_same_on_any_number_of_jobs(
    plan: Plan, files: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("msmrta_opt.execution.many_runs.STARTING_SECONDS", 0.0)
    scenario = Scenario.read(files[1])
    policies: dict[str, dict[str, object]] = {"keep": {}, "repair": {}}
    one = list(execute_many(plan, scenario, policies, range(14)))
    two = list(execute_many(plan, scenario, policies, range(14), jobs=2))
    assert sorted(one, key=lambda x: (x.seed, x.policy)) == sorted(
        two, key=lambda x: (x.seed, x.policy)
    )
    assert len(one) == 28
    gap = paired(one, "keep", "repair", "n_served")
    assert (gap.less, gap.less + gap.equal + gap.more) == (0, 14)
    assert gap.mean > 0


def test_the_seed_in_work_is_left_out_once_the_user_asks(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Asked after a seed is done, within the next: what is finished is kept."""
    done: list[int] = []
    monkeypatch.setattr(many_runs, "interrupted", lambda: len(done) > 1)
    seen = many_runs._outcome

    def noted(*given: object) -> Outcome:
        done.append(1)
        return seen(*given)

    monkeypatch.setattr(many_runs, "_outcome", noted)
    found = many_runs.outcomes(plan, Scenario(), {"keep": {}}, range(5))
    assert [x.seed for x in found] == [0, 1]


def test_policies_on_one_seed_are_told_to_lose_the_same_robots(plan: Plan) -> None:
    """Though the run that does more ends later, and more are lost by then."""
    scenario = Scenario.from_document({"lost": [{"rate": 0.004}]})
    found = list(execute_many(plan, scenario, {"keep": {}, "repair": {}}, range(12)))
    lost = paired(found, "keep", "repair", "robots_lost")
    assert (lost.less, lost.equal, lost.more) == (0, 12, 0)
    assert paired(found, "keep", "repair", "makespan").more > 0


def test_the_interval_of_a_median_is_that_of_the_tables() -> None:
    # Of ten values the second and the ninth hold the median with probability 97.9 %.
    found = quantile([float(i) for i in range(1, 11)], 0.5)
    assert (found.value, found.low, found.high) == (5.0, 2.0, 9.0)
    assert quantile([1.0, 2.0, 3.0], 0.5).low is None  # too few for any


def test_the_interval_of_a_probability_is_wilsons() -> None:
    found = probability(8, 10)
    assert (found.value, round(found.low, 4), round(found.high, 4)) == (0.8, 0.4902, 0.9433)
    # Of none one end is 0, of all the other is 1, whatever n is: nothing is left of rounding.
    assert {probability(0, n).low for n in range(1, 200)} == {0.0}
    assert {probability(n, n).high for n in range(1, 200)} == {1.0}


def test_the_interval_of_a_difference_is_students() -> None:
    # Differences 1, 2, 3: mean 2, deviation 1; t of 2 degrees of freedom is 4.3027.
    found = difference([0.0, 0.0, 0.0], [1.0, 2.0, 3.0])
    assert found.mean == 2.0
    assert found.low == pytest.approx(2 - 4.30265 / 3**0.5, abs=1e-4)
    assert (found.less, found.equal, found.more) == (0, 0, 3)


def test_the_command_compares_policies(
    files: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, noise = files
    out = tmp_path / "runs.json"
    command = f"run {plan} --scenario {noise} --policy keep --policy repair --runs 5 --json {out}"
    assert cli.run([*command.split(), "--by", "400"]) == 0
    said = capsys.readouterr().out
    # The interval of a median takes six runs; what there is none of is said once, and is no column.
    assert "repair: quantiles of 5 runs, too few for an interval of the median" in said
    assert "On the same seeds: repair minus keep\n" in said
    assert "–" not in said
    document = json.loads(out.read_text())
    assert len(document["runs"]) == 10
    assert {row["by"] for row in document["served"]} == {400.0}


def test_the_tables_of_many_runs_fit_a_terminal_of_80_columns(
    files: tuple[str, str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("msmrta_opt.cli.console.WIDTH_OF_FILES", 80)
    console._console.cache_clear()
    plan, noise = files
    command = f"run {plan} --scenario {noise} --policy keep --policy repair --runs 6"
    assert cli.run(command.split()) == 0
    console._console.cache_clear()
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert "metric: " not in said  # as a list of records would have it
    assert "median, 95 %" in said


def test_the_command_writes_a_run_that_holds(files: tuple[str, str], tmp_path: Path) -> None:
    plan, noise = files
    out = tmp_path / "run.json"
    assert cli.run(["run", plan, "--scenario", noise, "--seed", "3", "--json", str(out)]) == 0
    assert cli.run(["check", str(out)]) == 0
    document = json.loads(out.read_text())
    document["figures"]["n_served"] += 1
    out.write_text(json.dumps(document))
    assert cli.run(["check", str(out)]) == 1


WRONG: list[tuple[str, Callable[[str], str], str]] = [
    ("an unknown field", lambda s: s + "\nnotize = 'before'", "notize"),
    ("a mistyped one", lambda s: s.replace("sigma", "sigme"), "(did you mean 'sigma'?)"),
    ("no such robot", lambda s: s + "robot = 17\n", "lost[0].robot: 17; the mission has robots"),
    ("a missing part", lambda s: s.replace("sigma = 0.3\n", ""), "speed[0].sigma: is missing"),
    ("a wrong format", lambda s: s.replace("scenario/1", "scenario/2"), "format"),
    ("broken TOML", lambda s: s + "[[[", "broken TOML"),
    ("a rate and a time", lambda s: s + "time = 3.0\n", "give either a time or a rate"),
]


@pytest.mark.parametrize(("change", "says"), [x[1:] for x in WRONG], ids=[x[0] for x in WRONG])
def test_a_wrong_scenario_is_one_line(
    files: tuple[str, str],
    change: Callable[[str], str],
    says: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    plan, noise = files
    Path(noise).write_text(change(NOISE))
    assert cli.run(["run", plan, "--scenario", noise]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert noise in told[0]
    assert says in told[0]
