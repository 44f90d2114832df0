"""Formulations on common metrics, worked out by hand on the mission of two rooms.

Robot 0 can serve all three victims of the one cluster, robot 1 two of them: Eq. 1 is 3. The wall
defers victim 2, so B2 leaves it; robot 1 is done there after 2 moves and 2 of service: with β = 0,
Eq. 2 is 4. Robot 0 walks 4 to the centre (1, 1), 2 to its first victim and 2 to the other, and serves
2 and 3; robot 1 walks 2: in all 10 cells, and 13 + 4 of time.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from support.misbehaviour import write_models

from msmrta_opt import formulations
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.studies.analysis.choices import side_by_side
from msmrta_opt.studies.analysis.score import Score, score, scores

OPTIONS = StagedOptions.of(beta=0.0)


@pytest.fixture(scope="module")
def two_rooms(instances_dir: Path) -> Instance:
    return Instance.read(instances_dir / "two_rooms.json")


@pytest.mark.parametrize("model", ["cluster_one_to_one", "cluster_printed"])
def test_the_plan_of_two_rooms_scores_as_by_hand(two_rooms: Instance, model: str) -> None:
    found = score(two_rooms, "cluster", model, OPTIONS)
    assert (found.instance, found.model, found.message) == ("two_rooms", model, "")
    assert (found.eq1, found.eq2) == (pytest.approx(3.0), pytest.approx(4.0))
    assert (found.served_in_b2, found.served_in_b3, found.served_in_b4) == (2, 1, 0)
    assert found.metrics is not None
    assert found.metrics.distance == 10
    assert found.metrics.makespan == pytest.approx(13.0)
    assert found.metrics.total_time == pytest.approx(17.0)
    # The two victims of robot 0 are as near as each other; either may be first.
    assert found.metrics.mean_completion in (pytest.approx(25 / 3), pytest.approx(26 / 3))


def test_who_gets_what_is_told_side_by_side_and_differences_are_marked(two_rooms: Instance) -> None:
    first = score(two_rooms, "cluster", "cluster_one_to_one", OPTIONS)
    # One cluster for two robots, of whom robot 0 can serve all.
    assert first.gets == {"robot 0": ("C0",), "robot 1": ()}
    other = replace(first, model="other", gets={"robot 0": (), "robot 1": ("C0", "C10", "C2")})
    failed = Score("two_rooms", "failed", message="why")
    columns, rows = side_by_side(
        [(item.instance, item.model, item.gets) for item in (first, other, failed)]
    )
    assert columns == ["instance", "who", "cluster_one_to_one", "other", "failed"]
    assert rows == [
        ["two_rooms", "robot 0", "C0", "nothing *", "no plan *"],
        ["two_rooms", "robot 1", "nothing", "C0, C2, C10 *", "no plan *"],
    ]


def test_victims_of_one_cluster_are_told_whatever_the_clusters_are_called(
    two_rooms: Instance,
) -> None:
    found = score(two_rooms, "clustering", "clustering_pmedian", OPTIONS)
    for who, others in found.gets.items():
        for other in others:
            assert f"v{who.removeprefix('victim ')}" in found.gets[f"victim {other[1:]}"]
    assert set(found.gets) == {"victim 0", "victim 1", "victim 2"}
    # Robot 1 takes the one victim that B2 leaves.
    b3 = score(two_rooms, "victim", "victim_one_to_one", OPTIONS)
    assert b3.gets == {"robot 0": (), "robot 1": ("v2",)}


def test_beta_weighs_time_against_what_others_must_redo(two_rooms: Instance) -> None:
    # Robot 1 has no record and leaves nothing of victim 2 to others: 0.75 · 4 + 0.25 · 0.
    found = score(two_rooms, "cluster", "cluster_one_to_one", StagedOptions.of(beta=0.25))
    assert found.eq2 == pytest.approx(3.0)


def test_a_model_that_fails_has_a_message_and_no_figures(
    two_rooms: Instance, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    registry.add_models(write_models(tmp_path / "models", "wrong_infeasible", "wrong_kill"))
    models = ["wrong_infeasible", "wrong_kill", "cluster_one_to_one"]
    infeasible, killed, sound = scores(
        [two_rooms], stage="cluster", models=models, options=OPTIONS, time_limit=60
    )
    assert infeasible == Score("two_rooms", "wrong_infeasible", message=infeasible.message)
    assert "infeasible" in infeasible.message
    assert killed == Score("two_rooms", "wrong_kill", message="killed by SIGKILL")
    assert sound.eq1 == pytest.approx(3.0)


def test_stages_without_a_place_in_the_staged_planner_are_not_scored(two_rooms: Instance) -> None:
    joint = scores([two_rooms], stage="joint", models=["joint_assignment"], options=OPTIONS)
    assert list(joint) == []


def test_a_stage_without_formulations_is_refused(two_rooms: Instance) -> None:
    with pytest.raises(InputError, match="'auction'; give one of clustering, cluster, victim"):
        score(two_rooms, "auction", "cluster_printed")
