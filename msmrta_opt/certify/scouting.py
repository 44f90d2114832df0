"""The check of a scouting report: its walks are replayed, and what was in sight is worked out again.

Two free cells within the visual field depth see each other iff the straight line between their centres
meets the inside of no blocked cell, and does not pass between two blocked cells that touch at a corner.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..mission.grid import Cell, GridMap
from ..mission.instance import Instance
from ..mission.plan import Plan, ScoutingReport, Track

CLOSE = 1e-9
"""Difference up to which two shares are the same."""
Seen = NDArray[np.bool_]


def problems(plan: Plan) -> list[str]:
    """Everything that is wrong with the scouting report of `plan`, one line each.

    Each scout of the mission has one track, which begins at its start and makes one move a step (or
    none, where no neighbour is free); finds, victims that were not found, coverage and why the search
    ended are those of the tracks. Without a report every victim is known.
    """
    instance, report = plan.instance, plan.scouting
    if report is None:
        return []
    if not instance.scouts:
        return ["scouting is reported, but the mission has no scouts"]
    wrong = _tracks(instance, report)
    return wrong or _sights(instance, report)


def _tracks(instance: Instance, report: ScoutingReport) -> list[str]:
    """Every scout has one track, of legal moves, and all are as long."""
    scouts = {scout.id: scout for scout in instance.scouts}
    count = Counter(track.scout for track in report.tracks)
    wrong = [f"there is no scout {scout}" for scout in count if scout not in scouts]
    wrong += [f"scout {scout} has {count[scout]} tracks" for scout in scouts if count[scout] != 1]
    if wrong:
        return wrong
    longest = max(len(track.cells) for track in report.tracks)
    for track in report.tracks:
        scout = scouts[track.scout]
        if track.visual_field_depth != scout.visual_field_depth:
            wrong.append(
                f"scout {scout.id} is said to see {track.visual_field_depth} cells far, "
                f"and sees {scout.visual_field_depth}"
            )
        if len(track.cells) != longest:
            wrong.append(
                f"scout {scout.id} has {len(track.cells)} cells, where others have {longest}"
            )
        if track.cells[:1] != (scout.start,):
            wrong.append(f"scout {scout.id} does not set out from its start {scout.start}")
        wrong += _moves(instance.map, track)
    return wrong


def _moves(grid: GridMap, track: Track) -> Iterator[str]:
    for step, cell in enumerate(track.cells):
        if not grid.is_free(cell):
            yield f"scout {track.scout} is at {cell} at step {step}, which is not a free cell"
    for step, (here, there) in enumerate(pairwise(track.cells), start=1):
        moves = abs(here[0] - there[0]) + abs(here[1] - there[1])
        if moves > 1:
            yield f"scout {track.scout} jumps from {here} to {there} at step {step}"
        elif not moves and any(map(grid.is_free, _beside(here))):
            yield f"scout {track.scout} stays at {here} at step {step}, though it can move"


def _beside(cell: Cell) -> tuple[Cell, ...]:
    row, col = cell
    return (row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)


def _sights(instance: Instance, report: ScoutingReport) -> list[str]:
    """What the tracks show, against what is reported."""
    cells = {track.scout: track.cells for track in report.tracks}
    seeable = _seeable(instance)
    seen: Seen = np.zeros(instance.map.shape, dtype=bool)
    looked: set[tuple[int, Cell]] = set()
    hidden = {victim.id: victim.cell for victim in instance.victims}
    finds: dict[int, tuple[int, int]] = {}
    coverage: list[float] = []
    n_seen = 0
    for step in range(len(report.tracks[0].cells)):
        for scout in instance.scouts:
            view = (scout.visual_field_depth, cells[scout.id][step])
            if view in looked:
                continue
            looked.add(view)
            in_sight(instance.map, *view, seen)
            for victim in [v for v, cell in hidden.items() if seen[cell]]:
                del hidden[victim]
                finds[victim] = (scout.id, step)
            n_seen = int(np.count_nonzero(seen))
        coverage.append(n_seen / seeable)
    return [
        *_finds(instance, report, finds),
        *_coverage(report, coverage),
        *_end(report, all_found=bool(finds) and not hidden, covered=n_seen == seeable),
    ]


def _finds(
    instance: Instance, report: ScoutingReport, finds: dict[int, tuple[int, int]]
) -> Iterator[str]:
    found = Counter(find.victim for find in report.finds)
    missed = Counter(report.not_found)
    for victim in instance.victims:
        n, known = found[victim.id] + missed[victim.id], finds.get(victim.id)
        if n != 1:
            yield f"victim {victim.id} is listed {n} times as found or not found"
        elif missed[victim.id] and known:
            yield (
                f"victim {victim.id} is listed as not found, but scout {known[0]} sees it at step "
                f"{known[1]}"
            )
    for find in report.finds:
        known = finds.get(find.victim)
        said = f"victim {find.victim} is found by scout {find.scout} at step {find.step}"
        if known is None:
            yield f"{said}, but no scout sees it"
        elif known != (find.scout, find.step):
            yield f"{said}, which should be scout {known[0]} at step {known[1]}"


def _coverage(report: ScoutingReport, coverage: list[float]) -> Iterator[str]:
    if len(report.coverage) != len(coverage):
        yield f"coverage is given for {len(report.coverage)} steps of {len(coverage)}"
        return
    for step, (said, true) in enumerate(zip(report.coverage, coverage, strict=True)):
        if not abs(said - true) <= CLOSE:
            yield f"coverage after step {step} is {said:g}, which should be {true:g}"


def _end(report: ScoutingReport, *, all_found: bool, covered: bool) -> Iterator[str]:
    holds = {
        "all victims found": all_found,
        "covered": covered,
        "step limit": not covered,
    }
    if not holds[report.ended]:
        yield f"scouting is said to have ended by {report.ended!r}, which does not hold"


def _seeable(instance: Instance) -> int:
    """How many cells can be seen from cells that the scouts can walk to: these cells themselves."""
    free = instance.map.is_free
    border = [scout.start for scout in instance.scouts]
    reached = set(border)
    while border:
        for cell in _beside(border.pop()):
            if cell not in reached and free(cell):
                reached.add(cell)
                border.append(cell)
    return len(reached)


# Sight


def in_sight(grid: GridMap, depth: int, cell: Cell, seen: Seen) -> None:
    """Note in `seen`, shape ``(n_rows, n_cols)``, what can be seen from `cell`; only that is added."""
    n_rows, n_cols = grid.shape
    depth = min(depth, max(n_rows, n_cols) - 1)
    rows = np.arange(max(cell[0] - depth, 0), min(cell[0] + depth, n_rows - 1) + 1)
    cols = np.arange(max(cell[1] - depth, 0), min(cell[1] + depth, n_cols - 1) + 1)
    new_rows, new_cols = np.nonzero((grid.free & ~seen)[np.ix_(rows, cols)])
    rows, cols = rows[new_rows], cols[new_cols]
    line, corner = _lines(depth)
    down, right = rows - cell[0], cols - cell[1]
    flip = (np.where(down < 0, -1, 1), np.where(right < 0, -1, 1))
    number = abs(down) * (depth + 1) + abs(right)
    blocked = ~grid.free

    def is_blocked(offsets: NDArray[np.int32]) -> Seen:
        there = offsets[number]
        rows = cell[0] + flip[0][:, None] * there[..., 0]
        cols = cell[1] + flip[1][:, None] * there[..., 1]
        return np.asarray(blocked[rows, cols])

    hit = is_blocked(line).any(axis=1)
    hit |= (is_blocked(corner[:, :, 0]) & is_blocked(corner[:, :, 1])).any(axis=1)
    seen[rows[~hit], cols[~hit]] = True


@cache
def _lines(depth: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """What the lines from ``(0, 0)`` to the cells of a quarter of a square meet.

    Returns
    -------
    line : int array, shape ((depth + 1)**2, n, 2)
        Per target, row-major, the cells whose inside the line meets; filled up with ``(0, 0)``.
    corner : int array, shape ((depth + 1)**2, m, 2, 2)
        Per target and corner that the line passes, the two cells beside it; filled up alike.
    """
    quarter = [(row, col) for row in range(depth + 1) for col in range(depth + 1)]
    line, corner = [_met(*target) for target in quarter], [_corners(*target) for target in quarter]
    return _filled_up(line), _filled_up(corner).reshape(len(quarter), -1, 2, 2)


def _met(row: int, col: int) -> list[tuple[int, int]]:
    """The cells whose inside the line to ``(row, col)`` meets."""
    if col == 0:
        return [(r, 0) for r in range(row + 1)]
    met = []
    for c in range(col + 1):
        # Over the width of column c, the line is between these rows, in parts of 2 col.
        top, bottom = row * max(2 * c - 1, 0), row * min(2 * c + 1, 2 * col)
        first = (top - col) // (2 * col) + 1
        last = -((-bottom - col) // (2 * col)) - 1
        met += [(r, c) for r in range(first, last + 1)]
    return met


def _corners(row: int, col: int) -> list[tuple[int, int]]:
    """Two by two, the cells beside the corners that the line to ``(row, col)`` passes."""
    beside = []
    for c in range(col):
        halves, rest = divmod(row * (2 * c + 1), col)
        if rest == 0 and halves % 2:
            beside += [(halves // 2, c + 1), (halves // 2 + 1, c)]
    return beside


def _filled_up(lists: list[list[tuple[int, int]]]) -> NDArray[np.int32]:
    """One row of cells each, filled up with ``(0, 0)``."""
    longest = max(map(len, lists))
    return np.array(
        [own + [(0, 0)] * (longest - len(own)) for own in lists], dtype=np.int32
    ).reshape(len(lists), longest, 2)
