from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples, sample

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance, Robot, Scout, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Find, ScoutingReport
from msmrta_opt.stages import scouting as module
from msmrta_opt.stages.scouting import STOPS, scouting
from msmrta_opt.stages.walks import WALKS, Ground, Walk

INSTANCES = Path(__file__).parents[2] / "instances"


def mission(
    grid: GridMap | Sequence[str], scouts: Sequence[Scout], victims: dict[int, Cell] | None = None
) -> Instance:
    """A mission with one idle robot and the given scouts and victims (cells by id)."""
    grid = grid if isinstance(grid, GridMap) else grid_from_rows(grid)
    row, col = np.argwhere(grid.free)[0].tolist()
    return Instance(
        map=grid,
        capabilities=(),
        service_time={},
        robots=(Robot(id=0, start=(row, col), speed=1.0, capabilities=()),),
        victims=tuple(
            Victim(id=i, cell=cell, requirements=()) for i, cell in (victims or {}).items()
        ),
        scouts=tuple(scouts),
    )


def scout(start: Cell, depth: int, id: int = 0) -> Scout:  # noqa: A002 - the document's word
    return Scout(id=id, start=start, visual_field_depth=depth)


# What is found, when, and by whom


def test_a_victim_in_view_of_a_start_is_found_before_the_first_move() -> None:
    report = scouting(mission(["....."], [scout((0, 0), 2, id=3)], {7: (0, 2)}))
    assert report.finds == (Find(victim=7, scout=3, step=0),)
    assert report.tracks[0].cells == ((0, 0),)
    assert report.coverage == (3 / 5,)
    assert report.ended == "all victims found"


# In this room the scout at (0, 0) can only walk down and then right, and sees (1, 1) at once (past
# the corner of one wall), (1, 2) from (1, 0), and the victim's cell (0, 2) not before (1, 1).
ROOM = [".@.", "..."]
AROUND_THE_CORNER = mission(ROOM, [scout((0, 0), 2)], {0: (0, 2)})


def test_a_victim_behind_a_wall_is_found_only_where_the_line_of_sight_is_clear() -> None:
    report = scouting(AROUND_THE_CORNER)
    assert report.tracks[0].cells == ((0, 0), (1, 0), (1, 1))
    assert report.finds == (Find(victim=0, scout=0, step=2),)
    assert report.not_found == ()
    assert report.coverage == (3 / 5, 4 / 5, 1.0)


def test_the_first_scout_of_the_document_takes_the_find_of_a_step() -> None:
    scouts = [scout((0, 0), 0, id=1), scout((0, 4), 2, id=9), scout((0, 0), 2, id=4)]
    report = scouting(mission(["....."], scouts, {0: (0, 2)}))
    assert report.finds == (Find(victim=0, scout=9, step=0),)


def test_finds_come_by_step_then_scout_then_victim_in_document_order() -> None:
    # Along the corridor, in sight at once: 5 and 8 of the left scout, 2 of the right one. The left
    # scout walks right, and sees 1 and 6 (the same cell) after its first move.
    rows = ["......@.."]
    victims = {6: (0, 3), 2: (0, 7), 8: (0, 1), 1: (0, 3), 5: (0, 2)}
    report = scouting(mission(rows, [scout((0, 0), 2, id=0), scout((0, 8), 1, id=1)], victims))
    assert [(find.victim, find.scout, find.step) for find in report.finds] == [
        (8, 0, 0),
        (5, 0, 0),
        (2, 1, 0),
        (6, 0, 1),
        (1, 0, 1),
    ]


def test_each_scout_sees_as_far_as_its_own_depth() -> None:
    victims = {0: (0, 2), 1: (2, 2)}
    scouts = [scout((0, 0), 1, id=0), scout((2, 0), 2, id=1)]
    report = scouting(mission(["...", "@@@", "..."], scouts, victims), max_steps=0)
    assert report.finds == (Find(victim=1, scout=1, step=0),)
    assert report.not_found == (0,)
    assert [track.visual_field_depth for track in report.tracks] == [1, 2]


def test_a_walled_in_victim_is_never_found() -> None:
    report = scouting(mission(["..@."], [scout((0, 0), 4)], {3: (0, 3), 4: (0, 1)}))
    assert report.not_found == (3,)
    assert [find.victim for find in report.finds] == [4]
    # The cell behind the wall cannot be seen from anywhere, so it does not count as missing.
    assert report.coverage == (1.0,)
    assert report.ended == "covered"


# How scouts move


def test_a_scout_in_a_corridor_walks_on_to_where_it_has_not_been() -> None:
    report = scouting(mission(["...."], [scout((0, 0), 0)]))
    assert report.tracks[0].cells == ((0, 0), (0, 1), (0, 2), (0, 3))
    assert report.coverage == (1 / 4, 2 / 4, 3 / 4, 1.0)
    assert report.ended == "covered"


@pytest.mark.parametrize("walk", WALKS)
def test_a_scout_without_a_free_neighbour_stays(walk: str) -> None:
    scouts = [scout((0, 0), 1, id=0), scout((0, 2), 0, id=1)]
    report = scouting(mission([".@...", "@@@@@"], scouts), walk=walk, seed=3)
    walled_in, free = (track.cells for track in report.tracks)
    assert set(walled_in) == {(0, 0)}
    assert len(walled_in) == len(free) >= 3


# Two scouts come to the middle of the plus from two of its arms; two arms are left.
PLUS = mission(["@.@", "...", "@.@"], [scout((0, 1), 0, id=0), scout((1, 0), 0, id=1)])


@pytest.mark.parametrize("seed", sample(range(12), 4))
def test_scouts_that_share_a_table_part_ways(seed: int) -> None:
    report = scouting(PLUS, shared_table=True, seed=seed)
    assert report.coverage == (2 / 5, 3 / 5, 1.0)
    assert report.shared_table


def test_scouts_with_tables_of_their_own_repeat_each_other() -> None:
    # Each avoids only the arm it came from, so both enter the two arms that are left with a chance
    # of 2/9: in 40 tries, all or none would be a miracle.
    coverages = {scouting(PLUS, shared_table=False, seed=seed).coverage[2] for seed in range(40)}
    assert 1.0 in coverages
    assert min(coverages) < 1


# When it ends


def test_finding_the_last_victim_takes_precedence_over_covering_the_last_cell() -> None:
    assert scouting(AROUND_THE_CORNER).ended == "all victims found"


def test_scouts_told_to_cover_the_area_go_on_after_the_last_find() -> None:
    corridor = mission(["...."], [scout((0, 0), 0)], {0: (0, 1)})
    found, covered = (scouting(corridor, stop=stop) for stop in STOPS)
    assert (found.ended, len(found.coverage)) == ("all victims found", 2)
    assert (covered.ended, len(covered.coverage)) == ("covered", 4)
    assert found.finds == covered.finds == (Find(victim=0, scout=0, step=1),)
    assert scouting(AROUND_THE_CORNER, stop="covered").ended == "covered"


def test_the_search_ends_at_the_step_limit() -> None:
    report = scouting(AROUND_THE_CORNER, max_steps=1)
    assert report.ended == "step limit"
    assert report.tracks[0].cells == ((0, 0), (1, 0))
    assert report.coverage == (3 / 5, 4 / 5)
    assert report.not_found == (0,)


def test_a_search_that_succeeds_at_the_limit_has_succeeded() -> None:
    assert scouting(AROUND_THE_CORNER, max_steps=2).ended == "all victims found"
    assert scouting(AROUND_THE_CORNER, max_steps=2, stop="covered").ended == "covered"


def test_at_a_limit_of_no_steps_scouts_look_around_without_moving() -> None:
    report = scouting(AROUND_THE_CORNER, max_steps=0)
    assert report.ended == "step limit"
    assert report.tracks[0].cells == ((0, 0),)
    assert report.coverage == (3 / 5,)


def test_without_victims_scouts_cover_the_area() -> None:
    report = scouting(mission(ROOM, [scout((0, 0), 2)]))
    assert report.ended == "covered"
    assert report.coverage[-1] == 1
    assert report.finds == report.not_found == ()


def test_the_default_limit_is_fifty_steps_per_free_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    def pacing(ground: Ground) -> Walk:
        return lambda _, here: ground.neighbours(here)[0]

    monkeypatch.setattr(module, "WALKS", {"pacing": pacing})
    report = scouting(mission(["....@"], [scout((0, 0), 0)]), walk="pacing")
    assert report.ended == "step limit"
    assert len(report.tracks[0].cells) == len(report.coverage) == 50 * 4 + 1


# Wrong input


def test_an_instance_without_scouts_is_refused() -> None:
    with pytest.raises(InputError, match="has no scouts"):
        scouting(mission(ROOM, []))


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"walk": "ant"}, "walk: unknown walk 'ant'; there are ant_colony, random, levy"),
        ({"stop": "found"}, "stop: unknown condition 'found'; there are covered_or_found, covered"),
        ({"seed": -1}, "seed: -1; give an integer from 0 to 2**32 - 1"),
        ({"max_steps": -1}, "max_steps: -1; give no fewer than 0 steps"),
    ],
)
def test_a_wrong_option_is_named_with_what_would_be_right(
    option: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError) as error:
        scouting(AROUND_THE_CORNER, **option)
    assert str(error.value) == message


# Whatever the map


def sees(grid: GridMap, a: Cell, b: Cell, depth: int) -> bool:
    """The definition of sight, by separating axes, in half-cells: no step along the line."""
    if max(abs(a[0] - b[0]), abs(a[1] - b[1])) > depth or not grid.is_free(b):
        return False

    def side(row: int, col: int) -> int:
        """On which side of the line the point lies, given in half-cells."""
        return (row - 2 * a[0]) * (b[1] - a[1]) - (col - 2 * a[1]) * (b[0] - a[0])

    rows = range(min(a[0], b[0]), max(a[0], b[0]) + 1)
    cols = range(min(a[1], b[1]), max(a[1], b[1]) + 1)
    for row, col in product(rows, cols):
        sides = [side(2 * row + i, 2 * col + j) for i, j in product((-1, 1), repeat=2)]
        if not grid.free[row, col] and min(sides) < 0 < max(sides):
            return False
    for row, col in product(rows[:-1], cols[:-1]):
        corner = grid.free[row : row + 2, col : col + 2]
        touching = not corner.diagonal().any() or not corner[::-1].diagonal().any()
        if touching and side(2 * row + 1, 2 * col + 1) == 0:
            return False
    return True


def area_of(grid: GridMap, starts: Sequence[Cell]) -> set[Cell]:
    """All cells that can be walked to, by flood fill."""
    area, border = set(starts), list(starts)
    while border:
        row, col = border.pop()
        for cell in ((row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)):
            if grid.is_free(cell) and cell not in area:
                area.add(cell)
                border.append(cell)
    return area


@st.composite
def missions(draw: st.DrawFn) -> Instance:
    n_rows, n_cols = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    row = st.lists(st.sampled_from([True, True, False]), min_size=n_cols, max_size=n_cols)
    free = np.array(draw(st.lists(row, min_size=n_rows, max_size=n_rows)))
    free[draw(st.integers(0, n_rows - 1)), draw(st.integers(0, n_cols - 1))] = True
    cells = st.sampled_from([(row, col) for row, col in np.argwhere(free).tolist()])
    starts = draw(st.lists(cells, min_size=1, max_size=3))
    ids = draw(st.permutations(range(len(starts))))
    scouts = [
        scout(start, draw(st.integers(0, 3)), id=i) for i, start in zip(ids, starts, strict=True)
    ]
    victims = draw(st.lists(cells, max_size=4))
    return mission(GridMap(free), scouts, dict(enumerate(victims)))


searches = st.fixed_dictionaries(
    {
        "walk": st.sampled_from(sorted(WALKS)),
        "shared_table": st.booleans(),
        "seed": st.integers(0, 2**32 - 1),
        "max_steps": st.none() | st.integers(0, 30),
        "stop": st.sampled_from(STOPS),
    }
)


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(missions(), searches)
def test_every_report_holds_when_the_search_is_watched_again(
    instance: Instance, options: dict[str, Any]
) -> None:
    grid = instance.map
    report = scouting(instance, **options)

    assert [track.scout for track in report.tracks] == [s.id for s in instance.scouts]
    for s, track in zip(instance.scouts, report.tracks, strict=True):
        assert track.visual_field_depth == s.visual_field_depth
        assert track.cells[0] == s.start
        assert len(track.cells) == len(report.coverage)
        for here, there in pairwise(track.cells):
            move = abs(here[0] - there[0]) + abs(here[1] - there[1])
            assert grid.is_free(there)
            assert move == 1 or (move == 0 and area_of(grid, [here]) == {here})

    area = area_of(grid, [s.start for s in instance.scouts])
    depths = {s.visual_field_depth for s in instance.scouts}
    views = {
        (cell, depth): {
            other for other in np.ndindex(*grid.shape) if sees(grid, cell, other, depth)
        }
        for depth in depths
        for cell in area
    }
    seeable = set().union(*views.values())
    hidden = {victim.id: victim.cell for victim in instance.victims}
    seen: set[Cell] = set()
    finds, coverage, verdicts = [], [], []
    limit = options["max_steps"]
    limit = 50 * int(grid.free.sum()) if limit is None else limit
    for step in range(len(report.coverage)):
        for track in report.tracks:
            view = views[track.cells[step], track.visual_field_depth]
            found = [victim for victim, cell in hidden.items() if cell in view]
            finds += [Find(victim=i, scout=track.scout, step=step) for i in found]
            hidden = {victim: cell for victim, cell in hidden.items() if victim not in found}
            seen |= view
        coverage.append(len(seen) / len(seeable))
        if options["stop"] == "covered_or_found" and instance.victims and not hidden:
            verdicts.append("all victims found")
        elif seen == seeable:
            verdicts.append("covered")
        else:
            verdicts.append("step limit" if step == limit else None)

    assert report.finds == tuple(finds)
    assert report.not_found == tuple(hidden)
    assert report.coverage == pytest.approx(coverage, abs=1e-12)
    assert all(0 < before <= after <= 1 for before, after in pairwise((1e-9, *report.coverage)))
    assert verdicts == [None] * (len(verdicts) - 1) + [report.ended]


@settings(max_examples=examples(30), deadline=None, derandomize=True)
@given(missions(), searches)
def test_the_same_seed_gives_the_same_report(instance: Instance, options: dict[str, Any]) -> None:
    first = scouting(instance, **options)
    again = scouting(instance, **options)
    assert first == again
    assert ScoutingReport.model_validate_json(first.model_dump_json()) == first


# The paper's mission


@pytest.fixture(scope="module")
def paper() -> Instance:
    scouts = (scout((0, 9), 4, 0), scout((15, 0), 4, 1), scout((17, 19), 4, 2))
    return Instance.read(INSTANCES / "paper.json").replace(scouts=scouts)


@pytest.mark.parametrize("shared_table", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_ants_find_all_ten_victims_of_the_paper(
    paper: Instance, seed: int, shared_table: bool
) -> None:
    report = scouting(paper, seed=seed, shared_table=shared_table)
    assert report.ended == "all victims found"
    assert {find.victim for find in report.finds} == set(range(10))
    assert report.not_found == ()


@pytest.mark.parametrize("walk", WALKS)
@pytest.mark.parametrize("seed", range(3))
def test_every_walk_covers_map_2(paper: Instance, walk: str, seed: int) -> None:
    report = scouting(paper, walk=walk, seed=seed, stop="covered")
    assert report.ended == "covered"
    assert report.coverage[-1] == 1
    assert len(report.finds) == 10
