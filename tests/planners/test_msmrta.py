from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import msmrta_opt as mo
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance, Robot, Scout, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan, Reason
from msmrta_opt.planners import plan, planners

STAGES = [
    "scouting",
    "requirement analysis",
    "clustering",
    "cluster assignment",
    "performance analysis",
    "victim assignment",
    "robot assignment",
    "path planning",
]

Read = Callable[[str], Instance]


@pytest.fixture(scope="session")
def read(instances_dir: Path) -> Read:
    return lambda name: Instance.read(instances_dir / f"{name}.json")


def planned(instance: Instance, preset: str = "paper", **options: Any) -> Plan:
    """The planner's plan, held against the checker here."""
    made = planners()["msmrta"].run(instance, preset=preset, **options)
    assert problems(made) == []
    return made


def visits(made: Plan, *stages: str) -> dict[int, list[int]]:
    """The victims that each robot visits, in order, in some stages or in all."""
    return {
        route.robot: [visit.victim for visit in route.visits if visit.stage in stages or not stages]
        for route in made.routes
    }


def times(made: Plan) -> dict[int, list[tuple[int, float, float]]]:
    """(victim, arrival, departure) of each robot's visits."""
    return {
        route.robot: [(visit.victim, visit.arrival, visit.departure) for visit in route.visits]
        for route in made.routes
    }


def reasons(made: Plan) -> dict[tuple[int, str], str]:
    return {(item.victim, item.kind): item.reason for item in made.unserved}


# The paper's mission


def test_the_authors_preset_gives_their_stage_b2_and_clusters(paper: Instance) -> None:
    made = planned(paper, "authors", psi=0.95)
    assert visits(made, "B2") == {0: [1, 0], 1: [], 2: [], 3: [9]}
    assert [cluster.victims for cluster in made.clusters] == [
        (0, 1, 5, 6, 8),
        (4,),
        (2, 3),
        (7, 9),
    ]
    assert [cluster.robots for cluster in made.clusters] == [(0,), (2,), (1,), (3,)]
    assert [cluster.deferred for cluster in made.clusters] == [(8,), (), (2,), ()]


def test_the_paper_preset_also_serves_whom_its_robots_satisfy_fully(paper: Instance) -> None:
    made = planned(paper)
    assert visits(made, "B2") == {0: [1, 0], 1: [3], 2: [], 3: [9, 7]}
    assert [cluster.deferred for cluster in made.clusters] == [(8,), (), (2,), ()]


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_all_of_the_papers_mission_is_served_but_the_fire_extinguishers(
    paper: Instance, preset: str
) -> None:
    made = planned(paper, preset)
    assert reasons(made) == {
        (2, "FireExtinguisher"): Reason.NO_ROBOT_HAS_IT,
        (5, "FireExtinguisher"): Reason.NO_ROBOT_HAS_IT,
    }
    assert (made.metrics.n_requirements, made.metrics.n_served) == (20, 18)
    assert made.metrics.served_share == 1
    assert made.metrics.victims_fully_served == 8


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_without_scouts_the_plan_is_the_same_as_with_scouts_who_find_everybody(
    paper: Instance, preset: str
) -> None:
    scouted, known = planned(paper, preset), planned(paper.replace(scouts=()), preset)
    assert scouted.scouting is not None
    assert scouted.scouting.not_found == ()
    assert known.scouting is None
    assert scouted.routes == known.routes


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_both_integer_programs_are_certified(paper: Instance, preset: str) -> None:
    made = planned(paper, preset)
    stated = [(c.stage, c.model, c.sense, c.status, c.check) for c in made.certificates]
    assert stated == [
        ("Eq. 1", "cluster_one_to_one", "max", "optimal", "passed"),
        ("Eq. 2", "victim_one_to_one", "min", "optimal", "passed"),
    ]
    for certificate in made.certificates:
        assert certificate.gap == 0
        assert certificate.objective == certificate.bound
        assert certificate.proof


def test_a_plan_says_how_it_was_made(paper: Instance) -> None:
    made = planned(paper, "authors", psi=0.5, seed=3, through_centre=False)
    assert made.planner == "msmrta"
    assert made.options["preset"] == "authors"
    assert (made.options["psi"], made.options["seed"]) == (0.5, 3)
    assert made.options["through_centre"] is False
    assert made.options["members"] == "partial"
    assert made.instance == paper
    assert list(made.planning_seconds) == STAGES


def test_a_plan_can_be_made_again_from_what_it_says(paper: Instance) -> None:
    made = planned(paper, "authors", psi=0.5, seed=3)
    assert planned(made.instance, **made.options).same_as(made)


def test_a_plan_read_from_its_file_is_the_same(paper: Instance, tmp_path: Path) -> None:
    made = planned(paper)
    made.save(tmp_path / "plan.json")
    assert Plan.read(tmp_path / "plan.json").same_as(made)


# Small missions, by hand


def test_a_corridor_is_walked_through_the_centre_or_straight(read: Read) -> None:
    # One robot at 1, victims at 0 and 4, centre 2, service 2. Both are 2 from the centre: id first.
    corridor = read("corridor")
    # 1 to 2 to 0 in 3, then 4.
    assert times(planned(corridor)) == {0: [(0, 3, 5), (1, 9, 11)]}
    assert times(planned(corridor, through_centre=False)) == {0: [(0, 1, 3), (1, 7, 9)]}


def test_a_victim_behind_a_wall_is_left_to_the_next_stage(read: Read) -> None:
    # Robot 0 at (4, 0) takes the cluster: 4 to the centre (1, 1), 2 to victim 0 + 2, 2 to victim 1
    # + 3. For victim 2, Eq. 2 compares 13 + 8 + 2 for robot 0 with 2 + 2 for robot 1.
    made = planned(read("two_rooms"))
    assert times(made) == {0: [(0, 6, 8), (1, 10, 13)], 1: [(2, 2, 4)]}
    assert visits(made, "B2") == {0: [0, 1], 1: []}
    assert visits(made, "B3") == {0: [], 1: [2]}
    assert [(c.centre, c.cell, c.deferred) for c in made.clusters] == [((1, 1), (1, 1), (2,))]
    # Without the centre, 4 to victim 0.
    straight = planned(read("two_rooms"), through_centre=False)
    assert times(straight) == {0: [(0, 4, 6), (1, 8, 11)], 1: [(2, 2, 4)]}


def test_a_victim_may_be_split_between_two_robots(read: Read) -> None:
    # Robot 0: 2 cells, service 3. Robot 1: 2 cells at 0.5, service 4.
    made = planned(read("split"))
    assert times(made) == {0: [(0, 2, 5)], 1: [(0, 4, 8)]}
    assert made.metrics.victims_fully_served == 1


def test_what_is_out_of_reach_or_of_nobodys_kind_is_named(read: Read) -> None:
    made = planned(read("walled_in"))
    assert times(made) == {0: [(0, 4, 6)]}
    assert reasons(made) == {
        (0, "Crane"): Reason.NO_ROBOT_HAS_IT,
        (1, "FirstAids"): Reason.NO_CAPABLE_ROBOT_REACHES_IT,
        (1, "Crane"): Reason.NO_ROBOT_HAS_IT,
    }


def test_a_victim_that_the_scouts_do_not_find_is_not_planned_for(read: Read) -> None:
    # Victim 1 is hidden, although robot 1 stands beside it.
    made = planned(read("scouted"))
    assert times(made) == {0: [(0, 3, 5)], 1: []}
    assert reasons(made) == {(1, "FirstAids"): Reason.NOT_FOUND}
    assert [cluster.victims for cluster in made.clusters] == [(0,)]
    known = planned(read("scouted").replace(scouts=()))
    assert times(known) == {0: [(0, 3, 5)], 1: [(1, 1, 3)]}


def test_without_victims_the_plan_is_empty(read: Read) -> None:
    made = planned(read("no_victims"))
    assert times(made) == {0: [], 1: []}
    assert (made.unserved, made.clusters, made.certificates) == ((), (), ())
    assert made.metrics.served_share == 1
    assert (made.metrics.distance, made.metrics.makespan) == (0, 0)


# Degenerate missions


def mission(
    robots: list[tuple[int, str]], victims: list[tuple[int, str]], **changes: Any
) -> Instance:
    """Robots and victims by column and kinds, in a corridor; ids are neither positions nor sorted
    the same way as they.
    """
    return Instance(
        map=grid_from_rows(["." * 10]),
        capabilities=("A", "B"),
        service_time={"A": 2.0, "B": 3.0},
        robots=tuple(
            Robot(id=50 + i, start=(0, column), speed=1.0, capabilities=tuple(has))
            for i, (column, has) in enumerate(robots)
        ),
        victims=tuple(
            Victim(id=90 - i, cell=(0, column), requirements=tuple(needs))
            for i, (column, needs) in enumerate(victims)
        ),
    ).replace(**changes)


PRESETS = pytest.mark.parametrize("preset", ["paper", "authors"])


@PRESETS
def test_one_robot_serves_everybody(preset: str) -> None:
    made = planned(mission([(0, "AB")], [(2, "A"), (5, "AB"), (9, "B")]), preset)
    assert sorted(visits(made)[50]) == [88, 89, 90]
    assert made.metrics.n_served == 4


@PRESETS
def test_all_victims_in_one_cell_are_one_cluster(preset: str) -> None:
    made = planned(mission([(0, "A"), (9, "AB")], [(4, "A"), (4, "AB"), (4, "B")]), preset)
    assert [(cluster.victims, cluster.cell) for cluster in made.clusters] == [
        ((90, 89, 88), (0, 4))
    ]
    assert made.metrics.n_served == 4


@PRESETS
def test_a_robot_without_capabilities_stays_at_its_start(preset: str) -> None:
    made = planned(mission([(4, ""), (9, "AB")], [(3, "A"), (5, "AB")]), preset)
    assert visits(made)[50] == []
    assert made.metrics.n_served == 3


@PRESETS
def test_where_no_robot_has_any_capability_nobody_moves(preset: str) -> None:
    made = planned(mission([(0, ""), (9, "")], [(3, "A"), (5, "AB")]), preset)
    assert visits(made) == {50: [], 51: []}
    assert set(reasons(made).values()) == {Reason.NO_ROBOT_HAS_IT}
    assert (made.metrics.n_available, made.metrics.served_share) == (0, 1)


@PRESETS
def test_nobody_goes_to_a_victim_without_requirements(preset: str) -> None:
    made = planned(mission([(0, "AB")], [(3, ""), (5, "A")]), preset)
    assert visits(made) == {50: [89]}
    assert made.metrics.victims_fully_served == 2


@PRESETS
def test_a_mission_may_have_no_kinds_at_all(preset: str) -> None:
    made = planned(mission([(0, "")], [(3, "")], capabilities=(), service_time={}), preset)
    assert visits(made) == {50: []}
    assert made.metrics.served_share == 1


@PRESETS
def test_scouts_who_find_nobody_leave_nothing_to_plan(preset: str) -> None:
    # The scout is shut in; robots and victims are in the other room.
    instance = mission(
        [(5, "AB"), (9, "A")],
        [(6, "A"), (7, "AB")],
        map=grid_from_rows([".@........"]),
        scouts=(Scout(id=1, start=(0, 0), visual_field_depth=3),),
    )
    made = planned(instance, preset)
    assert visits(made) == {50: [], 51: []}
    assert reasons(made) == {
        (90, "A"): Reason.NOT_FOUND,
        (89, "A"): Reason.NOT_FOUND,
        (89, "B"): Reason.NOT_FOUND,
    }
    assert (made.clusters, made.certificates) == ((), ())
    assert made.scouting is not None
    assert made.scouting.not_found == (90, 89)


@PRESETS
def test_a_victim_at_a_robots_start_is_served_at_once(preset: str) -> None:
    made = planned(mission([(3, "A")], [(3, "A")]), preset)
    assert times(made) == {50: [(90, 0, 2)]}
    assert made.metrics.distance == 0


def test_pinned_clusters_hold_for_the_victims_that_are_found() -> None:
    # The scout stands beside the first two victims and never gets to the third.
    instance = mission(
        [(9, "A")],
        [(6, "A"), (8, "A"), (0, "A")],
        map=grid_from_rows([".@........"]),
        scouts=(Scout(id=0, start=(0, 7), visual_field_depth=1),),
        clusters=(5, 2, 3),
    )
    made = planned(instance)
    assert [cluster.victims for cluster in made.clusters] == [(89,), (90,)]


# Options


def test_both_formulations_and_their_parameters_are_the_users_choice(paper: Instance) -> None:
    made = planned(
        paper, cluster_model="cluster_printed", victim_model="victim_covering", psi=0.3, beta=0.1
    )
    assert [c.model for c in made.certificates] == ["cluster_printed", "victim_covering"]
    # Covering leaves only what a second robot must do at a victim to the auction.
    covered = {victim for taken in visits(made, "B3").values() for victim in taken}
    assert {victim for taken in visits(made, "B4").values() for victim in taken} <= covered


def test_as_printed_eq_2_leaves_all_that_remains_to_the_auction(paper: Instance) -> None:
    assert visits(planned(paper, victim_model="victim_printed"), "B3") == {r: [] for r in range(4)}


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"psi": 1.5}, "psi"),
        ({"preset": "ours"}, "preset"),
        ({"center": True}, "center"),
        ({"cluster_model": "cluster_unheard_of"}, "model"),
        ({"victim_model": "victim_unheard_of"}, "model"),
        ({"planner": "by hand"}, "planner"),
    ],
)
def test_a_wrong_option_is_refused_by_name(
    paper: Instance, options: dict[str, Any], field: str
) -> None:
    with pytest.raises(InputError) as error:
        plan(paper, **options)
    assert error.value.field == field


@pytest.mark.parametrize(
    "options",
    [{"cluster_model": "victim_covering"}, {"victim_model": "cluster_printed"}],
)
def test_a_formulation_of_another_stage_is_refused_as_that(
    paper: Instance, options: dict[str, Any]
) -> None:
    with pytest.raises(InputError, match=r"is a (victim|cluster) formulation"):
        plan(paper, **options)


# Determinism


@PRESETS
def test_the_same_mission_and_seed_give_the_same_plan(paper: Instance, preset: str) -> None:
    first, second = (planned(paper, preset, pinned_clusters=False, seed=11) for _ in range(2))
    assert first.same_as(second)


def test_a_plan_does_not_depend_on_how_a_process_hashes_texts(
    paper: Instance, instances_dir: Path, tmp_path: Path
) -> None:
    script = (
        "import sys, msmrta_opt as mo\n"
        "mo.plan(mo.read(sys.argv[1]), pinned_clusters=False).save(sys.argv[2])\n"
    )
    paths = [instances_dir / "paper.json", tmp_path / "plan.json"]
    root = str(Path(mo.__file__).parents[1])
    subprocess.run(
        [sys.executable, "-c", script, *map(str, paths)],
        env=os.environ | {"PYTHONHASHSEED": "1", "PYTHONPATH": root},
        check=True,
    )
    assert Plan.read(paths[1]).same_as(planned(paper, pinned_clusters=False))
