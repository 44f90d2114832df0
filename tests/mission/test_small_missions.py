"""The answers that the small missions state are right, by trying out every plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise, permutations, product
from pathlib import Path

import pytest

from msmrta_opt.mission.grid import Cell, GridMap, manhattan
from msmrta_opt.mission.instance import Instance

Distances = Callable[[GridMap, Cell], dict[Cell, int]]

INSTANCES = Path(__file__).parents[2] / "instances"

# mission: (available requirements, least total time, least makespan), by hand
ANSWERS = {
    "corridor": (2, 9, 9),
    "two_rooms": (3, 13, 9),
    "walled_in": (1, 6, 6),
    "split": (2, 13, 8),
    "scouted": (1, 5, 5),
    "sum_or_max": (2, 5, 4),
    "no_victims": (0, 0, 0),
}
NEVER_FOUND = {"scouted": {1}}


def who_can(
    instance: Instance, hidden: set[int], distances: Distances
) -> dict[tuple[int, str], list[int]]:
    """The robots that can serve each available requirement, all by position."""
    reached = [distances(instance.map, start) for start in instance.starts]
    able = {
        (v, kind): [
            r
            for r, robot in enumerate(instance.robots)
            if kind in robot.capabilities and victim.cell in reached[r]
        ]
        for v, victim in enumerate(instance.victims)
        for kind in victim.requirements
        if victim.id not in hidden
    }
    return {need: robots for need, robots in able.items() if robots}


def finishing_times(
    instance: Instance, able: dict[tuple[int, str], list[int]], distances: Distances
) -> Iterator[tuple[float, ...]]:
    """When each robot is done, for every way to share out the requirements, in its best order."""

    def done(r: int, share: list[tuple[int, str]]) -> float:
        walks = []
        for order in permutations({v for v, _ in share}):
            stops = [instance.starts[r], *(instance.cells[v] for v in order)]
            walks.append(sum(distances(instance.map, a)[b] for a, b in pairwise(stops)))
        victims = instance.victims
        service = sum(
            victims[v].service_time.get(kind, instance.service_time[kind]) for v, kind in share
        )
        return min(walks) / instance.robots[r].speed + service

    for choice in product(*able.values()):
        chosen = list(zip(able, choice, strict=True))
        yield tuple(
            done(r, [need for need, robot in chosen if robot == r])
            for r in range(instance.n_robots)
        )


def test_every_mission_that_states_a_solution_is_tried_here() -> None:
    missions = [Instance.read(path) for path in INSTANCES.glob("*.json")]
    assert {m.name for m in missions if "Least total time" in m.description} == set(ANSWERS)


@pytest.mark.parametrize("name", ANSWERS)
def test_the_stated_solution_is_that_of_trying_out_every_plan(
    name: str, breadth_first: Distances
) -> None:
    instance = Instance.read(INSTANCES / f"{name}.json")
    available, total_time, makespan = ANSWERS[name]
    able = who_can(instance, NEVER_FOUND.get(name, set()), breadth_first)
    assert len(able) == available
    times = list(finishing_times(instance, able, breadth_first))
    assert min(sum(each) for each in times) == total_time
    assert min(max(each) for each in times) == makespan


@pytest.mark.parametrize("name", ANSWERS)
def test_the_description_and_the_readme_state_the_solution(name: str) -> None:
    instance = Instance.read(INSTANCES / f"{name}.json")
    _, total_time, makespan = ANSWERS[name]
    stated = f"Least total time {total_time}, least makespan {makespan}."
    assert instance.name == name
    assert stated in instance.description
    readme = (INSTANCES / "README.md").read_text(encoding="utf-8")
    (row,) = [line for line in readme.splitlines() if line.startswith(f"| `{name}.json` |")]
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[1:3] == [str(instance.n_robots), str(instance.n_victims)]
    assert cells[-2:] == [str(total_time), str(makespan)]


def test_a_wall_lengthens_the_walk_to_one_victim_of_the_two_rooms(
    instances_dir: Path, breadth_first: Distances
) -> None:
    instance = Instance.read(instances_dir / "two_rooms.json")
    centre = (1, 1)
    rows, cols = zip(*instance.cells, strict=True)
    assert (sum(rows) / 3, sum(cols) / 3) == centre
    walks = breadth_first(instance.map, centre)
    assert [walks[cell] for cell in instance.cells] == [2, 2, 8]
    assert [manhattan(centre, cell) for cell in instance.cells] == [2, 2, 2]


def test_the_scouted_room_holds_one_victim_and_not_the_other(
    instances_dir: Path, breadth_first: Distances
) -> None:
    instance = Instance.read(instances_dir / "scouted.json")
    (scout,) = instance.scouts
    ground = breadth_first(instance.map, scout.start)
    assert [cell in ground for cell in instance.cells] == [True, False]
    assert all(instance.map.is_free(cell) for cell in instance.cells)
