"""Every installed solver keeps the same contract, on programs whose solution is known by hand.

The free ones must be installed. Of the commercial ones those that are not are named by one test that is
skipped, and nowhere else.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.amounts import examples
from support.programs import INF, assert_solved_right, best_value, program

from msmrta_opt.mission.errors import InputError, SolverError
from msmrta_opt.optimise.check import dual_bound
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options, Outcome, Solver, apart, get, solvers
from msmrta_opt.optimise.solvers.cpsat import scaled
from msmrta_opt.optimise.solvers.highs import new_highs

FREE = ("highs", "scip", "cpsat", "glpk")
COMMERCIAL = ("gurobi", "cplex", "xpress", "copt", "mosek")
OPTIONS = {
    "time_limit": 10.0,
    "gap": 0.1,
    "seed": 1,
    "threads": 2,
    "start": np.zeros(2),
    "verbose": True,
}


INSTALLED = [name for name in (*FREE, *COMMERCIAL) if get(name).installed]


def able(*abilities: str) -> pytest.MarkDecorator:
    """The test is run for each installed solver that declares these abilities."""
    names = [name for name in INSTALLED if get(name).abilities.issuperset(abilities)]
    return pytest.mark.parametrize("solver", [get(name) for name in names], ids=names)


every_solver = able()


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


def solve(solver: Solver, asked: Program, **options: object) -> Solution:
    return solve_program(asked, solver=solver.name, options=Options(**options))  # type: ignore[arg-type]


def refusal(solver: Solver, asked: Program) -> str:
    """What the solver says to a program of a kind that it does not solve; empty if it does."""
    if not asked.integer.all() and "lp" not in solver.abilities:
        return f"solver {solver.name} cannot do continuous variables"
    infinite = not (np.isfinite(asked.lower).all() and np.isfinite(asked.upper).all())
    if infinite and solver.name == "cpsat":
        return "solver cpsat cannot do infinite bounds"
    return ""


# ------------------------------------------------------------------------- answers known by hand


@every_solver
@dataclass(frozen=True)
class Case:
    asked: Program
    best: float | Literal["infeasible", "unbounded"]


KNOWN = {
    # x = y + 1 and z = 4 - 2y, so the cost is 13 - 3y, least at y = 2.
    "equality rows": Case(
        program([[1, 1, 1], [1, -1, 0]], [5, 1], [1, 2, 3], row_lower=[5, 1], upper=10), 7
    ),
    # 2x + 2y is even, so at most 6 of the 7.
    "a ranged row": Case(program([[2, 2]], 7, [1, 1], row_lower=3, upper=10, sense="max"), 3),
    # x is cheapest all the way down; then y may go to -1.
    "negative lower bounds": Case(
        program([[1, 2]], INF, [1, 1], row_lower=-7, lower=[-5, -3], upper=[5, 3]), -6
    ),
    # The relaxation's vertex is (3, 1.5), worth 21; (4, 0) is worth 20.
    "general integers": Case(program([[6, 4], [1, 2]], [24, 6], [5, 4], upper=10, sense="max"), 20),
    "a maximum with an offset": Case(
        program([[1, 1]], 4, [3, 2], upper=3, sense="max", offset=10), 21
    ),
    "a minimum with an offset": Case(
        program([[1, 1]], INF, [3, 2], row_lower=1, offset=-2.5), -0.5
    ),
    "a row without entries that holds": Case(
        program([[0, 0], [1, 1]], [1, 3], [1, -1], row_lower=[0, -INF], upper=5), -3
    ),
    "a row without entries that cannot hold": Case(
        program([[0, 0], [1, 1]], [2, 3], [1, -1], row_lower=[1, -INF], upper=5), "infeasible"
    ),
    "a row with no sides": Case(program([[1, 1]], INF, [1, -1], upper=5), -5),
    "no rows": Case(program(np.zeros((0, 2)), [], [1, -1], upper=5), -5),
    "no cost": Case(program([[1, 1]], 1, [0, 0], row_lower=1), 0),
    "a fixed column": Case(program([[1, 1]], 4, [1, -1], lower=[2, 0], upper=[2, 5]), 0),
    "all columns fixed": Case(program([[1, 1]], 7, [1, -1], lower=[2, 5], upper=[2, 5]), -3),
    "fractional bounds on integers": Case(
        program([[1, 1]], 9, [1, 2], lower=[0.5, -0.5], upper=[2.5, 3.5], sense="max"), 8
    ),
    "no integer between the bounds": Case(
        program([[1, 1]], 9, [1, 2], lower=[0.2, 0], upper=[0.8, 1]), "infeasible"
    ),
    "rows that contradict the bounds": Case(
        program([[1, 1]], INF, [1, 1], row_lower=5, upper=2), "infeasible"
    ),
    # The relaxation has points; twice a whole number is not 3.
    "infeasible for integers only": Case(
        program([[2, 2]], 3, [1, 1], row_lower=3, upper=10), "infeasible"
    ),
    "unbounded": Case(program([[1, -1]], 3, [-2, 1], upper=INF), "unbounded"),
    "unbounded without rows": Case(
        program(np.zeros((0, 1)), [], [1], upper=INF, sense="max"), "unbounded"
    ),
    # In floats 0.1 + 0.2 is more than 0.3.
    "tenths": Case(program([[0.1, 0.2]], 0.3, [0.1, 0.2], sense="max"), 0.3),
    "thirds": Case(program([[1 / 3, 1 / 3, 1 / 3]], 1, [1 / 3, 1, 1], row_lower=1, upper=3), 1),
    # Whole multiples of sqrt(2) and pi add up to sqrt(2) + pi in one way only.
    "irrational numbers": Case(
        program([[2**0.5, np.pi]], 2**0.5 + np.pi, [1, 1], row_lower=2**0.5 + np.pi, upper=9),
        2,
    ),
    "costs of very different size": Case(program([[1, 1]], INF, [1e6, 1e-2], row_lower=1), 1e-2),
    "small costs": Case(program([[1, 1]], 1, [1e-4, 2e-4], sense="max"), 2e-4),
    # Vertex where both rows are tight: x = y = 2/3.
    "a continuous minimum": Case(
        program([[2, 1], [1, 2]], INF, [1, 1], row_lower=2, upper=INF, integer=False), 4 / 3
    ),
    "a continuous maximum with an offset": Case(
        program([[2, 1], [1, 2]], 2, [1, 1], upper=INF, integer=False, sense="max", offset=-1),
        1 / 3,
    ),
    "a free continuous column": Case(
        program([[1]], INF, [1], row_lower=-7, lower=-INF, upper=INF, integer=False), -7
    ),
    "continuous and infeasible": Case(
        program(
            [[1, -1], [1, -1]], [3, INF], [1, 1], row_lower=[-INF, 4], integer=False, upper=INF
        ),
        "infeasible",
    ),
    "continuous and unbounded": Case(
        program([[1, -1]], 3, [-2, 1], upper=INF, integer=False), "unbounded"
    ),
    # x = 0 leaves y = 1.75; x = 1 leaves y = 1.
    "integer and continuous": Case(
        program([[2, 1], [1, 2]], [3, 3.5], [1, 1], upper=10, integer=[True, False], sense="max"), 2
    ),
}


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


# ------------------------------------------------------------------------------------- options


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


# ------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("name", sorted(solvers()))
def test_an_option_that_is_not_declared_is_refused_by_name(name: str, option: str) -> None:
    asked = get(name)
    if not asked.installed or option in asked.abilities:
        return
    with pytest.raises(SolverError, match=f"solver {name} cannot do {option}"):
        asked.solve(KNOWN["general integers"].asked, Options(**{option: OPTIONS[option]}))  # type: ignore[arg-type]


def never(program: Program, options: Options) -> Outcome:
    raise AssertionError("a solver that must not be asked was asked")


def record(**changes: object) -> Solver:
    able_to_nothing = Solver(
        name="trial",
        title="",
        package="no-such-package",
        module="numpy",
        install="pip install trial",
        abilities=frozenset(),
        run=never,
    )
    return replace(able_to_nothing, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("option", OPTIONS)
def test_a_solver_that_can_do_nothing_refuses_every_option(option: str) -> None:
    options = Options(**{option: OPTIONS[option]})  # type: ignore[arg-type]
    with pytest.raises(SolverError, match=f"solver trial cannot do {option}"):
        record().solve(KNOWN["general integers"].asked, options)


def test_integer_and_continuous_programs_are_refused_by_name() -> None:
    with pytest.raises(SolverError, match="solver trial cannot do integer programs"):
        record().solve(KNOWN["general integers"].asked, Options())
    with pytest.raises(SolverError, match="solver trial cannot do continuous variables"):
        record(abilities=frozenset(["integer"])).solve(
            KNOWN["integer and continuous"].asked, Options()
        )


@pytest.mark.parametrize("module", ["no_such_module", "no_such_package.module"])
def test_a_solver_that_is_not_installed_says_how_to_install_it(module: str) -> None:
    absent = record(module=module)
    assert not absent.installed
    assert absent.version == ""
    with pytest.raises(SolverError, match="solver trial is not installed; pip install trial"):
        absent.solve(KNOWN["general integers"].asked, Options())


def test_a_solver_without_its_licence_is_not_installed() -> None:
    assert not record(available=lambda: False).installed


def test_an_unknown_solver_is_an_error_that_names_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"no solver 'simplex'; there are auto, highs, scip"):
        get("simplex")


def test_what_highs_prints_when_it_is_made_is_not_shown(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def made() -> object:
        os.write(1, b"Running HiGHS, with its notices")
        raise RuntimeError("a fault of the library")

    monkeypatch.setattr("highspy.Highs", made)
    with pytest.raises(RuntimeError, match="a fault of the library"):
        new_highs()
    os.write(1, b"and then")
    assert capfd.readouterr().out == "and then"


# ------------------------------------------------------------------------------------- registry


def test_records_are_complete() -> None:
    assert set(solvers()) == {*FREE, *COMMERCIAL, "lsa"}
    for name, known in solvers().items():
        assert known.name == name
        assert known.title
        assert known.install.startswith("pip install ")
        assert known.abilities & {"integer", "lp"}


def in_new_process(code: str) -> str:
    path = f"import sys; sys.path[:] = {sys.path!r}\n"
    done = subprocess.run(
        [sys.executable, "-c", path + code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_nothing_is_imported_until_a_solver_is_asked_to_solve() -> None:
    modules = {known.module for known in solvers().values()} - {"scipy"}
    code = (
        "from msmrta_opt.optimise.solvers import solvers\n"
        "_ = [(s.installed, s.package_version) for s in solvers().values()]\n"
        f"print([name for name in {sorted(modules)} if name in sys.modules])\n"
    )
    assert in_new_process(code) == "[]"


def test_solvers_that_bring_the_same_library_work_side_by_side() -> None:
    asked = pickle.dumps(KNOWN["general integers"].asked)
    code = (
        "import pickle\n"
        "from msmrta_opt.optimise.solvers import Options, get\n"
        f"asked = pickle.loads({asked!r})\n"
        "print([round(get(name).solve(asked, Options()).bound) for name in ('cpsat', 'highs')])\n"
    )
    assert in_new_process(code) == "[20, 20]"


def test_the_assignment_algorithm_takes_assignments_and_nothing_else() -> None:
    pairs = program(
        [[1, 1, 0, 0], [0, 0, 1, 1], [1, 0, 1, 0], [0, 1, 0, 1]],
        1,
        [4, 1, 2, 3],
        row_lower=[1, 1, -INF, -INF],
    )
    assert_solved_right(solve(get("lsa"), pairs), 3)
    assert solve(get("lsa"), KNOWN["general integers"].asked).status == "skipped"


# ---------------------------------------------------------------- the process of their own


def test_a_solver_whose_process_dies_is_an_error_and_the_next_request_is_served() -> None:
    with pytest.raises(SolverError, match="process ended with exit status 3"):
        apart.run_apart(exec, "import os; os._exit(3)", {})  # type: ignore[arg-type]
    assert_solved_right(solve(get("glpk"), KNOWN["general integers"].asked), 20)


def test_an_exception_in_the_process_is_an_error_that_says_what_it_was() -> None:
    with pytest.raises(SolverError, match="ZeroDivisionError: division by zero"):
        apart.run_apart(exec, "1 / 0", {})  # type: ignore[arg-type]


# ------------------------------------------------------------------------- integers for CP-SAT


def test_coefficients_of_what_can_only_be_zero_are_no_integers_beyond_all_limits() -> None:
    form = scaled(np.array([1e10, 1.5, -1e300]), np.array([0.0, 3.0, 0.0]))
    assert (form.weights.tolist(), form.scale, form.error) == ([0, 3, 0], 2.0, 0.0)


def test_fractions_are_multiplied_by_their_least_common_denominator() -> None:
    form = scaled(np.array([0.5, 1 / 3, -2.0]), np.array([1.0, 5.0, 7.0]))
    assert form.weights.tolist() == [3, 2, -12]
    assert (form.scale, form.exact, form.error) == (6.0, True, 0.0)


def test_other_numbers_keep_all_the_digits_there_is_room_for() -> None:
    coefficients, magnitudes = np.array([np.pi, -np.e]), np.array([3.0, 2.0])
    form = scaled(coefficients, magnitudes)
    missed = np.abs(form.weights / form.scale - coefficients) @ magnitudes
    assert missed <= form.error / form.scale <= 1e-12
    assert np.abs(form.weights) @ magnitudes <= 2**50


def test_numbers_that_leave_no_room_for_digits_are_refused() -> None:
    with pytest.raises(SolverError, match="solver cpsat cannot do coefficients"):
        scaled(np.array([np.pi, np.e]), np.array([1e10, 1e10]))


def test_an_infinite_bound_is_refused_with_the_name_of_the_variable() -> None:
    asked = program([[1, 1]], 1, [1, 1], upper=[1, INF])
    with pytest.raises(SolverError, match=r"cannot do infinite bounds, as x\[1\] has"):
        solve(get("cpsat"), asked)


def test_large_numbers_do_not_cost_the_optimum() -> None:
    """A presolve of ortools 9.15 loses the best point of this one, and calls another optimal."""
    matrix = [
        [1324989402, 0, -537261898, 6401166215, -12234420871, 0, 4965185874],
        [0, -4101105763, 0, 0, -453310280, -6483919878, 7492103328],
        [2876602606, -4133840674, -832421452, 3972271378, -4170742880, 0, 0],
        [0, -23713569068, 0, 0, 2104542873, 0, 0],
        [0, -5852423171, -1854480878, 0, 0, -280574497, 9156118271],
        [7028864364, 0, 5141158207, -11169594080, 0, -2312306775, 3375623764],
        [-6996375136, 0, -5590791159, 3904011609, 0, 0, 0],
        [0, 6050665330, -8170263202, 0, 5714459091, 0, 0],
        [0, -8896741971, 0, -24816072050, 0, 0, 0],
    ]
    asked = program(
        matrix,
        [4960896142, INF, INF, 2104542944, 17470513094, -7214537082, 6996375181, 14304393738, INF],
        [-5961491148, 3314703860, -2825359925, -4412796714, -4761885228, 3609044337, 105863448],
        row_lower=[-12218973191, -INF, -INF, -INF, -INF, -INF, -INF, -2875475557, -INF],
        lower=[-3, -1, -2, 0, -1, 0, 0],
        upper=[0, 2, 0, 2, 3, 3, 2],
    )
    solution = solve(get("cpsat"), asked)
    assert solution.status == "optimal"
    assert solution.objective == best_value(asked)


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
