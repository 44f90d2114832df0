"""What the planner stores is what it solved: the same program, and the same bound, written twice."""

from __future__ import annotations

import importlib.util
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.searches import closed_in

from msmrta_opt.certify.certificates import worth
from msmrta_opt.certify.joint_problem import Joint
from msmrta_opt.certify.linear_relaxation import Relaxation, relaxation
from msmrta_opt.mission.errors import InputError, SolverError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.proof import RootProof
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import get
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.planners.support.explicit_model import problem_of
from msmrta_opt.planners.support.improvement import routes_of
from msmrta_opt.routing import second_solver as second_opinion
from msmrta_opt.routing.branch_and_cut.root_proof import RootRelaxation
from msmrta_opt.routing.second_solver import arrays, other_solver, root_again
from msmrta_opt.routing.stop import MaximumRuntime

MAPS = Path(__file__).parents[3] / "instances" / "maps"
CASES: list[tuple[str, dict[str, Any]]] = [
    ("total_time", {}),
    ("makespan", {}),
    ("total_time", {"endurance": 900.0}),
    ("makespan", {"return_to_start": True, "longest_walk": 130}),
]


@cache
def solved(case: int) -> tuple[Plan, RootRelaxation, RootProof, Relaxation]:
    """Four robots and nine victims; ids differ from positions."""
    objective, limits = CASES[case]
    mission = generate_mission(read_map(MAPS / "map2.map"), 4, 9, seed=5, solvable=False)
    mission = mission.replace(
        robots=tuple(r.model_copy(update={"id": 7 * r.id + 3}) for r in mission.robots),
        victims=tuple(v.model_copy(update={"id": 50 - v.id}) for v in mission.victims),
    )
    plan = make_plan(mission, planner="ssi")
    plan = plan.model_copy(update={"options": {**plan.options, **limits}})
    data = problem_of(plan)
    _, bound = closed_in(data, objective, routes_of(plan), MaximumRuntime(2))
    value = worth(plan, objective)
    assert bound.root is not None
    proof = bound.root.written(plan.known, float(value))
    assert isinstance(proof, RootProof)
    assert isinstance(bound.root, RootRelaxation)
    return plan, bound.root, proof, relaxation(Joint.of(plan), proof, value)


@pytest.mark.parametrize("case", range(len(CASES)))
def test_the_stored_dual_values_prove_what_the_planner_says_they_do(case: int) -> None:
    _, solution, proof, written = solved(case)
    root = solution.bound()
    # What the planner subtracts for rounding, and what dual values lose to twelve digits.
    assert float(written.bound()) == pytest.approx(root, rel=1e-7)
    assert proof.bound >= root - 1e-6


@pytest.mark.parametrize("case", range(len(CASES)))
def test_the_relaxation_written_out_again_is_no_stronger_than_the_planners(case: int) -> None:
    """Solved whole, with the cuts that have dual values, both have the same least value."""
    _, root, _, written = solved(case)
    ours = solve_program(root.program, solver="highs").objective
    again = solve_program(arrays(written), solver="highs").objective
    assert ours == pytest.approx(again, rel=1e-6)


@pytest.mark.parametrize("case", range(len(CASES)))
def test_another_solver_finds_at_least_what_the_dual_values_prove(case: int) -> None:
    _, _, _, written = solved(case)
    for name in ("glpk", "scip"):
        if not get(name).installed:
            pytest.skip(f"{name} is not installed")
        solution = root_again(written, solver=name)
        assert solution.solver == name
        assert solution.status == "optimal"
        assert solution.objective is not None
        assert solution.objective >= float(written.bound()) - 1e-6


def test_dual_values_of_nothing_are_not_stored() -> None:
    _, root, proof, _ = solved(0)
    stored = proof.model_dump().values()
    duals = [item["dual"] for part in stored if isinstance(part, tuple) for item in part]
    assert len(duals) == np.count_nonzero(root.dual_values)
    assert 0 not in duals


def test_the_solver_that_made_the_bound_is_not_asked_about_it() -> None:
    with pytest.raises(InputError, match="highs made the bound itself; give glpk or scip"):
        other_solver("highs")
    with pytest.raises(InputError, match="cpsat solves no linear programs"):
        other_solver("cpsat")
    with pytest.raises(InputError, match="no solver 'nobody'"):
        other_solver("nobody")
    assert other_solver("scip") == "scip"


def test_without_any_other_solver_one_line_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from msmrta_opt.optimise.solvers import base

    found = importlib.util.find_spec

    def only_highs(module: str) -> object:
        return found(module) is not None and module == "highspy"

    monkeypatch.setattr(base, "_importable", only_highs)
    with pytest.raises(
        SolverError, match=r"no solver but highs is installed; .*msmrta_opt\[solvers\]"
    ):
        second_opinion.other_solver()
