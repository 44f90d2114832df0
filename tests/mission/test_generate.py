from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import KINDS, SERVICE_TIME, SPEEDS, generate_mission
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.named_maps import find_map

ROOT = Path(__file__).parents[2]
GROUND = grid_from_rows(["..@.", "@...", "...."])
SEEDS = st.integers(0, 2**32 - 1)

PRINT_A_MISSION = """
import json
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import grid_from_rows
grid = grid_from_rows(["..@.", "@...", "...."])
print(json.dumps(generate_mission(grid, 5, 7, seed=11, solvable=False).document()))
"""

free_mission = partial(generate_mission, solvable=False)


def test_the_same_seed_gives_the_same_mission_in_every_process() -> None:
    here = free_mission(GROUND, 5, 7, seed=11).document()
    for hash_seed in ("1", "2"):
        # Sets of texts are ordered by their hashes, which differ from process to process.
        environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, "-c", PRINT_A_MISSION],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert json.loads(done.stdout) == here


@given(seed=SEEDS)
def test_the_same_seed_gives_the_same_mission(seed: int) -> None:
    assert free_mission(GROUND, 3, 4, seed=seed) == free_mission(GROUND, 3, 4, seed=seed)


def test_a_map_may_be_named_and_an_unknown_name_is_refused() -> None:
    named = generate_mission("map0", 2, 3, seed=4)
    assert named == generate_mission(find_map("map0"), 2, 3, seed=4)
    with pytest.raises(
        InputError, match=r"'map00' is no file and no known map .did you mean 'map0'"
    ):
        generate_mission("map00", 2, 3, seed=4)


def test_other_seeds_give_other_missions() -> None:
    documents = [free_mission(GROUND, 3, 4, seed=seed).document() for seed in range(10)]
    for document in documents:
        del document["name"]
    assert len({json.dumps(document) for document in documents}) == 10


def test_the_global_random_state_is_neither_read_nor_changed() -> None:
    np.random.seed(3)  # noqa: NPY002 - it is this old state that must not matter
    first = free_mission(GROUND, 3, 4, seed=0)
    after = np.random.random()  # noqa: NPY002
    np.random.seed(4)  # noqa: NPY002
    assert free_mission(GROUND, 3, 4, seed=0) == first
    np.random.seed(3)  # noqa: NPY002
    assert np.random.random() == after  # noqa: NPY002


@settings(max_examples=examples(50))
@given(
    seed=SEEDS,
    n_robots=st.integers(1, 12),
    n_victims=st.integers(0, 12),
    per_robot=st.tuples(st.integers(0, 6), st.integers(0, 6)).map(sorted).map(tuple),
    per_victim=st.tuples(st.integers(0, 6), st.integers(0, 6)).map(sorted).map(tuple),
)
def test_a_mission_is_as_asked_for(
    seed: int,
    n_robots: int,
    n_victims: int,
    per_robot: tuple[int, int],
    per_victim: tuple[int, int],
) -> None:
    mission = free_mission(
        GROUND,
        n_robots,
        n_victims,
        seed=seed,
        per_robot=per_robot,
        per_victim=per_victim,
    )
    assert mission.map == GROUND
    assert [robot.id for robot in mission.robots] == list(range(n_robots))
    assert [victim.id for victim in mission.victims] == list(range(n_victims))
    assert all(GROUND.is_free(cell) for cell in (*mission.starts, *mission.cells))
    for robot in mission.robots:
        assert per_robot[0] <= len(robot.capabilities) <= per_robot[1]
        assert robot.speed in SPEEDS
    for victim in mission.victims:
        assert per_victim[0] <= len(victim.requirements) <= per_victim[1]
    for names in (
        *(r.capabilities for r in mission.robots),
        *(v.requirements for v in mission.victims),
    ):
        assert list(names) == [kind for kind in KINDS if kind in names]


def test_a_mission_can_be_saved_and_read(tmp_path: Path) -> None:
    mission = free_mission(GROUND, 3, 4, seed=0)
    mission.save(tmp_path / "mission.json")
    assert Instance.read(tmp_path / "mission.json") == mission


@given(seed=SEEDS)
def test_victims_stand_apart_as_long_as_there_is_room(seed: int) -> None:
    n_free = int(GROUND.free.sum())
    filled = free_mission(GROUND, 1, n_free, seed=seed)
    assert len(set(filled.cells)) == n_free


def test_more_victims_than_free_cells_share_them() -> None:
    assert free_mission(grid_from_rows(["@."]), 3, 5, seed=0).cells == [(0, 1)] * 5


def test_a_mission_has_two_requirements_a_victim_and_one_to_three_capabilities_unless_told() -> (
    None
):
    mission = free_mission(GROUND, 200, 200, seed=0)
    assert {len(victim.requirements) for victim in mission.victims} == {2}
    assert {len(robot.capabilities) for robot in mission.robots} == {1, 2, 3}


def test_every_choice_is_drawn_about_evenly() -> None:
    n = 3000
    mission = free_mission(GROUND, n, n, seed=0, speeds=(1.0, 2.0))
    drawn: list[Counter[Any]] = [
        Counter(robot.speed for robot in mission.robots),
        Counter(len(robot.capabilities) for robot in mission.robots),
        Counter(kind for victim in mission.victims for kind in victim.requirements),
        Counter(mission.starts),
        Counter(mission.cells),
    ]
    sizes = [2, 3, len(KINDS), 10, 10]
    for counts, size in zip(drawn, sizes, strict=True):
        assert len(counts) == size
        even = counts.total() / size
        # Five standard deviations of a binomial count
        assert all(abs(count - even) < 5 * even**0.5 for count in counts.values())


def test_kinds_and_times_are_those_of_the_papers_mission(paper: Instance) -> None:
    assert paper.capabilities == KINDS
    assert paper.service_time == SERVICE_TIME
    assert {robot.speed for robot in paper.robots} == set(SPEEDS)


def test_the_name_tells_map_size_and_seed() -> None:
    assert free_mission(GridMap(GROUND.free, name="hall"), 2, 3, seed=4).name == "hall-2x3-s4"
    assert free_mission(GROUND, 2, 3, seed=4).name == "map-2x3-s4"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"n_robots": 0}, "counts"),
        ({"n_victims": -1}, "counts"),
        ({"per_robot": (2, 1)}, "per_robot"),
        ({"per_robot": (-1, 1)}, "per_robot"),
        ({"per_victim": (0, 7)}, "per_victim"),
        ({"grid": grid_from_rows(["@@"])}, "map"),
        ({"speeds": (0.5, 0.0)}, "speeds"),
        ({"speeds": (float("nan"),)}, "speeds"),
        ({"speeds": ()}, "speeds"),
        ({"seed": -1}, "seed"),
        ({"seed": 2**32}, "seed"),
    ],
)
def test_what_cannot_be_is_refused_naming_the_option(change: dict[str, Any], field: str) -> None:
    options: dict[str, Any] = {"grid": GROUND, "n_robots": 3, "n_victims": 2, "seed": 0} | change
    with pytest.raises(InputError) as caught:
        free_mission(options.pop("grid"), **options)
    assert caught.value.field == field
