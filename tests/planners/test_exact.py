"""The exact planner: against brute force, by hand, at any limit, and stopped by Ctrl-C."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.amounts import sample
from support.joint_oracle import minimum

import msmrta_opt as mo
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError, NoPlanError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows, read_map
from msmrta_opt.mission.named_maps import make_map
from msmrta_opt.mission.plan import Plan, Reason
from msmrta_opt.routing.combinatorial_bounds import latency_bound
from msmrta_opt.routing.objectives import OBJECTIVES
from msmrta_opt.routing.problem import RoutingData
from msmrta_opt.stages.joint_routing import routing_data
from msmrta_opt.stages.situation import Situation

MAPS = Path(__file__).parents[2] / "instances" / "maps"
SEEDS = range(4)


@cache
def mission(seed: int) -> Instance:
    """Three robots and four victims among walls; some requirements that no robot can serve."""
    grid = read_map(MAPS / f"map{(0, 2, 3)[seed % 3]}.map")
    return generate_mission(grid, 3, 4, seed=seed, solvable=False)


def joint(instance: Instance) -> RoutingData:
    return routing_data(Situation.of(instance))


@cache
def expected(seed: int, objective: str) -> float:
    return minimum(joint(mission(seed)), objective)


def proven(made: Plan) -> tuple[float, float, float]:
    """Value, bound and gap of a plan that holds, in an order that makes sense."""
    assert problems(made) == []
    (certificate,) = made.certificates
    assert certificate.check == "passed"
    value, bound, gap = certificate.objective, certificate.bound, certificate.gap
    assert value is not None
    assert bound is not None
    assert gap is not None
    assert bound <= value
    assert gap >= 0
    assert value == pytest.approx(getattr(made.metrics, certificate.model))
    return value, bound, gap


def status(made: Plan) -> str:
    return made.certificates[0].status


@pytest.mark.parametrize("objective", ["total_time", "makespan"])
@pytest.mark.parametrize("seed", sample(SEEDS, 2))
def test_a_small_mission_is_proven_to_be_worth_what_brute_force_finds(
    seed: int, objective: str
) -> None:
    made = mo.plan(mission(seed), planner="exact", objective=objective)
    value, bound, gap = proven(made)
    assert value == pytest.approx(expected(seed, objective))
    assert bound == pytest.approx(expected(seed, objective))
    assert (gap, status(made)) == (0, "optimal")


@pytest.mark.parametrize("seed", sample(SEEDS, 2))
def test_the_latency_of_a_small_mission_is_the_least_above_a_bound_that_holds(seed: int) -> None:
    made = mo.plan(mission(seed), planner="exact", objective="latency", time_limit=0.5)
    value, bound, _ = proven(made)
    assert value == pytest.approx(expected(seed, "latency"))
    assert bound <= expected(seed, "latency") + 1e-6


@pytest.mark.parametrize("seed", sample(range(20, 50), 8))
def test_no_routes_have_a_latency_below_the_bound(seed: int) -> None:
    grid = read_map(MAPS / f"map{(0, 2, 3)[seed % 3]}.map")
    data = joint(
        generate_mission(grid, 2, 3, seed=seed, per_robot=(2, 4), per_victim=(0, 3), solvable=False)
    )
    assert 0 <= latency_bound(data) <= minimum(data, "latency") + 1e-6


@pytest.mark.parametrize("time_limit", [0, 0.1, 1])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_plan_holds_and_its_bound_is_one_at_any_time_limit(
    objective: str, time_limit: float
) -> None:
    value, bound, _ = proven(
        mo.plan(mission(0), planner="exact", objective=objective, time_limit=time_limit)
    )
    assert bound <= expected(0, objective) + 1e-6
    assert value >= expected(0, objective) - 1e-6


@cache
def large(layout: str, n_robots: int, n_victims: int) -> Instance:
    size = None if layout.startswith("map") else (100, 120)
    grid = make_map(layout, size=size, seed=1)
    return generate_mission(grid, n_robots, n_victims, seed=1, solvable=False)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("size", [("map2", 6, 40), ("rooms", 9, 60), ("rooms", 40, 500)])
def test_a_larger_mission_stopped_at_once_has_a_plan_and_a_bound(
    size: tuple[str, int, int], objective: str
) -> None:
    mission = large(*size)
    first, bound, _ = proven(mo.plan(mission, planner="exact", objective=objective, time_limit=0))
    later, best, _ = proven(mo.plan(mission, planner="exact", objective=objective, time_limit=0.5))
    assert max(bound, best) <= later <= first + 1e-6


def test_it_stops_at_the_gap_that_is_allowed() -> None:
    made = mo.plan(mission(0), planner="exact", gap=0.9)
    _, bound, gap = proven(made)
    assert gap <= 0.9
    assert bound <= expected(0, "total_time") + 1e-6


# By hand: a robot at 1 of a corridor of five cells, victims at 0 and 4, service 2 each.


@pytest.fixture
def corridor(instances_dir: Path) -> Instance:
    return Instance.read(instances_dir / "corridor.json")


def test_a_robot_that_returns_walks_back_to_its_start(corridor: Instance) -> None:
    """1 + 4 + 3 moves and 4 of service; without the way back 1 + 4 + 4."""
    assert proven(mo.plan(corridor, planner="exact"))[0] == 9
    made = mo.plan(corridor, planner="exact", return_to_start=True)
    assert proven(made)[0] == 12
    assert made.routes[0].distance == 8
    assert made.routes[0].cells[-1] == (0, 1)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_limits_that_are_just_enough_change_nothing(corridor: Instance, objective: str) -> None:
    """Victim 0 is done at 3, victim 1 at 9, after 5 moves."""
    made = mo.plan(
        corridor,
        planner="exact",
        objective=objective,
        time_limit=0.2,
        endurance=9,
        longest_walk=5,
    )
    assert proven(made)[0] == {"total_time": 9, "makespan": 9, "latency": 12}[objective]


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"endurance": 4.5}, Reason.BEYOND_ENDURANCE),
        ({"longest_walk": 2}, Reason.BEYOND_LONGEST_WALK),
        ({"endurance": 4.5, "longest_walk": 3}, Reason.BEYOND_ENDURANCE),
        ({"endurance": 5, "longest_walk": 2}, Reason.BEYOND_LONGEST_WALK),
        ({"endurance": 4.5, "longest_walk": 2}, Reason.BEYOND_BOTH),
        ({"longest_walk": 5, "return_to_start": True}, Reason.BEYOND_LONGEST_WALK),
        ({"endurance": 7, "return_to_start": True}, Reason.BEYOND_ENDURANCE),
    ],
)
def test_what_is_beyond_every_robots_limits_is_left_out_for_the_limit_that_does_it(
    corridor: Instance, limits: dict[str, float], reason: Reason
) -> None:
    """Victim 1 alone takes 3 moves and 2 of service, and 3 moves back; victim 0 1, 2 and 1."""
    made = mo.plan(corridor, planner="exact", objective=None, **limits)
    assert proven(made)[0] == (4 if "return_to_start" in limits else 3)
    assert [(item.victim, item.reason) for item in made.unserved] == [(1, reason)]
    assert made.metrics.n_available == 2
    assert Plan.model_validate_json(made.model_dump_json(), strict=True) == made


def test_where_one_robot_lacks_time_and_another_may_not_walk_as_far_both_limits_do_it() -> None:
    """A slow robot 2 cells away needs 20 time units, a quick one 8 cells away needs 4."""
    mission = Instance(
        map=grid_from_rows(["." * 11]),
        capabilities=("A",),
        service_time={"A": 0},
        robots=(
            Robot(id=5, start=(0, 0), speed=0.1, capabilities=("A",)),
            Robot(id=6, start=(0, 10), speed=2, capabilities=("A",)),
        ),
        victims=(Victim(id=3, cell=(0, 2), requirements=("A",)),),
    )
    for limits, reasons in (
        ({"endurance": 10, "longest_walk": 5}, [Reason.BEYOND_BOTH]),
        ({"endurance": 20, "longest_walk": 5}, []),
        ({"endurance": 10, "longest_walk": 8}, []),
        ({"endurance": 3, "longest_walk": 8}, [Reason.BEYOND_ENDURANCE]),
        ({"endurance": 20, "longest_walk": 1}, [Reason.BEYOND_LONGEST_WALK]),
    ):
        made = mo.plan(mission, planner="exact", **limits)
        assert [item.reason for item in made.unserved] == reasons, limits


def test_a_plan_of_before_says_endurance_of_either_limit_and_still_holds(
    corridor: Instance,
) -> None:
    document = mo.plan(corridor, planner="exact", longest_walk=2).document()
    document["unserved"][0]["reason"] = "beyond the robots' endurance"
    assert problems(Plan.model_validate_json(json.dumps(document), strict=True)) == []


def test_a_limit_that_there_was_not_excuses_nothing(corridor: Instance) -> None:
    document = mo.plan(corridor, planner="exact", endurance=4.5).document()
    document["unserved"][0]["reason"] = "beyond the robots' longest walk"
    (wrong,) = problems(Plan.model_validate_json(json.dumps(document), strict=True))
    assert 'unserved for "beyond the robots\' longest walk"; in truth: available' in wrong


@pytest.mark.parametrize("limit", [{"endurance": 8.5}, {"longest_walk": 4}])
def test_limits_that_allow_each_victim_but_not_both_are_refused(
    corridor: Instance, limit: dict[str, float]
) -> None:
    with pytest.raises(NoPlanError, match="limits exists") as refused:
        mo.plan(corridor, planner="exact", objective=None, **limit)
    assert refused.value.field == next(iter(limit))
    assert refused.value.proven


def test_a_plan_within_limits_is_found_where_quick_planners_go_beyond_them() -> None:
    """Robots at 3 and 10, victims at 4, 5 and 7: the first robot is nearest to each in turn.

    It would walk 4 cells; with no more than 3 each, it serves 4 and 5 and the second walks 3 to 7.
    """
    mission = Instance(
        map=grid_from_rows(["." * 11]),
        capabilities=("A",),
        service_time={"A": 0},
        robots=tuple(
            Robot(id=r, start=(0, col), speed=1, capabilities=("A",))
            for r, col in enumerate((3, 10))
        ),
        victims=tuple(
            Victim(id=v, cell=(0, col), requirements=("A",)) for v, col in enumerate((4, 5, 7))
        ),
    )
    assert proven(mo.plan(mission, planner="exact"))[0] == 4
    made = mo.plan(mission, planner="exact", longest_walk=3)
    assert proven(made)[0] == 5
    assert [route.distance for route in made.routes] == [2, 3]


def test_no_victims_take_no_time(instances_dir: Path) -> None:
    none = Instance.read(instances_dir / "no_victims.json")
    for objective in OBJECTIVES:
        made = mo.plan(none, planner="exact", objective=objective)
        assert (proven(made), status(made)) == ((0, 0, 0), "optimal")


def test_victims_that_the_scouts_do_not_find_are_left_out(instances_dir: Path) -> None:
    made = mo.plan(Instance.read(instances_dir / "scouted.json"), planner="exact")
    assert proven(made)[0] == 5
    assert [(item.victim, item.reason) for item in made.unserved] == [(1, Reason.NOT_FOUND)]


@pytest.mark.parametrize(
    "option",
    [
        {"time_limit": -1.0},
        {"time_limit": "a"},
        {"gap": math.nan},
        {"gap": True},
        {"endurance": math.nan},
        {"endurance": math.inf},
        {"longest_walk": -1},
    ],
)
def test_an_option_out_of_range_is_refused_by_name(
    corridor: Instance, option: dict[str, Any]
) -> None:
    with pytest.raises(InputError) as refused:
        mo.plan(corridor, planner="exact", objective=None, **option)
    assert refused.value.field == next(iter(option))


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send on Windows")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_a_checked_plan_and_its_bound(number: int, tmp_path: Path) -> None:
    instance, answer = tmp_path / "large.json", tmp_path / "plan.json"
    generate_mission(read_map(MAPS / "map2.map"), 10, 100, seed=0, solvable=False).save(instance)
    command = "from msmrta_opt.cli import run; import sys; sys.exit(run(sys.argv[1:]))"
    line = ["exact", str(instance), "--json", str(answer), "--time-limit", "600"]
    with subprocess.Popen(
        [sys.executable, "-c", command, *line],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr is not None
        assert "bound" in process.stderr.readline()
        process.send_signal(number)
        _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    proven(Plan.read(answer))


def test_a_mission_too_large_for_the_formulation_has_a_plan_and_a_bound_at_once() -> None:
    tiny = {"branch_and_cut": {"maximum_edges": 1}, "heuristics": {"default_iterations": 50}}
    made = mo.plan(mission(0), planner="exact", time_limit=0.5, parameters=tiny)
    value, bound, _ = proven(made)
    assert bound <= expected(0, "total_time") <= value + 1e-6
    assert made.certificates[0].proof == "combinatorial"
    assert made.certificates[0].root is None
