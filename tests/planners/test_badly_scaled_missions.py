"""Robots whose speeds are worlds apart: solved and right, or refused on reading by robot and speed."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import permutations, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import msmrta_opt as mo
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows, read_map
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.optimise.solve import solve
from msmrta_opt.stages.options import StagedOptions

MAPS = Path(__file__).parents[2] / "instances" / "maps"

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


def least_maximum(data: VictimData, *, pairs: bool) -> float:
    """By all assignments, at β = ½: the greatest load, or time of a pair if there are to be `pairs`."""
    n_robots, n_victims = data.success.shape
    able = [[r for r in range(n_robots) if data.can_serve[r, v]] for v in range(n_victims)]
    able = [[*robots, -1] if pairs or not robots else robots for robots in able]
    found: dict[int, list[float]] = {}
    for takers in product(*able):
        busy = [r for r in takers if r >= 0]
        if pairs and len(set(busy)) < len(busy):
            continue
        loads = np.zeros(n_robots) if pairs else data.busy / 2
        for v, r in enumerate(takers):
            if r >= 0:
                success = data.success[r, v] if pairs else data.success[r, v] - data.busy[r]
                loads[r] += (success + data.failure[r, v]) / 2
        found.setdefault(len(busy), []).append(float(loads.max()))
    return min(found[max(found)])


def robot(number: int, start: tuple[int, int], speed: float, *capabilities: str) -> Robot:
    return Robot(id=number, start=start, speed=speed, capabilities=capabilities)


def scattered(slow: float, fast: float) -> Instance:
    """Seven robots of one kind of help each, two of them fast, and victims on an open map."""
    aid, lift, air = "FirstAids", "DebrisRemover", "OxygenCylinder"
    cells = {
        aid: {6: (2, 15)},
        lift: {3: (1, 6), 4: (11, 19), 7: (9, 16), 13: (3, 5), 15: (7, 11)},
        air: {2: (16, 15), 14: (18, 8), 18: (7, 9)},
        None: {0: (2, 19), 8: (4, 19), 9: (16, 19), 10: (18, 13), 11: (3, 0)}
        | {12: (10, 7), 16: (16, 10), 17: (19, 9)},
    }
    victims = [
        Victim(id=n, cell=cell, requirements=(kind,) if kind else ())
        for kind, own in cells.items()
        for n, cell in own.items()
    ]
    return Instance(
        map=read_map(MAPS / "map0.map"),
        capabilities=(aid, lift, air),
        service_time={aid: 15, lift: 30, air: 20},
        robots=(
            robot(0, (11, 6), fast, lift),
            robot(1, (2, 8), slow, lift),
            robot(3, (15, 18), fast, air),
            robot(4, (0, 18), slow, air),
            robot(5, (3, 16), slow, lift),
            robot(6, (7, 1), slow, aid),
            robot(7, (17, 9), slow, air),
        ),
        victims=tuple(sorted(victims, key=lambda victim: victim.id)),
    )


def among_walls(slow: float, fast: float) -> Instance:
    """Two robots among walls; three of five victims need them both."""
    needs = {
        3: ((3, 14), ("../x",)),
        4: ((4, 0), ("k3", "../x")),
        5: ((13, 3), ("k3", "../x")),
        8: ((1, 17), ("k3", "../x")),
        11: ((17, 11), ("k3", "k4", "../x")),
    }
    return Instance(
        map=read_map(MAPS / "map2.map"),
        capabilities=("k3", "k4", "../x"),
        service_time={"k3": 1, "k4": 1, "../x": 1 / 3},
        robots=(robot(648, (1, 17), slow, "k4", "../x"), robot(363, (13, 3), fast, "k3")),
        victims=tuple(
            Victim(id=n, cell=cell, requirements=kinds) for n, (cell, kinds) in needs.items()
        ),
    )


@pytest.mark.parametrize("speeds", SPEEDS)
@pytest.mark.parametrize(
    ("make", "model", "options"),
    [
        (among_walls, "victim_balanced", {"cluster_model": "cluster_printed"}),
        (
            scattered,
            "victim_bottleneck",
            {"cluster_model": "cluster_fair", "through_centre": False},
        ),
    ],
)
def test_the_last_stage_of_a_plan_has_the_optimum_of_all_assignments(
    make: Callable[[float, float], Instance],
    model: str,
    options: dict[str, Any],
    speeds: tuple[float, float],
) -> None:
    mission = make(*speeds)
    made = mo.plan(mission, victim_model=model, **options)
    assert problems(made) == []
    assert made.metrics.served_share == 1
    data = mo.stage_data(mission, "victim", StagedOptions(victim_model=model, **options))
    certificate = made.certificates[-1]
    assert certificate.status in ("optimal", "claimed")
    best = least_maximum(data, pairs=model == "victim_bottleneck")
    assert certificate.objective == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("speed", [1e-30, 1e-9, 1.0, 1e9, 1e30])
def test_a_speed_within_the_range_is_planned_with(speed: float, tmp_path: Path) -> None:
    """A robot walks 2 cells to the near victim and 5 to the far one, and serves in no time."""
    mission = Instance(
        map=grid_from_rows(["......."] * 2),
        capabilities=("A",),
        service_time={"A": 0},
        robots=(robot(0, (0, 1), speed, "A"),),
        victims=tuple(Victim(id=4 + c, cell=(1, c), requirements=("A",)) for c in (0, 5)),
    )
    (certificate,) = mo.plan(mission, planner="exact", objective="makespan").certificates
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(7 / speed)
    document = mission.document()
    for wrong in (1e-300, 1e300):
        document["robots"][0]["speed"] = wrong
        (tmp_path / "mission.json").write_text(json.dumps(document))
        with pytest.raises(InputError, match=r"robots\[0\]\.speed: 1e.300; give 1e.30 or "):
            mo.read(tmp_path / "mission.json")
