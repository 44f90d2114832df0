"""No wrong "optimal", no wrong "infeasible": what badly scaled programs and solvers' slips come to."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.programs import INF, program

from msmrta_opt.mission.errors import InputError, UnsupportedError
from msmrta_opt.optimise.check import proves_infeasible
from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.formulation import Parameter
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options, Outcome, get, solvers

FREE = ("auto", "highs", "scip", "glpk")
every = pytest.mark.parametrize("solver", FREE)


@every
@pytest.mark.parametrize("power", range(-12, 13, 3))
def test_costs_of_any_unit_have_the_same_optimum(solver: str, power: int) -> None:
    """3 x0 + 5 x1 + 4 x2 + 9 x3, covered at 8 by the first two."""
    unit = 10.0**power
    cover = program(
        [[2, 3, 2, 5], [1, 0, 1, 0]], [INF, 1], unit * np.array([3, 5, 4, 9]), row_lower=[5, -INF]
    )
    solution = solve_program(cover, solver=solver)
    assert solution.status == "optimal"
    assert solution.values["x"].tolist() == [1, 1, 0, 0]
    assert solution.objective == pytest.approx(8 * unit)


@every
@pytest.mark.parametrize("power", range(-12, 10, 3))
def test_rows_of_any_unit_have_the_same_optimum(solver: str, power: int) -> None:
    """Wait at least so long, counted in a small unit."""
    wait = program([[10.0**power]], INF, 1, row_lower=[1.0], upper=1e13)
    solution = solve_program(wait, solver=solver)
    assert solution.objective == pytest.approx(max(10.0**-power, 1))
    assert solution.status in ("optimal", "claimed")


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk", "cpsat"])
@pytest.mark.parametrize(
    "trial",
    [
        program([[1e9, 1e9, 1e9, 100]], 999999998, [1, 0, 0, 0], row_lower=999999998),
        program([[14400001, 14400000]], 28800000, 1, lower=1),
        program([[14400.001, 14400.0]], 28800.0, 1, lower=1),
        program([[1e12, 1e12]], 1e12 - 1, 1, row_lower=1e12 - 1),
        program([[3e8, 5e8]], 4e8, 1, row_lower=4e8, upper=9),
    ],
    ids=["a weighing", "a shift", "a shift in seconds", "by one in a billion", "a gap of values"],
)
def test_a_row_of_whole_numbers_is_kept_to_the_last_unit(solver: str, trial: Program) -> None:
    if solver != "auto" and not get(solver).installed:
        return
    solution = solve_program(trial, solver=solver)
    assert not solution.found
    assert solution.status in ("infeasible", "contradicted", "error")
    if solver == "auto":
        assert solution.status == "infeasible"


@every
@pytest.mark.parametrize("big", [1e4, 1e7, 1e9, 1e16, 1e20])
def test_a_big_m_does_not_let_the_switch_slip(solver: str, big: float) -> None:
    """x up to 10 only with a switch that costs 3."""
    switch = program([[1, -big]], 0, [1, -3], upper=[10, 1], integer=[False, True], sense="max")
    solution = solve_program(switch, solver=solver)
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(7)
    assert solution.values["x"].tolist() == [10, 1]


@pytest.mark.parametrize("solver", ["highs", "scip", "glpk"])
def test_a_coefficient_that_solvers_drop_is_refused_by_row_and_column(solver: str) -> None:
    mixed = program([[1e-18, 1e4, 1.0]], 1, 1, upper=INF, sense="max")
    with pytest.raises(UnsupportedError, match=r"row 'row 0': the coefficient 1e-18 of x\[0\]"):
        solve_program(mixed, solver=solver)


@pytest.mark.parametrize("solver", ["highs", "scip"])
@pytest.mark.parametrize("constant", [1e7, 1e9, -1e9, 1e12])
@pytest.mark.parametrize("gap", [0.5, 1e-6])
def test_a_constant_closes_no_gap(solver: str, constant: float, gap: float) -> None:
    random = np.random.default_rng(3)
    cost = random.integers(1, 60, 30).astype(float)
    rows = random.integers(0, 9, (12, 30)).astype(float)
    cover = program(rows, INF, cost, row_lower=np.round(rows.sum(1) * 0.45), offset=constant)
    stopped = solve_program(cover, solver=solver, options=Options(gap=gap))
    assert stopped.bound is not None
    assert stopped.objective is not None
    assert stopped.bound - constant <= 176 + 1e-3 <= stopped.objective - constant + 2e-3
    assert (stopped.status == "optimal") == (stopped.objective - constant < 176.5)


def test_a_solver_that_calls_a_feasible_program_infeasible_is_contradicted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    liar = replace(get("highs"), name="liar", run=lambda *_: Outcome("infeasible"))
    monkeypatch.setitem(solvers(), "liar", liar)
    large = program(np.ones((1, 40)), INF, 1, row_lower=2)
    solution = solve_program(large, solver="liar")
    assert solution.status == "contradicted"
    assert "has a feasible point" in solution.message
    assert not solution.found


def test_an_infeasible_relaxation_is_certified_in_fractions() -> None:
    solution = solve_program(program(np.ones((2, 40)), [1, INF], 1, row_lower=[-INF, 2]))
    assert solution.status == "infeasible"
    assert "Farkas" in solution.proof


def test_a_ray_proves_only_what_it_proves() -> None:
    conflict = program([[1, 1], [1, 1]], [1, INF], 1, row_lower=[-INF, 2])
    assert proves_infeasible(conflict, np.array([-1.0, 1.0]))
    assert proves_infeasible(conflict, np.array([1.0, -1.0]))
    assert not proves_infeasible(conflict, np.array([0.0, 0.5]))
    fine = replace(conflict, row_lower=np.array([-INF, 1.0]))
    assert not proves_infeasible(fine, np.array([-1.0, 1.0]))


def test_a_solution_says_its_tolerances_and_what_became_of_its_start() -> None:
    knapsack = program([[2, 3]], 7, [3, 4], upper=3, sense="max")
    solution = solve_program(knapsack, solver="scip", options=Options(start=np.array([3.0, 3.0])))
    assert solution.start == "not used: row 'row 0' is missed by 8"
    assert solution.tolerances["integrality"] == 1e-6
    used = solve_program(knapsack, solver="scip", options=Options(start=np.array([2.0, 0.0])))
    assert used.start == "feasible, worth 6"


@pytest.mark.parametrize("solver", ["auto", "highs", "glpk"])
def test_a_dual_value_is_what_a_unit_more_of_the_side_is_worth(solver: str) -> None:
    """max 3x + 2y, x + y ≤ 4: worth 3 a unit; min 3x + 2y, x + y ≥ 4: 2 a unit."""
    maximum = program([[1, 1]], 4, [3, 2], upper=INF, integer=False, sense="max")
    minimum = program([[1, 1]], INF, [3, 2], row_lower=4, upper=INF, integer=False)
    for trial, worth in ((maximum, 3), (minimum, 2)):
        assert solve_program(trial, solver=solver).duals["row {i}"].tolist() == [worth]


@pytest.mark.parametrize(
    ("entries", "side", "right"),
    [
        ([1.0, 0.0], 3.0, 1.0),
        ([2.0, 0.0], 6.0, 0.5),
        ([0.0, 5.0], 5.0, 0.4),
        ([0.0, -1.0], None, 0.0),
    ],
)
def test_the_dual_value_of_a_row_of_one_variable_is_no_bound_s(
    entries: list[float], side: float | None, right: float
) -> None:
    """x0 + 2 x1 with whole numbers from 0 on: a unit more of the side costs cost / coefficient."""
    row_lower = -INF if side is None else side
    wait = program([entries], INF, [1.0, 2.0], row_lower=[row_lower], upper=10.0)
    found = solve_program(wait)
    assert (found.status, found.duals["row {i}"].tolist()) == ("optimal", [right])


@pytest.mark.parametrize("big", [1e7, 1e16])
def test_a_row_that_does_not_bind_has_no_dual_value_of_a_smaller_big_m(big: float) -> None:
    """x of at most 5 through a switch: at 5 and 1 the row has big - 5 left."""
    switch = program([[1.0, -big]], 0.0, [1.0, -1.0], upper=[5.0, 1.0], sense="max")
    found = solve_program(switch)
    assert (found.status, found.objective, found.bound, found.duals) == ("optimal", 4, 4, {})
    lp = solve_program(replace(switch, integer=np.zeros(2, dtype=bool)))
    assert lp.duals["row {i}"].tolist() == pytest.approx([1 / big])
    assert switch.with_tight_coefficients().matrix.data.tolist() == [1.0, -5.0]
    whole = program([[1.0, -5.0]], 0.0, [1.0, -1.0], upper=[5.0, 1.0], sense="max")
    assert whole.with_tight_coefficients() is whole


def test_a_row_whose_only_coefficient_is_0_has_the_dual_value_0() -> None:
    wait = program([[1.0, 0.0], [1.0, 0.0]], INF, [1.0, 2.0], row_lower=[0.0, 3.0], upper=10.0)
    zero = wait.matrix.copy()
    zero.data[0] = 0.0
    found = solve_program(replace(wait, matrix=zero))
    assert (found.status, found.objective) == ("optimal", 3)
    assert found.duals["row {i}"].tolist() == [0.0, 1.0]


@pytest.mark.parametrize("upper", [10.0, 1e6, 1e9, 1e12])
def test_a_far_bound_on_which_nothing_leans_costs_no_proof(upper: float) -> None:
    wait = program([[0.1]], INF, 1.0, row_lower=[0.3], upper=upper)
    found = solve_program(wait)
    assert (found.status, found.objective, found.bound) == ("optimal", 3, 3)


@pytest.mark.parametrize("kind", [{"integer": True}, {"integer": True, "nonneg": True}])
@pytest.mark.parametrize("value", [0.5, 1.25, 2.999])
def test_a_whole_number_parameter_takes_no_fraction(value: float, kind: dict[str, bool]) -> None:
    import cvxpy as cp
    from support.programs import formulation

    def build(_: Any) -> cp.Problem:
        k, x = cp.Parameter(**kind, name="k"), cp.Variable(3, boolean=True, name="x")
        return cp.Problem(cp.Maximize(cp.sum(x)), [cp.sum(x) <= k])

    compiled = compile_formulation(formulation(build, k=Parameter(0, 3, 1, "how many")), None)
    with pytest.raises(InputError, match=f"^k: {value}"):
        compiled.program(k=value)
    assert compiled.program(k=2).row_upper.tolist() == [2]


DISJUNCTION = "two tasks of 3 and 4 on one machine, by a big M: 7 is the optimum"


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
@pytest.mark.parametrize("big", [1e6, 1e7, 1e9])
def test_a_big_m_excuses_no_missed_row(solver: str, big: float) -> None:
    # s₁ ≥ s₀ + 3 - M (1 - o), s₀ ≥ s₁ + 4 - M o, t ≥ s₀ + 3, t ≥ s₁ + 4.
    asked = program(
        [[1, -1, big, 0], [-1, 1, -big, 0], [-1, 0, 0, 1], [0, -1, 0, 1]],
        [big - 3, -4, INF, INF],
        [0, 0, 0, 1],
        row_lower=[-INF, -INF, 3, 4],
        upper=[1e6, 1e6, 1, INF],
        integer=[False, False, True, False],
    )
    found = solve_program(asked, solver=solver)
    if found.found:
        x = found.values["x"]
        assert found.objective == pytest.approx(7), DISJUNCTION
        assert x[1] >= x[0] + 3 - 1e-5 or x[0] >= x[1] + 4 - 1e-5
    assert found.bound is None or found.bound <= 7 * (1 + 1e-9)


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
@pytest.mark.parametrize("big", [1e5, 1e8])
def test_no_little_need_is_met_through_a_closed_switch(solver: str, big: float) -> None:
    # q_i ≤ M z_i for twelve i, Σ q ≥ 0.01: one switch at 1 and half a hundredth are 1.005.
    n = 12
    rows = np.hstack([-big * np.eye(n), np.eye(n)])
    asked = program(
        np.vstack([rows, [0] * n + [1] * n]),
        [0] * n + [INF],
        [*range(1, n + 1), *[0.5] * n],
        row_lower=[-INF] * n + [0.01],
        upper=[1] * n + [INF] * n,
        integer=[True] * n + [False] * n,
    )
    found = solve_program(asked, solver=solver)
    assert not found.found or found.objective == pytest.approx(1.005)


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
def test_a_side_that_solvers_take_for_infinite_is_refused_by_its_row(solver: str) -> None:
    asked = program([[1, 1]], 1e25, 1, sense="max", upper=INF, integer=False)
    with pytest.raises(UnsupportedError, match=r"side 1e\+25 of 'row 0'"):
        solve_program(asked, solver=solver)


def test_what_a_fixed_column_costs_is_a_constant() -> None:
    asked = program([[1, 1, 0]], 1, [-3, -2, 1e9], lower=[0, 0, 1], upper=1)
    assert (asked.constant, asked.varying.tolist()) == (1e9, [-3, -2, 0])
    found = solve_program(asked)
    assert (found.objective, found.offset) == (1e9 - 3, 1e9)


LARGE_WHOLE: dict[str, tuple[Program, float]] = {
    # The optimum is proved in exact numbers by a certificate; HiGHS' cuts lose the first three.
    "costs up to 8": (
        program(
            [[0, 0, 5, 9, -8, 4, 0, -9, 4, 0, 8], [-8, -3, -5, 0, 0, 9, 3, 8, 0, 0, 2]],
            [414827, 361698],
            [-7, -3, -8, 6, 1, 8, -6, -8, -2, 2, -5],
            row_lower=[414827, -INF],
            upper=[8448, 15176, 64744, 21189, 6333, 45462, 5743, 4969, 17817, 23963, 57325],
            sense="max",
        ),
        476086,
    ),
    "a row": (
        program(
            [[-7, 9, 0, 5, 0, 0, 5, 8]],
            809625,
            np.array([-5, 6, -4, -1, 2, -6, 2, 9]) * 1e4,
            row_lower=809625,
            upper=[1, 214024, 734876, 144583, 77918, 1, 1, 1],
        ),
        -30262840000,
    ),
    "costs of a million": (
        program(
            [
                [-9, -3, 0, -3, 2, 2, -2, 9, 0, -2, 1, 0, 0],
                [0, 0, 5, -4, -8, -2, 0, -1, -1, 0, -9, -7, 0],
                [-7, -8, -6, 0, 0, 7, 3, -6, 4, 0, 0, 0, -6],
            ],
            [INF, 6337725, -7605765],
            np.array([6, 2, -1, -5, 9, -7, 5, -6, -6, -8, -5, -1, -3]) + 1e6,
            row_lower=[3633580, -INF, -7605765],
            lower=-(ends := np.array([8075, 660824, 883804, 200864, 691763, 327069, 802263, 166102,
                                      984689, 535746, 164072, 571266, 743210])),
            upper=ends,
            sense="max",
        ),
        4586909205499,
    ),
    # All say so: 3 x + 7 y = 30000 x's, at y = 0, x = 10000.
    "no doubt": (program([[3, 7]], 30000, [2, 1], upper=INF, row_lower=30000, sense="max"), 20000),
}  # fmt: skip


@pytest.mark.parametrize("name", LARGE_WHOLE)
@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk", "cpsat"])
def test_of_large_whole_numbers_no_solver_is_believed_alone(name: str, solver: str) -> None:
    asked, best = LARGE_WHOLE[name]
    try:
        found = solve_program(asked, solver=solver)
    except UnsupportedError:
        assert (name, solver) == ("no doubt", "cpsat")
        return
    if found.status in ("optimal", "feasible"):
        assert found.objective == best
        assert found.bound == best
    if solver == "auto":
        assert found.objective == best
    else:
        assert found.status in ("claimed", "error") or "dual values" in found.proof


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk", "cpsat"])
@pytest.mark.parametrize("far", [1e4, 1e9, 1e12])
def test_bounds_that_no_solution_comes_near_raise_no_doubt(solver: str, far: float) -> None:
    # 2 x + 2 y + 4 z ≤ 7: three of x and y.
    asked = program([[2, 2, 4]], 7, [3, 3, 5], upper=far, sense="max")
    found = solve_program(asked, solver=solver)
    assert (found.status, found.objective) == ("optimal", 9)


def test_a_second_solver_that_agrees_leaves_no_doubt_of_large_whole_numbers() -> None:
    # 2 x + 4 y ≤ 59999, x + 3 y ≤ 40000: x = 29999, y = 0.
    found = solve_program(program([[2, 4], [1, 3]], [59999, 40000], [3, 5], upper=INF, sense="max"))
    assert (found.status, found.objective) == ("optimal", 3 * 29999)


def test_a_program_without_variables_is_worth_its_constant() -> None:
    nothing = program(np.zeros((1, 0)), 1, 0.0, row_lower=-1, upper=1, offset=4.5)
    found = solve_program(nothing)
    assert (found.status, found.objective) == ("optimal", 4.5)
    impossible = program(np.zeros((1, 0)), 2, 0.0, row_lower=1, upper=1)
    assert solve_program(impossible).status == "infeasible"


@every
@pytest.mark.parametrize("cost", [1e20, -1e30, 1e308])
def test_a_cost_that_solvers_take_for_infinite_is_refused_by_its_variable(
    solver: str, cost: float
) -> None:
    with pytest.raises(UnsupportedError, match=r"cost .* of 'x\[1\]'"):
        solve_program(program([[1, 1]], 1, [1, cost], upper=3), solver=solver)
