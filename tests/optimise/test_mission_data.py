"""What a stage's data knows of its mission, against searches by hand; the table of what it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.by_hand import Distances

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.axes import StageData
from msmrta_opt.optimise.data import ClusterData
from msmrta_opt.optimise.documentation import documented
from msmrta_opt.stages.data import STAGES, stage_data
from msmrta_opt.stages.options import StagedOptions

README = Path(__file__).parents[2] / "models" / "README.md"


@pytest.fixture(scope="module")
def walled(instances_dir: Path) -> Instance:
    return Instance.read(instances_dir / "walled_in.json")


def test_distances_are_those_of_a_search_by_hand(paper: Instance, breadth_first: Distances) -> None:
    data = stage_data(paper, "cluster")
    assert data.around is not None
    centres = data.around.centres
    for r, robot in enumerate(paper.robots):
        field = breadth_first(paper.map, robot.start)
        assert data.walk_to_cluster[r].tolist() == [field[cell] for cell in centres]
        assert data.walk_to_victim[r].tolist() == [field[victim.cell] for victim in paper.victims]
        times = [field[cell] / robot.speed for cell in centres]
        assert data.travel_to_cluster[r].tolist() == pytest.approx(times)
    between = [[breadth_first(paper.map, a)[b] for b in centres] for a in centres]
    assert data.walk_between_clusters.tolist() == between


def test_what_cannot_be_reached_is_told_apart_from_what_is_near(walled: Instance) -> None:
    data = stage_data(walled, "cluster")
    unreachable = np.argwhere(~data.can_reach)
    assert len(unreachable)
    assert not data.walk_to_victim[~data.can_reach].any()
    assert data.can_enter.shape == data.w.shape


def test_members_sizes_and_the_papers_matrices_are_those_of_the_mission(paper: Instance) -> None:
    data = stage_data(paper, "cluster")
    # The published clusters: Table 1.
    assert data.member.argmax(axis=1).tolist() == list(paper.clusters or ())
    assert data.size.tolist() == [5, 1, 2, 2]
    assert np.array_equal(data.capable, paper.P)
    assert np.array_equal(data.requires, paper.Q)
    assert data.speed.tolist() == [0.2, 0.3, 0.4, 0.3]
    assert data.mission is paper


def test_neighbours_have_no_third_cluster_between_them(paper: Instance) -> None:
    data = stage_data(paper, "cluster")
    walks = data.walk_between_clusters
    n = len(walks)
    for c in range(n):
        for d in range(n):
            between = [e for e in range(n) if max(walks[c, e], walks[d, e]) < walks[c, d]]
            assert data.neighbouring[c, d] == (c != d and not between)


def test_victims_are_seen_from_where_the_stage_before_leaves_the_robots(
    paper: Instance, breadth_first: Distances
) -> None:
    data = stage_data(paper, "victim")
    assert data.around is not None
    for r, cell in enumerate(data.around.robots):
        field = breadth_first(paper.map, cell)
        assert data.walk_to_victim[r].tolist() == [field[victim.cell] for victim in paper.victims]


def test_the_option_apart_names_robots_by_their_ids(paper: Instance) -> None:
    data = stage_data(paper, "cluster", StagedOptions.of(apart="3,1"))
    assert data.apart.tolist() == [False, True, False, True]
    with pytest.raises(InputError, match="apart: no robot 7; there are 0, 1, 2, 3"):
        stage_data(paper, "cluster", StagedOptions.of(apart="7"))
    with pytest.raises(InputError, match="apart: 'two'; give ids of robots"):
        StagedOptions.of(apart="two")


def test_nothing_is_worked_out_before_it_is_asked_for(paper: Instance) -> None:
    data = stage_data(paper, "cluster")
    derived = {item.name for item in documented(ClusterData)} - {"w", "w_full", "budget"}
    assert not derived & data.__dict__.keys()
    assert data.walk_to_cluster is data.walk_to_cluster


def test_data_made_by_hand_says_that_it_has_no_mission() -> None:
    data = ClusterData(np.ones((1, 1)), np.ones((1, 1)), np.ones(1, int))
    with pytest.raises(InputError, match=r"speed: needs the mission, .* mo.stage_data"):
        _ = data.speed


@pytest.mark.parametrize("stage", STAGES)
def test_a_field_has_the_axes_and_the_lengths_that_are_said_of_it(
    stage: str, paper: Instance
) -> None:
    data: StageData = stage_data(paper, stage)
    for item in documented(type(data)):
        value = getattr(data, item.name)
        if item.letters:
            assert value.shape == tuple(len(data.along(x)) for x in item.letters), item.name
        assert item.meaning, item.name


@pytest.mark.parametrize("stage", STAGES)
def test_the_table_of_the_readme_says_what_the_classes_say(stage: str) -> None:
    kind = STAGES[stage].data
    text = README.read_text(encoding="utf-8")
    section = text.split(f"### `{kind.__name__}`")[1].split("\n#")[0]
    rows = [
        tuple(cell.strip() for cell in line.strip("|").split("|"))
        for line in section.splitlines()
        if line.startswith("| `")
    ]
    own = [(f"`{x.name}`", ", ".join(x.letters), x.unit, x.meaning) for x in documented(kind)]
    assert rows == own
