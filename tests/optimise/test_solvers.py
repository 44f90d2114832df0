"""Every installed solver keeps the same contract, on programs whose solution is known by hand.

The free ones must be installed. Of the commercial ones those that are not are named by one test that is
skipped, and nowhere else.
"""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import INF, assert_solved_right, best_value, program
from support.solver_contract import (
    COMMERCIAL,
    FREE,
    INSTALLED,
    KNOWN,
    able,
    every_solver,
    refusal,
    solve,
)

from msmrta_opt.mission.errors import SolverError
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Solver, get


@pytest.mark.parametrize("name", INSTALLED)
def test_a_solver_has_a_version(name: str) -> None:
    assert get(name).version


@pytest.mark.parametrize("name", [name for name in ("scip", "glpk") if name in INSTALLED])
def test_the_version_of_a_solver_is_its_own_not_that_of_its_package(name: str) -> None:
    said = {"scip": lambda: import_module("pyscipopt").Model().version(),
            "glpk": lambda: import_module("swiglpk").glp_version()}  # fmt: skip
    own, package = str(said[name]()), get(name).package_version
    assert get(name).version.startswith(own)
    assert get(name).version != package


def test_free_solvers_are_installed_and_commercial_ones_that_are_not_are_named() -> None:
    missing = [name for name in (*FREE, *COMMERCIAL) if name not in INSTALLED]
    assert not set(missing) & set(FREE)
    if missing:
        pytest.skip(f"not installed, so not tested: {', '.join(missing)}")


@every_solver
@pytest.mark.parametrize("name", KNOWN)
def test_the_solution_known_by_hand_is_found_and_proven(solver: Solver, name: str) -> None:
    case = KNOWN[name]
    if problem := refusal(solver, case.asked):
        with pytest.raises(SolverError, match=problem):
            solve(solver, case.asked)
        return
    solution = solve(solver, case.asked)
    if case.best == "unbounded":
        assert solution.status == "unbounded", solution
        assert solution.objective is None
    else:
        assert_solved_right(solution, None if case.best == "infeasible" else case.best)


@every_solver
def test_an_unbounded_relaxation_without_integer_points_is_not_called_unbounded(
    solver: Solver,
) -> None:
    asked = program([[2, -2]], 1, [-1, 0], row_lower=1, upper=INF)
    if refusal(solver, asked):
        return
    solution = solve(solver, asked, time_limit=1.0)
    assert solution.status in ("infeasible", "no_solution")


ENDLESS = [
    # At x = -3 the second row is y = 3z and the first z <= 0, so that the cost is z - 24.
    program(
        [[0, 4, -1], [3, -1, 3]],
        [0, -9],
        [8, 2, -5],
        row_lower=[-INF, -9],
        lower=[-3, -INF, -INF],
        upper=INF,
        integer=[True, False, False],
    ),
    # At z = -2 the row is x = 2y + 2, so that the cost is -11y - 8.
    program(
        [[-1, 2, 5]],
        -12,
        [-3, -5, 1],
        row_lower=-12,
        lower=[-1, 1, -3],
        upper=[INF, INF, -2],
        integer=[True, True, False],
    ),
]


@able("integer", "lp")
@pytest.mark.parametrize("asked", ENDLESS, ids=["two free columns", "two integers"])
def test_a_mixed_program_that_improves_without_end_is_unbounded(
    solver: Solver, asked: Program
) -> None:
    # Left to themselves, Gurobi calls a point of the first optimal, and SCIP never ends the second.
    assert solve(solver, asked, time_limit=5.0).status == "unbounded"


@st.composite
def small_programs(draw: st.DrawFn) -> Program:
    """Up to 4 integer columns and 3 rows; whole numbers, tenths, thirds or any."""
    n_columns, n_rows = draw(st.integers(1, 4)), draw(st.integers(0, 3))
    kind = draw(st.sampled_from(["whole", "tenths", "thirds", "any"]))
    share = {"whole": 1, "tenths": 10, "thirds": 3, "any": 7.1}[kind]
    number = (
        st.integers(-5, 5) if kind != "any" else st.integers(-5000, 5000).map(lambda n: n / 977)
    )
    cells = st.lists(number, min_size=n_columns, max_size=n_columns)
    matrix = np.array(draw(st.lists(cells, min_size=n_rows, max_size=n_rows)), float) / share
    lower = np.array(draw(st.lists(st.integers(-3, 1), min_size=n_columns, max_size=n_columns)))
    widths = draw(st.lists(st.integers(0, 3), min_size=n_columns, max_size=n_columns))
    upper = lower + np.array(widths) + draw(st.sampled_from([0.0, 0.0, 0.5]))
    # Rows are tight at some point within the bounds, or just miss it.
    middle = np.floor((lower + upper) / 2)
    ends = matrix.reshape(n_rows, n_columns) @ middle + draw(st.sampled_from([0, 0, 0.25]))
    kinds = draw(
        st.lists(st.sampled_from(["<", ">", "=", "<>", ""]), min_size=n_rows, max_size=n_rows)
    )
    low = {"<": -INF, ">": 0, "=": 0, "<>": -1, "": -INF}
    high = {"<": 0, ">": INF, "=": 0, "<>": 2, "": INF}
    return program(
        matrix.reshape(n_rows, n_columns),
        [end + high[kind] for end, kind in zip(ends, kinds, strict=True)],
        np.array(draw(cells), float) / share,
        row_lower=[end + low[kind] for end, kind in zip(ends, kinds, strict=True)],
        lower=lower,
        upper=upper,
        sense=draw(st.sampled_from(["min", "max"])),
        offset=draw(st.integers(-5, 5)),
    )


@given(small_programs())
@settings(max_examples=examples(100))
def test_installed_solvers_agree_with_enumeration(asked: Program) -> None:
    best = best_value(asked)
    for name in (*FREE, *COMMERCIAL):
        if get(name).installed:
            assert_solved_right(solve(get(name), asked), best)


@pytest.mark.parametrize("solver", ["auto", "highs", "scip"])
def test_integers_without_bounds_crash_nothing(solver: str) -> None:
    # -8 y + 6 z - 2 w ≤ 16 and 5 y - 6 z - 2 w ≤ -18 make 3 y ≥ 2 - 4 w, so with w ≤ 1 y is at least 0;
    # but with z ≤ 2 the second has 5 y ≤ -4.
    rows = [
        *([0, 0, 0, -8], [0, -4, 0, 1], [2, 0, 8, 0], [0, -5, 6, 2], [0, -8, 6, -2]),
        *([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1], [0, 5, -6, -2]),
        *([-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -2, 0], [0, 0, 0, -1]),
    ]
    sides = [INF, INF, INF, INF, 16, INF, INF, 4, 1, -18, 1, 1, 2, 1]
    whole = [False, True, True, True]
    asked = program(rows, sides, 0, lower=-INF, upper=INF, integer=whole)
    found = solve_program(asked, solver=solver)
    assert found.status == "infeasible"
