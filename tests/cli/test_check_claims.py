"""The command check without --bound: claims, missions, warnings; everything that is wrong is told."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt.mission.examples import example
from msmrta_opt.planners import plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def exact() -> dict[str, Any]:
    """The corridor's best plan: worth 9 by total time, as its instance's description works out."""
    return plan(example("corridor"), planner="exact").document()


def written(folder: Path, document: dict[str, Any], **certificate: Any) -> Path:
    changed = json.loads(json.dumps(document))
    changed["certificates"][0].update(certificate)
    path = folder / "plan.json"
    path.write_text(json.dumps(changed))
    return path


def test_an_objective_that_is_claimed_is_worked_out_again_without_being_asked(
    exact: dict[str, Any], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    assert msmrta("check", written(tmp_path, exact)) == 0
    file = written(tmp_path, exact, objective=8.0, bound=8.0)
    assert msmrta("check", file) == 1
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        f"{file}: the certificate says 8 for a plan worth 9",
        f"{file}: the plan is called optimal at 9, above its bound 8",
        f"{file}: the gap is said to be 0.0, and is 0.111111111",
    ]


@pytest.mark.parametrize("bound", [(), ("--bound",)])
@pytest.mark.parametrize(
    ("claim", "told"),
    [
        ({"bound": 9.5}, "search.steps[0] has the bound 9.5, above the certificate's 9"),
        ({"incumbent": 8.5}, "search.steps[0] has routes worth 8.5, below the plan's 9"),
    ],
)
def test_a_search_that_claims_more_than_the_certificate_is_told(
    claim: dict[str, float],
    told: str,
    bound: tuple[str, ...],
    exact: dict[str, Any],
    msmrta: Run,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    forged = json.loads(json.dumps(exact))
    forged["search"]["steps"][0] |= claim
    file = written(tmp_path, forged)
    assert msmrta("check", *bound, file) == 1
    assert f"{file}: {told}\n" in capsys.readouterr().err


def test_a_search_by_another_objective_than_the_certificate_is_told(
    exact: dict[str, Any], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    forged = json.loads(json.dumps(exact))
    forged["search"]["objective"] = "makespan"
    file = written(tmp_path, forged)
    assert msmrta("check", file) == 1
    assert "the search is by 'makespan', which no certificate is on" in capsys.readouterr().err


def test_a_programs_certificate_that_contradicts_itself_is_told(
    msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    staged = plan(example("two_rooms")).document()
    file = written(tmp_path, staged, bound=0.5, check="x > 1 is missed")
    assert msmrta("check", file) == 1
    told = capsys.readouterr().err
    assert "the certificate of Eq. 1 says of its own check 'x > 1 is missed'" in told
    assert "the certificate of Eq. 1 has the bound 0.5 beyond its objective" in told


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_eq_1_is_worked_out_again_from_the_robots_that_took_clusters(
    preset: str, msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    staged = plan(example("paper"), preset=preset, psi=0.5).document()
    # What a solver found and what is worked out by hand from the plan agree; a lower claim is told.
    assert msmrta("check", written(tmp_path, staged)) == 0
    assert "warning" not in capsys.readouterr().out
    true = staged["certificates"][0]["objective"]
    file = written(tmp_path, staged, objective=true - 1, bound=true - 1)
    assert msmrta("check", file) == 0
    assert (
        f"{file}: warning: the certificate of Eq. 1 claims {true - 1:g}, where the robots that took "
        f"clusters are worth {true:g} by cluster_one_to_one as it is shipped"
    ) in capsys.readouterr().out


def test_everything_that_is_wrong_with_a_plan_is_told(
    exact: dict[str, Any], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    changed = json.loads(json.dumps(exact))
    changed["routes"][0]["visits"][0].update(arrival=2, departure=4)
    (tmp_path / "plan.json").write_text(json.dumps(changed))
    assert msmrta("check", tmp_path / "plan.json") == 1
    where = f"{tmp_path}/plan.json: robot 0 on its way to victim 0"
    assert capsys.readouterr().err.splitlines() == [
        f"{where} arrives at 2, which should be 1",
        f"{where} leaves at 4, which should be 3",
    ]


def test_a_plan_beside_another_mission_is_told_how_they_differ(
    exact: dict[str, Any], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    mission = example("corridor")
    first, *others = mission.victims
    elsewhere = mission.replace(
        victims=(first.model_copy(update={"cell": (0, 3), "priority": 2.0}), *others)
    )
    elsewhere.save(tmp_path / "other.json")
    file = written(tmp_path, exact)
    assert msmrta("check", file, tmp_path / "other.json") == 1
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    start = f"{file}: the plan is for another mission: victim {first.id} "
    assert lines[0].startswith(f"{start}stands elsewhere, ")
    assert lines[1].startswith(f"{start}has another priority, ")


def test_requirements_that_nobody_can_serve_are_a_warning(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("check", "paper", "walled_in", "corridor") == 0
    warnings = [line for line in capsys.readouterr().out.splitlines() if ": warning: " in line]
    # The paper's victims 2 and 5 need what Table 2 gives to no robot.
    assert warnings[0] == "paper: warning: no robot has FireExtinguisher, which victims 2, 5 need"
    assert len(warnings) == 3
    assert all(line.startswith("walled_in: warning: no robot") for line in warnings[1:])
    assert any("can reach victim" in line for line in warnings[1:])


def test_what_files_come_to_is_a_list_in_json(
    exact: dict[str, Any], msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    file = written(tmp_path, exact, objective=8.0)
    assert msmrta("check", file, "corridor", "--json", "-") == 1
    plan_, mission = json.loads(capsys.readouterr().out)
    assert plan_["file"] == str(file)
    assert (plan_["kind"], plan_["holds"]) == ("plan", False)
    assert "the certificate says 8 for a plan worth 9" in plan_["wrong"]
    assert (mission["kind"], mission["holds"], mission["warnings"]) == ("instance", True, [])


# What a plan says of how it was made


def notes(msmrta: Run, capsys: Capture, *words: object) -> str:
    assert msmrta("plan", *words) == 0
    return capsys.readouterr().out


def test_a_staged_plan_says_that_it_ignores_priorities_and_passes_centres(
    msmrta: Run, capsys: Capture, tmp_path: Path
) -> None:
    said = notes(msmrta, capsys, "split")
    assert any(victim.priority != 1 for victim in example("split").victims)
    assert "The staged method ignores priorities" in said
    assert "Routes pass the cells that stand for their clusters' centres" in said
    said = notes(msmrta, capsys, "split", "--direct", "--planner", "msmrta")
    assert "centres, as in the paper" not in said


def test_without_priorities_or_where_latency_weighs_them_nothing_is_said(
    msmrta: Run, capsys: Capture
) -> None:
    assert "ignores priorities" not in notes(msmrta, capsys, "two_rooms")
    improved = notes(msmrta, capsys, "split", "--improve", "0.01", "--objective", "latency")
    assert "ignores priorities" not in improved
    assert "clusters' centres" not in improved


def test_an_option_that_no_formulation_of_the_plan_reads_is_said_to_change_nothing(
    msmrta: Run, capsys: Capture
) -> None:
    said = notes(msmrta, capsys, "split", "--option", "endurance=400", "--option", "apart=0")
    models = "neither cluster_one_to_one nor victim_one_to_one reads it"
    assert f"endurance changes nothing: {models}; victim_generalized would." in said
    assert f"apart changes nothing: {models}; cluster_apart would." in said
    said = notes(
        msmrta,
        capsys,
        "split",
        "--option",
        "endurance=4000",
        "--victim-model",
        "victim_generalized",
        "--option",
        "apart=0",
        "--cluster-model",
        "cluster_apart",
    )
    assert "changes nothing" not in said
