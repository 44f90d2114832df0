"""Any plan as a MIP start: it is a point of the models, it is used, and what does not fit is refused."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.optimise.check import violations
from msmrta_opt.optimise.compile import compile_for
from msmrta_opt.planners.support.explicit_model import problem_of, solve_explicitly
from msmrta_opt.planners.support.mip_start import mip_start
from msmrta_opt.routing.objectives import OBJECTIVES
from msmrta_opt.routing.problem import RoutingData

MAPS = Path(__file__).parents[2] / "instances" / "maps"
PLANNERS = ("msmrta", "mrga", "ssi", "random")


@cache
def mission(seed: int = 3) -> Instance:
    """Four robots and ten victims: far from proven at once."""
    return generate_mission(read_map(MAPS / "map2.map"), 4, 10, seed=seed, solvable=False)


@cache
def problem(seed: int = 3) -> RoutingData:
    data = mo.stage_data(mission(seed), "routing")
    assert isinstance(data, RoutingData)
    return data


@cache
def planned(planner: str) -> Plan:
    return mo.plan(mission(), planner=planner)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("planner", PLANNERS)
def test_a_start_is_a_point_of_the_model_worth_what_the_plan_is(
    planner: str, objective: str
) -> None:
    model, parameters = OBJECTIVES[objective].model
    plan = planned(planner)
    program = compile_for(model, problem()).program(**parameters)
    x = program.flat(mip_start(plan, problem(), model))
    assert violations(program, x) == []
    # A robot that comes twice to a victim need not: the point may be better than the plan.
    assert program.value(x) <= getattr(plan.metrics, objective) + 1e-6
    if planner == "ssi":
        assert program.value(x) == pytest.approx(getattr(plan.metrics, objective))


@pytest.mark.parametrize("solver", ["auto", "highs", "scip"])
@pytest.mark.parametrize("model", ["joint_routing_flow", "joint_routing_mtz"])
def test_with_no_time_at_all_the_solution_is_the_start(model: str, solver: str) -> None:
    plan = planned("msmrta")
    start = mip_start(plan, problem(), model)
    without = mo.solve(model, problem(), solver=solver, time_limit=0)
    found = mo.solve(model, problem(), solver=solver, time_limit=0, start=start)
    assert not without.found
    assert found.found
    assert found.objective is not None
    assert found.objective <= plan.metrics.total_time + 1e-6


def test_a_plan_that_returns_within_limits_starts_a_problem_that_asks_for_it(
    instances_dir: Path,
) -> None:
    """1 + 4 + 3 moves and 4 of service; the last visit is left at 9, before the way back."""
    corridor = Instance.read(instances_dir / "corridor.json")
    limits = {"endurance": 12, "longest_walk": 8, "return_to_start": True}
    plan = mo.plan(corridor, planner="exact", **limits)
    data = problem_of(plan)
    program = compile_for("joint_routing_flow", data).program(w=1.0)
    x = program.flat(mip_start(plan, data))
    assert violations(program, x) == []
    assert program.value(x) == 12


def test_a_robot_that_the_plan_leaves_out_stays_at_home(instances_dir: Path) -> None:
    corridor = Instance.read(instances_dir / "corridor.json")
    robot = corridor.robots[0]
    two = corridor.replace(robots=(robot, robot.model_copy(update={"id": 5, "start": (0, 2)})))
    plan = mo.plan(two, planner="greedy")
    idle = [route.robot for route in plan.routes if not route.visits]
    short = plan.model_copy(update={"routes": tuple(r for r in plan.routes if r.visits)})
    data = mo.stage_data(two, "routing")
    start, whole = mip_start(short, data), mip_start(plan, data)
    assert all((start[name] == whole[name]).all() for name in whole)
    assert len(idle) + len(short.routes) == 2


def plan_beyond_limits() -> tuple[Plan, RoutingData, str]:
    plan = planned("ssi")
    limits = {"longest_walk": max(plan.metrics.distance_of.values()) - 1}
    options = {**plan.options, **limits}
    tight = plan.model_copy(update={"options": options, "promises": tuple(limits)})
    return plan, problem_of(tight), "joint_routing_flow"


REFUSED: dict[str, tuple[Any, str]] = {
    "another size": (
        lambda: (mo.plan(mission(3), planner="ssi"), problem_of(small()), "joint_routing_flow"),
        "start: a plan for 4 robots, 10 victims and 6 kinds, where the problem has 2 robots",
    ),
    "beyond limits": (plan_beyond_limits, "start: the plan does not fit: robot "),
}


@cache
def small() -> Plan:
    return mo.plan(
        generate_mission(read_map(MAPS / "map2.map"), 2, 3, seed=0, solvable=False), planner="ssi"
    )


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused_in_one_line(case: str) -> None:
    make, problem_ = REFUSED[case]
    plan, data, model = make()
    with pytest.raises(InputError) as refused:
        mip_start(plan, data, model)
    assert str(refused.value).startswith(problem_)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_explicit_model_proves_a_small_plan_again(objective: str) -> None:
    plan = mo.plan(small().instance, planner="exact", objective=objective, time_limit=1)  # type: ignore[arg-type]
    solution = solve_explicitly(plan, objective)
    assert solution.status == "optimal"
    assert solution.bound == pytest.approx(getattr(plan.metrics, objective))
    assert solution.options["start"] is True


def test_solvers_without_starts_solve_the_explicit_model_too() -> None:
    plan = mo.plan(small().instance, planner="exact")
    solution = solve_explicitly(plan, "total_time", solver="glpk")
    assert solution.objective == pytest.approx(plan.metrics.total_time)
