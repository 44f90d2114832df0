"""Branch and cut against brute force, however it is stopped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.amounts import sample
from support.joint_cases import any_routes, on_a_line, small_mission
from support.joint_oracle import minimum
from support.searches import Told, closed_in

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.check import dual_bound
from msmrta_opt.routing.bound import Bound
from msmrta_opt.routing.branch_and_cut import highs_tree, scip_tree, tree
from msmrta_opt.routing.branch_and_cut.cutting_plane import Relaxation
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation
from msmrta_opt.routing.branch_and_cut.points import point_of, routes_of
from msmrta_opt.routing.branch_and_cut.root import Root
from msmrta_opt.routing.branch_and_cut.root_proof import RootRelaxation
from msmrta_opt.routing.branch_and_cut.search import branch_and_cut
from msmrta_opt.routing.branch_and_cut.subproblem import Subproblem
from msmrta_opt.routing.branch_and_cut.tree import search_tree
from msmrta_opt.routing.callbacks import Callbacks, SearchState
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objectives import OBJECTIVES, value
from msmrta_opt.routing.parameters import Parameters
from msmrta_opt.routing.problem import Routes, RoutingData, faults
from msmrta_opt.routing.stop import (
    Interruption,
    MaximumRuntime,
    RelativeGap,
    StoppingCriterion,
    relative_gap,
)

BOTH = ("total_time", "makespan")
TREES = {"SCIP": True, "HiGHS": False}


def holds(data: RoutingData, objective: str, routes: Routes, bound: Bound) -> None:
    """What must be true whenever it stops."""
    assert faults(data, routes) == []
    assert bound.value <= value(data, routes, objective) + 1e-9
    if bound.root is not None:
        assert isinstance(bound.root, RootRelaxation)
        assert bound.root.bound() == dual_bound(bound.root.program, bound.root.dual_values)
        unit = OBJECTIVES[objective].unit_of(bound.root.formulation.data)
        assert bound.root.bound() * unit <= bound.value + bound.step + 1e-6


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", sample(range(8), 3))
def test_solutions_and_bounds_equal_brute_force(seed: int, objective: str) -> None:
    data = small_mission(seed, 3, 6, map_number=(0, 2, 3)[seed % 3])
    routes, bound = closed_in(data, objective, any_routes(data))
    optimum = minimum(data, objective)
    assert value(data, routes, objective) == pytest.approx(optimum)
    assert bound.value == pytest.approx(optimum)
    holds(data, objective, routes, bound)


@pytest.mark.parametrize("has_scip", TREES.values(), ids=TREES)
@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", sample(range(4), 2))
def test_either_tree_alone_proves_the_optimum(
    seed: int, objective: str, has_scip: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tree, "has_scip", lambda: has_scip)
    data = small_mission(seed, 2, 6)
    optimum = minimum(data, objective)
    maximum = value(data, any_routes(data), objective)
    formulation = EdgeFormulation.of(data, objective, maximum)
    found: list[Routes] = []
    outcome = search_tree(
        Subproblem(formulation, np.zeros(formulation.n_columns), formulation.upper, maximum),
        improved=found.append,
    )
    assert outcome.complete
    assert outcome.bound == pytest.approx(optimum)
    worth = [value(data, routes, objective) for routes in found if not faults(data, routes)]
    assert min([maximum, *worth]) == pytest.approx(optimum)


@pytest.mark.parametrize("has_scip", TREES.values(), ids=TREES)
def test_a_tree_that_is_asked_for_better_than_the_optimum_says_there_is_nothing(
    has_scip: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tree, "has_scip", lambda: has_scip)
    data = small_mission(1, 2, 6)
    optimum = minimum(data, "total_time")
    formulation = EdgeFormulation.of(data, "total_time", optimum)
    found: list[Routes] = []
    outcome = search_tree(
        Subproblem(formulation, np.zeros(formulation.n_columns), formulation.upper, optimum),
        improved=found.append,
    )
    assert outcome.complete
    assert outcome.bound == pytest.approx(optimum)
    assert all(value(data, r, "total_time") >= optimum - 1e-9 for r in found if not faults(data, r))


@pytest.mark.parametrize("objective", BOTH)
def test_without_scip_the_method_proves_the_same(
    objective: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tree, "has_scip", lambda: False)
    data = small_mission(5, 3, 6)
    routes, bound = closed_in(data, objective, any_routes(data))
    assert bound.value == pytest.approx(minimum(data, objective))
    holds(data, objective, routes, bound)


@pytest.mark.parametrize("failing", [("SCIP",), ("SCIP", "HiGHS")], ids="+".join)
def test_a_solver_that_fails_loses_neither_the_routes_nor_the_bound_there_are(
    failing: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other solver goes on if there is one, and the search says who failed."""
    data = small_mission(1, 2, 6)
    monkeypatch.setattr(tree, "has_scip", lambda: True)

    def fail(*_: object, **__: object) -> None:
        raise Exception("SCIP: error in input data!")

    monkeypatch.setattr(scip_tree, "_add_variables", fail)
    if "HiGHS" in failing:
        monkeypatch.setattr(highs_tree, "_model", fail)
    formulation = EdgeFormulation.of(data, "total_time", 1000.0)
    relaxed = Relaxation(formulation).solve()
    seen: list[str] = []

    class Phases(Callbacks):
        def phase_began(self, state: SearchState, phase: str) -> None:
            seen.append(phase)

    progress = Progress(data, "total_time", any_routes(data), callbacks=Phases())
    root = Root(
        progress, formulation, relaxed, np.ones(formulation.n_columns, dtype=bool), 0, Parameters()
    )
    before = progress.value
    outcome = root.search(formulation.upper, stop=StoppingCriterion())
    assert seen == [f"{solver} failed: error in input data!" for solver in failing]
    assert outcome.complete == ("HiGHS" not in failing)
    if outcome.complete:
        assert progress.value == pytest.approx(minimum(data, "total_time"))
        assert outcome.bound == pytest.approx(progress.value)
    else:
        assert (progress.value, outcome.bound) == (before, -np.inf)


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", sample(range(3), 2))
def test_robots_that_return_equal_brute_force(seed: int, objective: str) -> None:
    data = small_mission(seed, 2, 6, return_to_start=True)
    _, bound = closed_in(data, objective, any_routes(data))
    assert bound.value == pytest.approx(minimum(data, objective))


@pytest.mark.parametrize("objective", BOTH)
def test_limits_that_bite_equal_brute_force(objective: str) -> None:
    # Two robots at 0 with a limit of 12; alone, either would walk 10 and serve for 4.
    able = [[[True, True], [True, True]]] * 2
    data = on_a_line([0, 0], [4, 10], able, service=1.0)
    split: Routes = (((0, (0, 1)),), ((1, (0, 1)),))
    for limited in (
        replace(data, endurance=np.full(2, 13.0)),
        replace(data, longest_walk=np.array([5.0, 11.0])),
        replace(data, endurance=np.array([13.0, 6.0]), longest_walk=np.array([10.0, 5.0])),
    ):
        start = split if not faults(limited, split) else split[::-1]
        routes, bound = closed_in(limited, objective, start)
        assert bound.value == pytest.approx(minimum(limited, objective))
        holds(limited, objective, routes, bound)


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", sample(range(3), 2))
def test_a_stop_at_any_moment_leaves_a_plan_and_a_bound_that_holds(
    seed: int, objective: str
) -> None:
    data = small_mission(seed, 3, 6)
    optimum = minimum(data, objective)
    for asked in (0, 1, 2, 3, 5, 8, 20, 60):
        left = iter(range(asked))
        routes, bound = closed_in(
            data,
            objective,
            any_routes(data),
            Interruption(lambda left=left: next(left, None) is None),
        )
        holds(data, objective, routes, bound)
        assert bound.value <= optimum + 1e-9 <= value(data, routes, objective) + 2e-9
    for seconds in (0.0, 0.02, 0.1):
        routes, bound = closed_in(data, objective, any_routes(data), MaximumRuntime(seconds))
        holds(data, objective, routes, bound)
        assert bound.value <= optimum + 1e-9


def test_reports_only_ever_get_better_and_end_with_the_solution() -> None:
    data = small_mission(4, 3, 10)
    told: list[tuple[float, float]] = []
    routes, bound = closed_in(
        data,
        "makespan",
        any_routes(data),
        callbacks=Told(lambda state, _: told.append((state.value, state.bound))),
    )
    values, bounds = zip(*told, strict=True)
    assert list(values) == sorted(values, reverse=True)
    assert list(bounds) == sorted(bounds)
    assert all(lower <= worth for worth, lower in told)
    assert told[-1] == (value(data, routes, "makespan"), bound.value)


def test_it_stops_at_the_gap_that_was_asked_for() -> None:
    data = small_mission(4, 3, 10)
    routes, bound = closed_in(data, "makespan", any_routes(data), RelativeGap(0.9))
    assert relative_gap(value(data, routes, "makespan"), bound.value) <= 0.9


@pytest.mark.parametrize("objective", BOTH)
def test_a_mission_without_anything_to_do_is_solved_at_once(objective: str) -> None:
    data = on_a_line([0, 1], [5], [[[False]], [[False]]])
    routes, bound = closed_in(data, objective, ((), ()))
    assert routes == ((), ())
    assert bound.value == 0.0


@pytest.mark.parametrize("seed", sample(range(20), 6))
def test_the_bound_at_once_is_a_bound(seed: int) -> None:
    data = small_mission(seed, 2, 4)
    for objective in BOTH:
        assert OBJECTIVES[objective].bound(data) <= minimum(data, objective) + 1e-9


def test_routes_that_are_not_feasible_are_refused() -> None:
    data = on_a_line([0], [5], [[[True]]])
    with pytest.raises(InputError, match="incumbent"):
        closed_in(data, "total_time", ((),))


def test_latency_is_refused() -> None:
    data = on_a_line([0], [5], [[[True]]])
    with pytest.raises(InputError, match="latency"):
        branch_and_cut(Progress(data, "latency", any_routes(data)))


@pytest.mark.parametrize("objective", BOTH)
def test_routes_and_points_are_each_other_s_images(objective: str) -> None:
    for seed in range(5):
        data = small_mission(seed, 3, 7)
        routes = any_routes(data)
        formulation = EdgeFormulation.of(data, objective, 1e6)
        x = point_of(formulation, routes)
        program = formulation.program([])
        activity = program.matrix @ x
        assert (activity >= program.row_lower - 1e-9).all()
        assert (activity <= program.row_upper + 1e-9).all()
        assert program.value(x) == pytest.approx(value(data, routes, objective))
        back = routes_of(formulation, x)
        assert back is not None
        assert faults(data, back) == []
        # Visits that the program can do without are left out.
        assert value(data, back, objective) <= value(data, routes, objective) + 1e-9


@pytest.mark.parametrize("what", ["better routes", "branch and cut"])
def test_what_a_report_raises_reaches_the_caller(what: str) -> None:
    data = small_mission(7, 3, 6, map_number=2)

    def refuse(state: SearchState, happened: str) -> None:
        if happened == what:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        closed_in(data, "makespan", any_routes(data), callbacks=Told(refuse))


@pytest.mark.parametrize("objective", BOTH)
def test_where_scip_fails_highs_goes_on(objective: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pyscipopt = pytest.importorskip("pyscipopt")

    class Failing(pyscipopt.Model):  # type: ignore[misc, name-defined]
        def optimize(self) -> None:
            raise Exception("SCIP: error in input data!")

    monkeypatch.setattr("msmrta_opt.routing.branch_and_cut.scip_tree.Model", Failing)
    data = small_mission(1, 2, 6)
    formulation = EdgeFormulation.of(data, objective, value(data, any_routes(data), objective))
    found: list[Routes] = []
    outcome = search_tree(
        Subproblem(formulation, np.zeros(formulation.n_columns), formulation.upper, np.inf),
        improved=found.append,
    )
    assert outcome.complete
    assert outcome.bound == pytest.approx(minimum(data, objective))
    assert value(data, found[-1], objective) == pytest.approx(minimum(data, objective))
