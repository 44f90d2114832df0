"""The data of a stage's formulations, without planning the rest."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from msmrta_opt import formulations
from msmrta_opt.mission.errors import CheckError, InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.data import ClusterData, ClusteringData, JointAssignmentData, VictimData
from msmrta_opt.optimise.registry import models
from msmrta_opt.optimise.solve import solve
from msmrta_opt.planners import plan
from msmrta_opt.stages.data import STAGES, stage_data
from msmrta_opt.stages.options import StagedOptions


@pytest.fixture
def corridor() -> Instance:
    """Robots at both ends of five cells, a victim beside each; robot 1 has two of three kinds.

    Robot 0 has only Saw. In one cluster (pinned), robot 0 can serve 1 requirement and none in full,
    robot 1 three, two of them in full: so robot 1 takes it, and victim 0's need of Saw remains.
    """
    document = {
        "map": {"rows": ["....."]},
        "capabilities": ["Saw", "Aid", "Air"],
        "service_time": {"Saw": 7, "Aid": 1, "Air": 2},
        "robots": [
            {"id": 0, "start": [0, 0], "speed": 0.5, "capabilities": ["Saw"]},
            {"id": 1, "start": [0, 4], "speed": 1, "capabilities": ["Aid", "Air"]},
        ],
        "victims": [
            {"id": 0, "cell": [0, 1], "requirements": ["Saw", "Aid"]},
            {"id": 1, "cell": [0, 3], "requirements": ["Aid", "Air"]},
        ],
        "clusters": [0, 0],
    }
    return Instance.from_document({"format": "msmrta-instance/1", **document})


def test_the_data_of_a_stage_are_of_the_class_that_declares_it(paper: Instance) -> None:
    for name, stage in STAGES.items():
        data = stage_data(paper, name)
        assert type(data) is stage.data
        assert data.stage == name
        assert stage.data.solution


def test_every_shipped_formulation_is_for_a_stage_that_there_is() -> None:
    assert {item.formulation.spec.stage for item in models() if item.formulation} == set(STAGES)


def test_data_speak_of_robots_victims_and_kinds_by_their_ids(corridor: Instance) -> None:
    renumbered = corridor.replace(
        robots=[robot.model_copy(update={"id": 7 + robot.id}) for robot in corridor.robots],
        victims=[victim.model_copy(update={"id": 104 - victim.id}) for victim in corridor.victims],
        clusters=(0, 0),
    )
    for stage in ("cluster", "victim", "joint", "routing"):
        data = stage_data(renumbered, stage)
        assert data.along("r") == (7, 8)
        if "v" in data.axes:
            assert data.along("v") == (104, 103)
    assert stage_data(renumbered, "routing").along("k") == ("Saw", "Aid", "Air")
    assert stage_data(renumbered, "clustering").along("i") == ("(0, 1)", "(0, 3)")


def test_endurance_limits_the_joint_problem_too(corridor: Instance) -> None:
    """Robot 0 needs 2 to victim 0 and 7 for Saw there; with 8 it cannot serve it at all."""
    data = stage_data(corridor, "routing", StagedOptions(endurance=8))
    assert data.endurance.tolist() == pytest.approx([8, 8])
    assert not data.required[0, 0]
    assert stage_data(corridor, "routing").required[0, 0]


def test_clustering_data_are_the_walks_between_victims(corridor: Instance) -> None:
    data = stage_data(corridor, "clustering")
    assert isinstance(data, ClusteringData)
    assert data.distance.tolist() == [[0, 2], [2, 0]]
    assert data.weight.tolist() == [1, 1]
    assert data.n_clusters == 2


def test_cluster_data_are_the_weights_of_eq_1(corridor: Instance) -> None:
    data = stage_data(corridor, "cluster")
    assert isinstance(data, ClusterData)
    assert data.w.tolist() == [[1], [3]]
    assert data.w_full.tolist() == [[0], [2]]


def test_victim_data_are_the_times_after_cluster_assignment(corridor: Instance) -> None:
    data = stage_data(corridor, "victim")
    assert isinstance(data, VictimData)
    assert data.can_serve.tolist() == [[True, False], [False, False]]
    assert data.success[0, 0] == 1 / 0.5 + 7  # one cell at speed 0.5, then Saw
    assert data.failure[0, 0] == 0
    # Robot 1 walks 2 cells to the centre, 1 to victim 0 and 2 to victim 1, and serves Aid, Aid, Air.
    assert data.busy.tolist() == [0, 2 + 1 + 2 + 1 + 1 + 2]


def test_joint_data_are_those_of_both_equations(corridor: Instance) -> None:
    data = stage_data(corridor, "joint")
    assert isinstance(data, JointAssignmentData)
    assert data.w.tolist() == [[1], [3]]
    assert data.cluster.tolist() == [0, 0]


def test_options_reach_the_data_and_the_stages_before(corridor: Instance) -> None:
    def data(stage: str, **options: Any) -> Any:
        return stage_data(corridor, stage, StagedOptions.of(**options))

    assert data("cluster", budget=1).budget.tolist() == [1, 1]
    # The authors count partial satisfaction alone: only Aid of victim 0 is left of robot 1's three.
    assert data("cluster", weights="authors").w.tolist() == [[1], [1]]
    # With partial members alone robot 1 only gives Aid to victim 0, by way of the centre.
    assert data("victim", members="partial").busy.tolist() == [0, 2 + 1 + 1]
    # By themselves the two victims are two clusters, one for each robot: Saw and Aid, Air are done.
    assert data("victim", pinned_clusters=False).can_serve.sum() == 1


def test_victims_that_scouts_do_not_find_are_not_in_the_data(instances_dir: Path) -> None:
    # One robot on each side of the wall; the scout finds only victim 0, on the side of robot 0.
    data = stage_data(Instance.read(instances_dir / "scouted.json"), "cluster")
    assert data.w.tolist() == [[1], [0]]


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_a_formulation_on_the_data_is_what_the_planner_solves(preset: str, paper: Instance) -> None:
    options = StagedOptions.of(preset)
    certificates = {item.model: item for item in plan(paper, preset=preset).certificates}
    for stage, model, parameters in (
        ("cluster", options.cluster_model, {"psi": options.psi}),
        ("victim", options.victim_model, {"beta": options.beta}),
    ):
        solution = solve(model, stage_data(paper, stage, options), **parameters)
        assert solution.objective == pytest.approx(certificates[model].objective)
        assert solution.n_variables == certificates[model].n_variables


def test_an_unknown_stage_is_refused_by_name(paper: Instance) -> None:
    with pytest.raises(
        InputError, match="stage: no stage 'auction'; there are clustering, cluster"
    ):
        stage_data(paper, "auction")


def test_without_known_victims_there_is_nothing_to_decide(instances_dir: Path) -> None:
    with pytest.raises(InputError, match="victims: instance 'no_victims' has no known victims"):
        stage_data(Instance.read(instances_dir / "no_victims.json"), "cluster")


def test_a_stage_before_without_a_solution_is_an_error(
    corridor: Instance, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tmp_path / "cluster_nowhere.py"
    model.write_text(
        '"""Nobody can."""\n'
        "import cvxpy as cp\n"
        "from msmrta_opt.optimise.formulation import Spec\n"
        'SPEC = Spec(stage="cluster", title="nobody can")\n'
        "def build(data):\n"
        '    x = cp.Variable(data.w.shape, boolean=True, name="x")\n'
        "    return cp.Problem(cp.Maximize(0), [cp.sum(x) >= data.w.size + 1])\n"
    )
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__, str(tmp_path)])
    with pytest.raises(CheckError, match="cluster_nowhere: infeasible"):
        stage_data(corridor, "victim", StagedOptions.of(cluster_model="cluster_nowhere"))


def test_arrays_of_the_paper_are_of_four_robots_clusters_and_ten_victims(paper: Instance) -> None:
    assert stage_data(paper, "cluster").w.shape == (4, 4)
    assert stage_data(paper, "victim").success.shape == (4, 10)
    assert np.isfinite(stage_data(paper, "victim").success).all()
