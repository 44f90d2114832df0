"""Missions made to be solvable: counts, cells and shares, worked out again from the mission alone."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.amounts import examples

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import (
    KINDS,
    SERVICE_TIME,
    SPEEDS,
    generate_mission,
    kinds_with_times,
)
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.layouts import maze, rooms, rubble, with_pocket
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.named_maps import find_map

Distances = Callable[[GridMap, Cell], dict[Cell, int]]
SEEDS = st.integers(0, 2**32 - 1)
OPEN = grid_from_rows(["." * 8] * 8)
# 30 connected cells, and 6 that are cut off from them in two parts
TORN = grid_from_rows(["......@..", "......@..", "......@@@", "......@..", "......@@@"])


def cut_off(mission: Instance, distances: Distances) -> int:
    """How many victims no robot can reach, by flood fill."""
    reached: set[Cell] = set()
    for start in mission.starts:
        reached |= set(distances(mission.map, start))
    return sum(cell not in reached for cell in mission.cells)


def without_a_robot(mission: Instance) -> int:
    """How many requirements are of a kind that no robot has."""
    had = {kind for robot in mission.robots for kind in robot.capabilities}
    return sum(kind not in had for victim in mission.victims for kind in victim.requirements)


def n_requirements(mission: Instance) -> int:
    return sum(len(victim.requirements) for victim in mission.victims)


def nearest(percent: int, count: int) -> int:
    """`percent` of `count` in whole numbers alone; halves go up."""
    return (2 * percent * count + 100) // 200


def made_or_refused(*arguments: Any, **options: Any) -> Instance | InputError:
    try:
        return generate_mission(*arguments, **options)
    except InputError as error:
        return error


ranges = st.tuples(st.integers(0, 6), st.integers(0, 6)).map(sorted).map(tuple)


@settings(max_examples=examples(150))
@given(
    seed=SEEDS,
    n_robots=st.integers(1, 8),
    n_victims=st.integers(0, 14),
    kinds=st.integers(1, 8),
    per_robot=ranges,
    per_victim=ranges,
    unreachable=st.sampled_from([0, 10, 25, 33]),
    unmeetable=st.sampled_from([0, 5, 10, 50, 100]),
)
def test_a_mission_is_as_asked_for_or_refused(
    breadth_first: Distances,
    seed: int,
    n_robots: int,
    n_victims: int,
    kinds: int,
    per_robot: tuple[int, int],
    per_victim: tuple[int, int],
    unreachable: int,
    unmeetable: int,
) -> None:
    assume(per_robot[1] <= kinds and per_victim[1] <= kinds)
    mission = made_or_refused(
        TORN,
        n_robots,
        n_victims,
        seed=seed,
        kinds=kinds,
        per_robot=per_robot,
        per_victim=per_victim,
        unreachable=unreachable / 100,
        unmeetable=unmeetable / 100,
    )
    # The map has room for all, so only capabilities can fall short.
    too_few = n_robots * per_robot[1] < kinds
    if isinstance(mission, InputError):
        assert mission.field in ("kinds", "per_robot", "unmeetable")
        assert too_few if mission.field == "kinds" else unmeetable > 0
        return
    assert unmeetable or not too_few
    assert (mission.n_robots, mission.n_victims, mission.n_kinds) == (n_robots, n_victims, kinds)
    assert [robot.id for robot in mission.robots] == list(range(n_robots))
    assert [victim.id for victim in mission.victims] == list(range(n_victims))
    stands = mission.starts + mission.cells
    assert len(set(stands)) == len(stands)
    assert all(TORN.is_free(cell) for cell in stands)
    assert len(set(breadth_first(TORN, (0, 0))) & set(mission.starts)) == n_robots
    for robot in mission.robots:
        assert per_robot[0] <= len(robot.capabilities) <= per_robot[1]
        assert robot.speed in SPEEDS
    for victim in mission.victims:
        assert per_victim[0] <= len(victim.requirements) <= per_victim[1]
        assert victim.priority == 1
    for names in (
        *(robot.capabilities for robot in mission.robots),
        *(victim.requirements for victim in mission.victims),
    ):
        assert list(names) == [kind for kind in mission.capabilities if kind in names]
    n_cut_off = nearest(unreachable, n_victims)
    n_unmet = nearest(unmeetable, n_requirements(mission))
    assert cut_off(mission, breadth_first) == n_cut_off
    assert without_a_robot(mission) == n_unmet
    had = {kind for robot in mission.robots for kind in robot.capabilities}
    if not n_unmet:
        assert had == set(mission.capabilities)
    assert mission.description == (
        f"{n_cut_off} of {n_victims} victims out of reach; {n_unmet} of "
        f"{n_requirements(mission)} requirements of kinds that no robot has."
    )


@settings(max_examples=examples(30))
@given(seed=SEEDS, layout=st.sampled_from(["rooms", "rubble", "maze", "map1", "map3"]))
def test_on_any_map_every_requirement_has_a_capable_robot_that_reaches_the_victim(
    breadth_first: Distances, seed: int, layout: str
) -> None:
    grid = {
        "rooms": lambda: rooms(14, 20, seed=seed),
        "rubble": lambda: rubble(14, 20, seed=seed, density=0.4),
        "maze": lambda: maze(13, 21, seed=seed),
    }.get(layout, lambda: find_map(layout))()
    mission = generate_mission(grid, 3, 12, seed=seed)
    for victim in mission.victims:
        reached = breadth_first(grid, victim.cell)
        for kind in victim.requirements:
            assert any(kind in r.capabilities and r.start in reached for r in mission.robots)


def test_victims_out_of_reach_stand_in_a_pocket_made_for_them(breadth_first: Distances) -> None:
    grid = with_pocket(rooms(20, 20, seed=1), 3, seed=1)
    mission = generate_mission(grid, 4, 20, seed=1, unreachable=0.15, unmeetable=0.1)
    assert cut_off(mission, breadth_first) == 3
    assert without_a_robot(mission) == 4


def test_as_few_kinds_as_will_do_are_without_a_robot() -> None:
    # 10 victims with 2 requirements: 10 of 20 fit in one kind; 11 need two.
    for share, lacking in ((0.5, 1), (0.55, 2), (1.0, 2)):
        mission = generate_mission(OPEN, 6, 10, seed=0, unmeetable=share)
        had = {kind for robot in mission.robots for kind in robot.capabilities}
        assert len(set(KINDS) - had) == lacking


def test_robots_get_more_kinds_where_some_kind_would_be_had_by_none() -> None:
    # Two robots with one to three kinds have all six only if each has three.
    for seed in range(20):
        mission = generate_mission(OPEN, 2, 5, seed=seed)
        first, second = (set(robot.capabilities) for robot in mission.robots)
        assert (len(first), len(second), first | second) == (3, 3, set(KINDS))


def test_priorities_are_whole_numbers_of_the_range_drawn_about_evenly() -> None:
    grid = grid_from_rows(["." * 60] * 60)
    mission = generate_mission(grid, 6, 3000, seed=0, priorities=(2, 4))
    counts = Counter(victim.priority for victim in mission.victims)
    assert set(counts) == {2.0, 3.0, 4.0}
    # Five standard deviations of a binomial count
    assert all(abs(count - 1000) < 5 * 1000**0.5 for count in counts.values())


def test_choices_are_drawn_about_evenly() -> None:
    n = 1500
    grid = grid_from_rows(["." * 60] * 60)
    mission = generate_mission(grid, n, n, seed=0, per_robot=(1, 3))
    drawn: list[tuple[Counter[Any], int]] = [
        (Counter(robot.speed for robot in mission.robots), 3),
        (Counter(len(robot.capabilities) for robot in mission.robots), 3),
        (Counter(kind for robot in mission.robots for kind in robot.capabilities), 6),
        (Counter(kind for victim in mission.victims for kind in victim.requirements), 6),
        (Counter((r // 20, c // 20) for r, c in mission.starts), 9),
        (Counter((r // 20, c // 20) for r, c in mission.cells), 9),
    ]
    for counts, size in drawn:
        assert len(counts) == size
        even = counts.total() / size
        assert all(abs(count - even) < 5 * even**0.5 for count in counts.values())


def test_kinds_are_the_papers_six_and_then_numbered_with_its_times_again() -> None:
    assert kinds_with_times(6) == SERVICE_TIME
    assert list(kinds_with_times(2)) == list(KINDS[:2])
    assert list(kinds_with_times(14).items())[6:] == [
        ("kind7", 15),
        ("kind8", 30),
        ("kind9", 20),
        ("kind10", 10),
        ("kind11", 45),
        ("kind12", 35),
        ("kind13", 15),
        ("kind14", 30),
    ]


def test_a_mission_can_be_saved_and_read(tmp_path: Path) -> None:
    mission = generate_mission(TORN, 3, 4, seed=0, unreachable=0.5, priorities=(1, 9))
    mission.save(tmp_path / "mission.json")
    assert Instance.read(tmp_path / "mission.json") == mission


def test_other_seeds_give_other_missions_and_the_same_seed_the_same() -> None:
    made = [generate_mission(OPEN, 3, 4, seed=seed).replace(name="") for seed in range(10)]
    assert len({json.dumps(mission.document()) for mission in made}) == 10
    assert made[3] == generate_mission(OPEN, 3, 4, seed=3).replace(name="")


def test_the_global_random_state_is_neither_read_nor_changed() -> None:
    np.random.seed(3)  # noqa: NPY002 - it is this old state that must not matter
    first = generate_mission(maze(9, 9, seed=0), 3, 4, seed=0)
    after = np.random.random()  # noqa: NPY002
    np.random.seed(4)  # noqa: NPY002
    assert generate_mission(maze(9, 9, seed=0), 3, 4, seed=0) == first
    np.random.seed(3)  # noqa: NPY002
    assert np.random.random() == after  # noqa: NPY002


def test_random_missions_are_those_that_recorded_figures_were_measured_on() -> None:
    document = generate_mission(find_map("map2"), 6, 30, seed=5, solvable=False).document()
    text = json.dumps(document, sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == (
        "fbdd86e1cd9fc03a0961a9976cfedf20798fd2dd2902c49a3261062d91d45dbe"
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n_robots": 0}, "counts: at least one robot"),
        ({"n_victims": -1}, "counts: "),
        ({"kinds": 0}, "kinds: 0; give 1 to 1000"),
        ({"kinds": 1001}, "kinds: 1001; give 1 to 1000"),
        ({"per_robot": (2, 1)}, r"per_robot: \(2, 1\); give 0 ≤ minimum ≤ maximum ≤ 6"),
        ({"per_victim": (0, 7)}, "per_victim: .* ≤ 6"),
        ({"kinds": 2}, "per_robot: .* ≤ 2"),
        ({"priorities": (3, 1)}, "priorities: "),
        ({"speeds": (0.5, 0.0)}, "speeds: "),
        ({"speeds": ()}, "speeds: "),
        ({"unreachable": 1.1}, "unreachable: 1.1; give a number from 0 to 1"),
        ({"unmeetable": float("nan")}, "unmeetable: nan; give a number from 0 to 1"),
        ({"seed": -1}, "seed: -1; give"),
        # 4 + 61 cells on a map of 64
        ({"n_victims": 61}, "map: 65 robots and victims within reach on 64 connected cells"),
        ({"grid": grid_from_rows(["@@"])}, "map: 14 robots and victims .* 0 connected"),
        ({"unreachable": 0.2}, "unreachable: 2 victims out of reach, but the map has 0 free"),
        ({"kinds": 13}, "kinds: 13 kinds, but at most 3 for each of 4 robots make only 12"),
        # Each victim needs all six kinds, so one that no robot has is lacking ten times.
        (
            {"per_victim": (6, 6), "unmeetable": 0.1},
            "unmeetable: 6 requirements .* 1 such of 6 kinds at least 10 are",
        ),
        ({"per_robot": (1, 6), "unmeetable": 0.1}, "per_robot: up to 6 .* only 5 of 6"),
    ],
)
def test_what_cannot_be_is_refused_saying_what_would_be_right(
    change: dict[str, Any], message: str
) -> None:
    options: dict[str, Any] = {"grid": OPEN, "n_robots": 4, "n_victims": 10, "seed": 0} | change
    with pytest.raises(InputError, match=message):
        generate_mission(options.pop("grid"), **options)
