"""Robots whose speeds are worlds apart: solved and right, or refused on reading by robot and speed."""

from __future__ import annotations

import json
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest

import msmrta_opt as mo
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.optimise.solve import solve

SPEEDS = [(1e-9, 1e9), (1e-9, 1e-9), (1.0, 1e-9), (1e9, 1.0), (1e-6, 1e6), (1e-3, 1e9)]


def beside_each_other(slow: float, fast: float) -> Instance:
    """Two robots that can do all, at the ends of a corridor with four victims, two at each end."""
    both = ("A", "B")
    return Instance(
        name="worlds apart",
        map=grid_from_rows(["........"]),
        capabilities=both,
        service_time={"A": 1.0, "B": 1 / 3},
        robots=(
            Robot(id=648, start=(0, 0), speed=slow, capabilities=both),
            Robot(id=363, start=(0, 7), speed=fast, capabilities=both),
        ),
        victims=tuple(
            Victim(id=10 + col, cell=(0, col), requirements=both) for col in (0, 2, 5, 7)
        ),
    )


def victims_of(mission: Instance) -> VictimData:
    """All victims to be assigned, to robots that have done nothing yet."""
    walk = np.abs(np.array([[v.cell[1] for v in mission.victims]]) - [[0], [7]])
    success = walk / mission.speed[:, None] + 4 / 3
    n_robots, n_victims = success.shape
    return VictimData(
        success=success,
        failure=np.zeros_like(success),
        can_serve=np.ones_like(success, dtype=bool),
        busy=np.zeros(n_robots),
        budget=np.full(n_robots, n_victims),
        endurance=np.full(n_robots, np.inf),
    )


@pytest.mark.parametrize("speeds", SPEEDS)
def test_the_busiest_robot_is_least_busy_of_all_assignments(speeds: tuple[float, float]) -> None:
    data = victims_of(beside_each_other(*speeds))
    best = min(
        max(sum(data.extra[r, v] for v, taker in enumerate(takers) if taker == r) for r in range(2))
        for takers in product(range(2), repeat=4)
    )
    solution = solve("victim_balanced", data, beta=0.0)
    assert solution.status in ("optimal", "claimed")
    assert solution.objective == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("speeds", SPEEDS)
def test_the_slowest_of_as_many_pairs_as_can_be_is_as_quick_as_can_be(
    speeds: tuple[float, float],
) -> None:
    data = victims_of(beside_each_other(*speeds))
    best = min(max(data.success[0, v], data.success[1, u]) for v, u in permutations(range(4), 2))
    solution = solve("victim_bottleneck", data, beta=0.0)
    assert solution.status in ("optimal", "claimed")
    assert solution.objective == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("speeds", SPEEDS)
@pytest.mark.parametrize("model", ["victim_balanced", "victim_bottleneck"])
def test_a_staged_plan_is_made_and_holds(model: str, speeds: tuple[float, float]) -> None:
    made = mo.plan(beside_each_other(*speeds), victim_model=model)
    assert problems(made) == []
    assert made.metrics.served_share == 1
    assert all(item.status in ("optimal", "claimed") for item in made.certificates)


@pytest.mark.parametrize("speeds", SPEEDS)
@pytest.mark.parametrize("objective", ["makespan", "total_time"])
def test_the_exact_planner_keeps_a_plan_and_a_bound_below_it(
    objective: str, speeds: tuple[float, float]
) -> None:
    made = mo.plan(beside_each_other(*speeds), planner="exact", objective=objective)
    (certificate,) = made.certificates
    assert problems(made) == []
    assert certificate.bound is not None
    assert certificate.bound <= certificate.objective * (1 + 1e-9)


@pytest.mark.parametrize("speed", [1e-300, 1e-31, 1e31, 1e300])
def test_a_speed_out_of_range_is_refused_by_robot_and_speed(speed: float, tmp_path: Path) -> None:
    document = beside_each_other(1.0, 1.0).document()
    document["robots"][1]["speed"] = speed
    (tmp_path / "mission.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"robots\[1\]\.speed: 1e.\d+; give 1e.30 or "):
        mo.read(tmp_path / "mission.json")
