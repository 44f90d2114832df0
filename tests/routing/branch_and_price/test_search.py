"""The minimum latency: against brute force, at any moment, and within its limits."""

from __future__ import annotations

from dataclasses import replace
from itertools import count, pairwise

import numpy as np
import pytest
from support.amounts import sample
from support.joint_cases import any_routes, on_a_line, small_mission
from support.joint_oracle import minimum
from support.searches import Told, closed_in

from msmrta_opt.mission.errors import InputError
from msmrta_opt.routing.bound import Bound
from msmrta_opt.routing.branch_and_price.search import branch_and_price
from msmrta_opt.routing.callbacks import SearchState
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objective_step import objective_step
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import Routes, RoutingData, faults, times
from msmrta_opt.routing.stop import Interruption, MaximumRuntime, RelativeGap

LONG = 60.0


def assert_proven(data: RoutingData, incumbent: Routes | None = None) -> None:
    """The search ends with what brute force finds, and never claimed more on its way."""
    expected = minimum(data, "latency")
    seen: list[tuple[float, float]] = []

    def report(state: SearchState, what: str) -> None:
        del what
        assert not faults(data, state.routes)
        assert state.value == pytest.approx(value(data, state.routes, "latency"))
        seen.append((state.value, state.bound))

    start = any_routes(data) if incumbent is None else incumbent
    routes, bound = closed_in(data, "latency", start, MaximumRuntime(LONG), Told(report))
    assert not faults(data, routes)
    assert value(data, routes, "latency") == pytest.approx(expected, rel=1e-6)
    assert bound.value == pytest.approx(expected, rel=2e-6)
    assert all(low <= expected * (1 + 1e-6) <= high * (1 + 2e-6) for high, low in seen)
    for before, after in pairwise(seen):
        assert after[0] <= before[0] + 1e-9
        assert after[1] >= before[1] - 1e-9


@pytest.mark.parametrize("seed", sample(range(10), 4))
def test_a_small_mission_is_proven_to_be_worth_what_brute_force_finds(seed: int) -> None:
    """Different speeds, split victims, kinds that nobody has."""
    assert_proven(small_mission(seed, 3, 4, map_number=(0, 2, 3)[seed % 3]))


@pytest.mark.parametrize("seed", sample(range(5), 2))
def test_priorities_weigh_and_may_be_nothing(seed: int) -> None:
    data = small_mission(seed, 3, 4)
    weights = np.random.RandomState(seed).choice([0.0, 0.5, 1.0, 2.5], data.n_victims)
    assert_proven(replace(data, priority=weights))


@pytest.mark.parametrize("seed", sample(range(5), 2))
def test_times_without_a_common_divisor_are_rounded_down_and_still_proven(seed: int) -> None:
    data = small_mission(seed, 3, 4)
    random = np.random.RandomState(seed)
    data = replace(
        data, service=random.rand(*data.service.shape), priority=random.rand(data.n_victims)
    )
    assert objective_step(data, "latency").step == 0
    assert_proven(data)


@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_limits_and_the_way_back_are_kept_to(seed: int) -> None:
    data = small_mission(seed, 3, 4, return_to_start=True)
    incumbent = any_routes(data)
    used = times(data, incumbent)
    limited = replace(data, endurance=used.busy + 1.0, longest_walk=used.travel + 1.0)
    assert_proven(limited, incumbent)


def test_a_limit_makes_the_longer_order_the_best() -> None:
    """At 0, victims at -1 and 4: walking 6 by the near one first, latency 1 + 6; returning takes 10.

    With the way back counted the walk is 10 either way, so what a limit forbids shows on the open
    route: 6 for the near one first, 9 for the far one first.
    """
    data = on_a_line([0.0], [-1.0, 4.0], [[[True], [True]]])
    _, bound = closed_in(data, "latency", any_routes(data))
    assert bound.value == pytest.approx(1 + 6)
    weighted = replace(data, priority=np.array([1.0, 10.0]))
    far_first: Routes = (((1, (0,)), (0, (0,))),)
    routes, bound = closed_in(weighted, "latency", any_routes(weighted))
    assert routes == far_first
    assert bound.value == pytest.approx(4 * 10 + 9)
    limited = replace(weighted, longest_walk=np.array([8.0]))
    routes, bound = closed_in(limited, "latency", any_routes(limited))
    assert value(limited, routes, "latency") == pytest.approx(1 + 60)
    assert bound.value == pytest.approx(1 + 60)


def test_a_split_victim_is_complete_with_the_later_of_its_robots() -> None:
    """Robots at 0 and 10, each with a kind of its own; the victim at 3 is done at 7."""
    data = on_a_line([0.0, 10.0], [3.0], [[[True, False]], [[False, True]]])
    _, bound = closed_in(data, "latency", any_routes(data))
    assert bound.value == pytest.approx(7)


def test_two_robots_that_must_meet_at_two_victims_are_not_averaged() -> None:
    """Both start at 0 and are both needed at -1 and at 1: one victim waits until 3, whoever goes where.

    If they go separate ways first, both victims are complete at 3.
    """
    able = [[[True, False], [True, False]], [[False, True], [False, True]]]
    data = on_a_line([0.0, 0.0], [-1.0, 1.0], able)
    apart: Routes = (((0, (0,)), (1, (0,))), ((1, (1,)), (0, (1,))))
    assert value(data, apart, "latency") == 6
    routes, bound = closed_in(data, "latency", apart)
    assert value(data, routes, "latency") == pytest.approx(4)
    assert bound.value == pytest.approx(4)


def test_it_stops_at_the_gap_that_is_allowed() -> None:
    data = small_mission(0, 4, 12)
    worst = any_routes(data)
    routes, bound = closed_in(data, "latency", worst, RelativeGap(0.2) | MaximumRuntime(LONG))
    worth = value(data, routes, "latency")
    assert bound.value >= 0.8 * worth - 1e-6
    seen: list[str] = []
    closed_in(data, "latency", worst, RelativeGap(1), Told(lambda _, what: seen.append(what)))
    assert seen == ["combinatorial"]


def test_asked_to_stop_it_keeps_what_it_has() -> None:
    data = small_mission(1, 4, 12)
    incumbent = any_routes(data)
    asked: list[int] = []

    def stop() -> bool:
        asked.append(1)
        return len(asked) > 3

    routes, bound = closed_in(data, "latency", incumbent, MaximumRuntime(LONG) | Interruption(stop))
    assert not faults(data, routes)
    assert 0 < bound.value <= value(data, routes, "latency") <= value(data, incumbent, "latency")


def test_without_time_there_is_the_combinatorial_bound() -> None:
    data = small_mission(2, 4, 12)
    incumbent = any_routes(data)
    routes, bound = closed_in(data, "latency", incumbent, MaximumRuntime(0))
    assert routes == incumbent
    assert isinstance(bound, Bound)
    assert bound.proof == "combinatorial"


def test_time_that_runs_out_within_a_network_leaves_the_bound_there_is() -> None:
    """However often the clock was looked at before: networks are built and priced in steps."""
    data = small_mission(1, 4, 12)
    incumbent = any_routes(data)
    at_once = closed_in(data, "latency", incumbent, MaximumRuntime(0))[1].value
    for last in (2, 5, 9, 14, 40, 300):
        looks = count(1)
        progress = Progress(
            data,
            "latency",
            incumbent,
            stop=Interruption(lambda looks=looks, last=last: next(looks) > last),
        )
        bound = branch_and_price(progress)
        assert not faults(data, progress.routes)
        assert at_once - 1e-9 <= bound.value <= progress.value
        # Once it is met nothing goes on for long.
        assert next(looks) < last + 20


def test_places_that_take_no_time_leave_the_combinatorial_bound() -> None:
    """Two victims at one place and no service: nothing orders the visits in time."""
    data = on_a_line([0.0], [2.0, 2.0], [[[True], [True]]])
    _, bound = closed_in(data, "latency", any_routes(data), MaximumRuntime(LONG))
    assert bound.value == pytest.approx(4)


def test_fifty_tasks_in_one_visit_leave_the_combinatorial_bound() -> None:
    """Their sets are too many to look at; one robot does all of them, one after the other."""
    data = on_a_line([0.0, 9.0], [2.0], [[[True] * 50], [[True] * 50]], service=1.0)
    _, bound = closed_in(data, "latency", any_routes(data), MaximumRuntime(1.0))
    assert (bound.proof, bound.root) == ("combinatorial", None)
    assert 0 < bound.value <= 30  # 2 + 28 for one, 7 + 22 for the other


def test_routes_that_are_not_feasible_are_refused() -> None:
    data = small_mission(0)
    with pytest.raises(InputError, match="incumbent"):
        closed_in(data, "latency", ((),) * data.n_robots)


@pytest.mark.parametrize(
    ("priorities", "step"), [([1.0, 1.0], 1.0), ([2.0, 4.0], 2.0), ([0.5, 0.75], 0.25)]
)
def test_latency_comes_in_steps_of_time_and_priority(priorities: list[float], step: float) -> None:
    data = on_a_line([0.0], [2.0, 5.0], [[[True], [True]]])
    assert objective_step(
        replace(data, priority=np.array(priorities)), "latency"
    ).step == pytest.approx(step)
    odd = replace(data, priority=np.array([1.0, np.pi]))
    assert objective_step(odd, "latency").step == 0


def test_a_bound_that_follows_at_once_needs_no_dual_values() -> None:
    """By itself each of two robots takes its own victim, and is done with it at once."""
    data = RoutingData(
        leave=np.array([[3.0, 9.0], [9.0, 4.0]]),
        length=np.full((2, 2, 2), 6.0),
        back=np.zeros((2, 2)),
        service=np.ones((2, 1)),
        able=np.ones((2, 2, 1), dtype=bool),
        priority=np.ones(2),
        endurance=np.full(2, np.inf),
        longest_walk=np.full(2, np.inf),
    )
    _, bound = closed_in(data, "latency", (((0, (0,)),), ((1, (0,)),)))
    assert (bound.value, bound.proof, bound.root) == (9.0, "combinatorial", None)
