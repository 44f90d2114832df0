"""Random missions, each by one of all combinations of the options that matter.

Quick tests plan one mission for each combination, slow ones over a thousand in all.
"""

from __future__ import annotations

import itertools
import random
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest
from support.amounts import sample

from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.instance import Instance, Robot, Scout, Victim
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import planners
from msmrta_opt.stages.situation import Situation

Someone = TypeVar("Someone", Robot, Victim)

MAPS = [
    read_map(Path(__file__).parents[2] / "instances" / "maps" / f"map{i}.map") for i in range(4)
]
COMBINATIONS: list[dict[str, Any]] = [
    dict(
        zip(("preset", "cluster_model", "victim_model", "award", "through_centre"), c, strict=True)
    )
    | {"scouts": scouts}
    for *c, scouts in itertools.product(
        ("paper", "authors"),
        ("cluster_printed", "cluster_one_to_one", "cluster_budgeted"),
        ("victim_printed", "victim_one_to_one", "victim_covering", "victim_balanced"),
        ("sealed", "sequential"),
        (True, False),
        (True, False),
    )
]
MISSIONS_EACH = 6
NUMBERS = range(MISSIONS_EACH * len(COMBINATIONS))


def combination(number: int) -> dict[str, Any]:
    return COMBINATIONS[number % len(COMBINATIONS)]


def mission(number: int) -> Instance:
    """The mission of that number.

    Kinds may be had by nobody, victims may be walled in, need nothing, or take their own time;
    clusters may be pinned; ids differ from positions.
    """
    chance = random.Random(number)
    lap, place = divmod(number, len(COMBINATIONS))
    grid = MAPS[(lap + place) % len(MAPS)]
    if chance.random() < 0.4:
        grid = with_more_walls(grid, chance)
    crowded = chance.random() < 0.1
    maximum = 100 if crowded else 20
    if combination(number)["victim_model"] == "victim_balanced":
        maximum = 12  # branch and bound takes long on more, and this is not about time
    base = generate_mission(
        grid,
        chance.randint(2, 10),
        chance.randint(1, maximum),
        seed=number,
        per_robot=(0, 3),
        per_victim=(0, 4),
        solvable=False,
    )
    return base.replace(
        robots=renumbered(base.robots, chance),
        victims=tuple(
            victim.model_copy(update={"service_time": own_times(victim, chance)})
            for victim in renumbered(base.victims, chance)
        ),
        clusters=pins(base.n_victims, chance),
        scouts=scouts(grid, chance) if combination(number)["scouts"] else (),
    )


def with_more_walls(grid: GridMap, chance: random.Random) -> GridMap:
    """The map with about a fifth of its cells blocked, but for one."""
    cells = np.argwhere(grid.free).tolist()
    free = np.array(grid.free)
    for row, col in cells[1:]:
        free[row, col] = chance.random() > 0.2
    return GridMap(free)


def renumbered(members: Sequence[Someone], chance: random.Random) -> tuple[Someone, ...]:
    ids = chance.sample(range(1000), len(members))
    return tuple(
        member.model_copy(update={"id": i}) for member, i in zip(members, ids, strict=True)
    )


def own_times(victim: Victim, chance: random.Random) -> dict[str, float]:
    return {
        kind: chance.choice([0.0, 7.5, 60.0])
        for kind in victim.requirements
        if chance.random() < 0.2
    }


def pins(n_victims: int, chance: random.Random) -> tuple[int, ...] | None:
    if chance.random() < 0.7:
        return None
    return tuple(chance.choices(range(12), k=n_victims))


def scouts(grid: GridMap, chance: random.Random) -> tuple[Scout, ...]:
    cells = [(int(row), int(col)) for row, col in np.argwhere(grid.free)]
    return tuple(
        Scout(id=i, start=chance.choice(cells), visual_field_depth=chance.randint(0, 4))
        for i in range(chance.randint(1, 3))
    )


def planned(number: int) -> Plan:
    """The plan of that mission by its options, as the planner makes it, yet unchecked."""
    chance = random.Random(-number - 1)
    options = {name: value for name, value in combination(number).items() if name != "scouts"}
    return planners()["msmrta"].run(
        mission(number), psi=chance.random(), beta=chance.random(), seed=number, **options
    )


@pytest.mark.parametrize("number", sample(NUMBERS, len(COMBINATIONS)))
def test_every_plan_passes_its_check_and_serves_all_that_is_available(number: int) -> None:
    made = planned(number)
    assert problems(made) == []
    assert made.metrics.served_share == 1
    for route in made.routes:
        stages = [visit.stage for visit in route.visits]
        assert stages == sorted(stages)  # B2, B3, B4
        assert all(visit.served for visit in route.visits)
    assert all(c.status == "optimal" and c.gap == 0 for c in made.certificates)


@pytest.mark.parametrize("number", sample(NUMBERS[::37], 10))
def test_the_same_mission_options_and_seed_give_the_same_plan(number: int) -> None:
    assert planned(number).same_as(planned(number))


def test_the_missions_are_as_hard_as_they_are_meant_to_be() -> None:
    # Counted over every fourth mission, without planning it.
    seen: Counter[str] = Counter()
    for instance in map(mission, NUMBERS[::4]):
        situation = Situation.of(instance)
        had = instance.P.any(axis=0)
        seen["a kind that nobody has"] += bool((instance.Q & ~had).any())
        seen["a victim out of everybody's reach"] += not situation.reach.any(axis=0).all()
        seen["a robot without capabilities"] += not instance.P.any(axis=1).all()
        seen["a victim without requirements"] += not instance.Q.any(axis=1).all()
        seen["more than 50 victims"] += instance.n_victims > 50
        seen["fewer victims than robots"] += instance.n_victims < instance.n_robots
        seen["pinned clusters"] += instance.clusters is not None
        seen["scouts"] += bool(instance.scouts)
    assert len(seen) == 8
    assert min(seen.values()) >= 5, seen
