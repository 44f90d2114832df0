"""Every installed solver keeps limits, gaps, starts, seeds and threads, or refuses them by name."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from support.programs import INF, assert_solved_right, best_value, program
from support.solver_contract import (
    COMMERCIAL,
    KNOWN,
    able,
    every_solver,
    record,
    refusal,
    solve,
)

from msmrta_opt.mission.errors import SolverError
from msmrta_opt.optimise.check import dual_bound
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solvers import Options, Solver, apart, get, solvers

OPTIONS = {
    "time_limit": 10.0,
    "gap": 0.1,
    "seed": 1,
    "threads": 2,
    "start": np.zeros(2),
    "verbose": True,
}


@cache
def knapsack() -> Program:
    """60 things, 10 limits: branch and bound needs a while, but not long."""
    random = np.random.default_rng(3)
    weight = random.integers(1, 100, (10, 60)).astype(float)
    worth = random.integers(1, 100, 60).astype(float)
    return program(weight, weight.sum(axis=1) // 2, worth, sense="max", offset=-1000)


@cache
def knapsack_best() -> float:
    """What two solvers prove, without any limit."""
    best = [solve(get(name), knapsack()).require() for name in ("highs", "scip")]
    assert [solution.status for solution in best] == ["optimal", "optimal"]
    assert best[0].objective is not None
    assert best[0].objective == best[1].objective
    return best[0].objective


def market_split() -> tuple[Program, NDArray[np.float64]]:
    """Six subset sums at once over 50 things, and a solution that no search finds soon.

    Instances of this kind are hard far below this size: Cornuéjols and Dawande (1999).
    """
    random = np.random.default_rng(0)
    weight = random.integers(0, 100, (6, 50)).astype(float)
    planted = random.integers(0, 2, 50).astype(float)
    sums = weight @ planted
    return program(weight, sums, np.zeros(50), row_lower=sums), planted


@every_solver
@pytest.mark.parametrize("name", KNOWN)
def test_no_time_gives_no_solution_that_is_not_one(solver: Solver, name: str) -> None:
    case = KNOWN[name]
    if refusal(solver, case.asked):
        return
    solution = solve(solver, case.asked, time_limit=0.0)
    if isinstance(case.best, str):
        assert solution.status in (case.best, "feasible", "no_solution")
        assert solution.found == (solution.status == "feasible")
        assert not (case.best == "infeasible" and solution.found)
        return
    assert solution.status in ("optimal", "feasible", "no_solution"), solution
    assert solution.found == (solution.status != "no_solution")
    assert_bracketed(solution, case.asked, case.best)


def assert_bracketed(solution: Solution, asked: Program, best: float) -> None:
    """The best value is no better than the bound, and the objective no better than the best."""
    slack = 1e-6 * max(1.0, abs(best))
    if solution.bound is not None:
        assert asked.sign * (best - solution.bound) >= -slack
    if solution.objective is not None:
        assert asked.sign * (solution.objective - best) >= -slack
    if solution.status == "optimal":
        assert solution.objective is not None
        assert abs(solution.objective - best) <= slack


@every_solver
@pytest.mark.parametrize("seconds", [1e-5, 0.002, 0.02, 0.1])
def test_a_solver_that_is_stopped_tells_the_truth(solver: Solver, seconds: float) -> None:
    solution = solve(solver, knapsack(), time_limit=seconds)
    assert solution.status in ("optimal", "feasible", "no_solution")
    assert solution.found == (solution.status != "no_solution")
    assert_bracketed(solution, knapsack(), knapsack_best())


@every_solver
def test_a_stopped_solver_has_no_point_where_none_was_found(solver: Solver) -> None:
    asked, _ = market_split()
    solution = solve(solver, asked, time_limit=0.3)
    assert solution.status == "no_solution"
    assert solution.objective is None
    assert solution.values == {}


@every_solver
@pytest.mark.parametrize("gap", [0.02, 0.3])
def test_a_gap_is_kept_and_not_called_optimal(solver: Solver, gap: float) -> None:
    solution = solve(solver, knapsack(), gap=gap)
    assert_bracketed(solution, knapsack(), knapsack_best())
    assert solution.objective is not None
    assert solution.bound is not None
    constant = knapsack().offset  # solvers measure the gap without it
    difference = abs(solution.objective - solution.bound)
    assert difference <= gap * abs(solution.objective - constant) + 1e-6
    assert solution.status == ("optimal" if difference <= 1e-6 else "feasible")
    # The relaxation is some 3 % off, so that a solver has to go on for more than this.
    assert gap < 0.1 or solution.status == "feasible"


@every_solver
@pytest.mark.parametrize("number", range(5))
def test_nothing_short_of_the_optimum_is_accepted_by_default(solver: Solver, number: int) -> None:
    # All 924 choices of 6 out of 12 are worth 6 000 000 to within one in ten thousand.
    random = np.random.default_rng(number)
    worth = 1e6 + random.permutation(12) + random.integers(0, 9, 12) / 2
    weight = random.integers(1, 30, (2, 12))
    asked = program(
        np.vstack([np.ones(12), weight]),
        [6, *(weight.sum(axis=1) // 2)],
        worth,
        row_lower=[6, -INF, -INF],
        sense="max",
    )
    best = best_value(asked)
    assert best is not None
    solution = solve(solver, asked)
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(best, abs=0.01)


@able("start")
@pytest.mark.parametrize("unknown", [0, 3])
def test_a_start_is_used(solver: Solver, unknown: int) -> None:
    asked, planted = market_split()
    start = planted.copy()
    start[:unknown] = np.nan
    # Without it the same search finds nothing: see the test of the stopped solver above.
    assert solve(solver, asked, start=start, time_limit=30.0).status == "optimal"


@able("start")
@pytest.mark.parametrize("start", [[9.0, 9.0], [-4.0, 0.5], [np.nan, np.nan], [0.0, 0.0]])
def test_a_start_that_is_no_solution_does_no_harm(solver: Solver, start: list[float]) -> None:
    case = KNOWN["general integers"]
    assert_solved_right(solve(solver, case.asked, start=np.array(start)), 20)


@able("seed")
@pytest.mark.parametrize("seed", [0, 1, 2**31 - 1])
def test_any_seed_is_accepted_and_gives_the_same_optimum(solver: Solver, seed: int) -> None:
    assert_solved_right(solve(solver, KNOWN["general integers"].asked, seed=seed), 20)


@able("threads")
@pytest.mark.parametrize("threads", [1, 2])
def test_threads_do_not_change_the_optimum(solver: Solver, threads: int) -> None:
    assert_solved_right(solve(solver, KNOWN["general integers"].asked, threads=threads), 20)


@pytest.fixture
def fresh_process() -> Iterator[None]:
    """A child process that writes to the standard error of now."""
    apart.end()
    yield
    apart.end()


@able("verbose")
@pytest.mark.usefixtures("fresh_process")
def test_a_log_is_shown_only_when_asked_for(
    solver: Solver, capfd: pytest.CaptureFixture[str]
) -> None:
    # Without a licence a commercial solver may say so each time.
    asked = KNOWN["general integers"].asked
    solve(solver, asked)
    quiet = sum(len(text) for text in capfd.readouterr())
    assert quiet == 0 or solver.name in COMMERCIAL
    solve(solver, asked, verbose=True)
    assert sum(len(text) for text in capfd.readouterr()) > quiet


@able("duals")
@pytest.mark.parametrize("name", [name for name in KNOWN if name.startswith("a continuous")])
def test_duals_of_a_continuous_program_prove_its_optimum(solver: Solver, name: str) -> None:
    case = KNOWN[name]
    outcome = solver.solve(case.asked, Options())
    assert outcome.duals is not None
    assert dual_bound(case.asked, outcome.duals) == pytest.approx(case.best)


@every_solver
def test_the_same_request_gets_the_same_solution(solver: Solver) -> None:
    asked = program(knapsack().matrix.toarray()[:5, :40], 900, knapsack().cost[:40], sense="max")
    first, second = (solver.solve(asked, Options()) for _ in range(2))
    assert first.x is not None
    assert second.x is not None
    np.testing.assert_array_equal(first.x, second.x)
    assert first.nodes == second.nodes


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("name", sorted(solvers()))
def test_an_option_that_is_not_declared_is_refused_by_name(name: str, option: str) -> None:
    asked = get(name)
    if not asked.installed or option in asked.abilities:
        return
    with pytest.raises(SolverError, match=f"solver {name} cannot do {option}"):
        asked.solve(KNOWN["general integers"].asked, Options(**{option: OPTIONS[option]}))  # type: ignore[arg-type]


@pytest.mark.parametrize("option", OPTIONS)
def test_a_solver_that_can_do_nothing_refuses_every_option(option: str) -> None:
    options = Options(**{option: OPTIONS[option]})  # type: ignore[arg-type]
    with pytest.raises(SolverError, match=f"solver trial cannot do {option}"):
        record().solve(KNOWN["general integers"].asked, options)
