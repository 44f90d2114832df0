"""Maps to generate missions on: rooms, rubble and mazes.

The same seed gives the same map on every machine: all choices come from streams that numpy has frozen,
and no float decides anything. Mazes and buildings are one idea: places between walls, joined by a
spanning tree of random weights (Kruskal's algorithm, as it is commonly used for mazes), after which a
share of the other walls is opened.
"""

from __future__ import annotations

from collections.abc import Iterator
from decimal import ROUND_HALF_UP, Decimal

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .grid import Cell, GridMap

LONGEST_SIDE = 1000
CORRIDOR = 2
"""Width of a building's corridors in cells."""
_STARTS_TRIED = 60
_PARTS_WEIGHED = 60
_CROSS = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]])

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Span = tuple[int, int]  # first cell, number of cells
Area = tuple[Span, Span]  # of rows, of columns


def rooms(n_rows: int, n_cols: int, *, seed: int, room: int = 4, openings: float = 0.1) -> GridMap:
    """A building: rooms with doors of one cell along corridors of two, an outer wall around.

    Wide areas are divided by a corridor, their parts by corridors across it; what is left between
    corridors is divided into rooms by walls. Every room can be reached from every other one.

    Parameters
    ----------
    n_rows, n_cols : int
        Size of the map in cells, the outer wall included.
    seed : int
        Determines everything that is random.
    room : int
        Least side of a room in cells, at least 3. The longest is twice that.
    openings : float
        Share of the neighbouring places without a door between them, once all are connected,
        that get one as well; 0 to 1.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    if not 3 <= room <= LONGEST_SIDE:
        raise InputError(f"{room!r}; give the minimum side of a room, 3 or more", field="room")
    _check_size(n_rows, n_cols, room + 2, f"for rooms of {room} and the outer wall")
    check_share(openings, "openings")
    random = random_stream(seed, "rooms")
    whole: Area = ((1, n_rows - 2), (1, n_cols - 2))
    # The first corridor runs along the longer side.
    places = list(_building(whole, 0 if n_rows <= n_cols else 1, room, random))
    labels = np.zeros((n_rows, n_cols), dtype=np.int64)
    for label, (((top, height), (left, width)), _) in enumerate(places, start=1):
        labels[top : top + height, left : left + width] = label
    is_corridor = np.array([False, *(corridor for _, corridor in places)])
    free = _with_doors(labels, is_corridor, openings, random)
    return GridMap(free, name=f"rooms-{n_rows}x{n_cols}")


def rubble(n_rows: int, n_cols: int, *, seed: int, density: float = 0.2) -> GridMap:
    """Open ground on which a share of the cells, drawn at random, is blocked.

    Parameters
    ----------
    n_rows, n_cols : int
        Size of the map in cells.
    seed : int
        Determines everything that is random.
    density : float
        Share of blocked cells, 0 to 1, as near as whole cells allow; one cell stays free. From
        about 0.4 on, the ground falls apart into small regions.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    _check_size(n_rows, n_cols, 1, "for any ground")
    check_share(density, "density")
    blocked = share_of(density, n_rows * n_cols)
    if blocked == n_rows * n_cols:
        raise InputError(f"{density!r} leaves no free cell; give less", field="density")
    free = np.ones(n_rows * n_cols, dtype=bool)
    free[random_stream(seed, "rubble").permutation(free.size)[:blocked]] = False
    return GridMap(free.reshape(n_rows, n_cols), name=f"rubble-{n_rows}x{n_cols}")


def maze(n_rows: int, n_cols: int, *, seed: int, openings: float = 0.0) -> GridMap:
    """A maze with passages and walls of one cell, an outer wall around.

    Parameters
    ----------
    n_rows, n_cols : int
        Size of the map in cells, odd numbers.
    seed : int
        Determines everything that is random.
    openings : float
        Share of the remaining walls between passages that is opened, 0 to 1. With 0 the maze is
        perfect: exactly one way leads from any cell to any other.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    _check_size(n_rows, n_cols, 3, "for a maze")
    if n_rows % 2 == 0 or n_cols % 2 == 0:
        raise InputError(
            f"{n_rows}x{n_cols}; a maze's passages and walls take odd numbers of cells, "
            f"such as {n_rows // 2 * 2 + 1}x{n_cols // 2 * 2 + 1}",
            field="size",
        )
    check_share(openings, "openings")
    labels = np.zeros((n_rows, n_cols), dtype=np.int64)
    passages = labels[1::2, 1::2]
    passages[:] = np.arange(1, passages.size + 1).reshape(passages.shape)
    is_corridor = np.zeros(passages.size + 1, dtype=bool)
    free = _with_doors(labels, is_corridor, openings, random_stream(seed, "maze"))
    return GridMap(free, name=f"maze-{n_rows}x{n_cols}")


def with_pocket(grid: GridMap, n_cells: int, *, seed: int) -> GridMap:
    """`grid` with a part of its largest region walled off.

    The part grows from some cell, always by the border cell that brings the fewest new ones; of all
    parts seen, one that takes few blocked cells and leaves the rest in one piece is walled off. So a
    room loses its door, or a maze a dead end.

    Parameters
    ----------
    grid : GridMap
        The map.
    n_cells : int
        Least size of the part, at most a quarter of the largest region.
    seed : int
        Determines everything that is random.

    Raises
    ------
    InputError
        If the map is too small for it.
    """
    from scipy.ndimage import convolve

    region = largest_region(grid)
    cells: list[Cell] = [(int(row), int(col)) for row, col in np.argwhere(region)]
    if not 1 <= n_cells <= len(cells) // 4:
        raise InputError(
            f"{n_cells!r} of {len(cells)} connected cells to wall off; no more than "
            f"{len(cells) // 4} can be, and no fewer than 1: give another number, or a larger map",
            field="pocket",
        )
    maximum = min(3 * n_cells + 20, len(cells) // 4)
    starts = random_stream(seed, "pocket").permutation(len(cells))[:_STARTS_TRIED]
    inside = frozenset(cells)
    grown = dict.fromkeys(
        (size, border)
        for start in starts
        for size, border in _growth(inside, cells[start], maximum)
        if size >= n_cells
    )
    ways = convolve(region.astype(np.int64), _CROSS, mode="constant")

    def effort(part: tuple[int, tuple[Cell, ...]]) -> tuple[int, int, int]:
        # A doorway, with two ways on, rather than the cell behind it, with three.
        size, border = part
        return len(border), sum(int(ways[cell]) for cell in border), size

    likely = sorted(grown, key=effort)[:_PARTS_WEIGHED]

    def cut(border: tuple[Cell, ...]) -> GridMap:
        free = grid.free.copy()
        free[tuple(np.array(border).T)] = False
        return GridMap(free, name=grid.name)

    def stray(part: tuple[int, tuple[Cell, ...]]) -> int:
        size, border = part
        return len(cells) - size - len(border) - int(largest_region(cut(border)).sum())

    return cut(min(likely, key=stray)[1])


def largest_region(grid: GridMap) -> Bools:
    """The cells of the largest connected part of `grid`, shape ``(n_rows, n_cols)``.

    Of equally large ones, that with the first cell in reading order; of a map without free cells,
    none.
    """
    from scipy.ndimage import label

    labels = np.asarray(label(grid.free)[0])
    sizes = np.bincount(labels.ravel(), minlength=2)
    found: Bools = labels == 1 + int(np.argmax(sizes[1:]))
    return found


def cells_out_of_reach(grid: GridMap) -> int:
    """How many free cells lie outside the largest region: room for victims out of reach."""
    return int((grid.free & ~largest_region(grid)).sum())


def random_stream(seed: int, purpose: str) -> np.random.RandomState:
    """Random numbers for one purpose, apart from those for others of the same seed.

    Raises
    ------
    InputError
        If the seed is out of range.
    """
    if not 0 <= seed < 2**32:
        raise InputError(f"{seed!r}; give a whole number, 0 to 2**32 - 1", field="seed")
    # RandomState's streams are frozen by numpy for good; those of Generator's methods are not.
    return np.random.RandomState([seed, *purpose.encode()])


def share_of(share: float, count: int) -> int:
    """`share` × `count`, as the share is written in decimals, to the nearest; halves go up."""
    return int((Decimal(repr(float(share))) * count).to_integral_value(ROUND_HALF_UP))


def check_share(share: float, field: str) -> None:
    """Refuse a share that is not from 0 to 1.

    Raises
    ------
    InputError
        Naming `field`.
    """
    if not 0 <= share <= 1:
        raise InputError(f"{share!r}; give a number from 0 to 1", field=field)


def _check_size(n_rows: int, n_cols: int, minimum: int, what: str) -> None:
    if not (minimum <= n_rows <= LONGEST_SIDE and minimum <= n_cols <= LONGEST_SIDE):
        raise InputError(
            f"{n_rows}x{n_cols}; give {minimum} to {LONGEST_SIDE} rows and columns {what}",
            field="size",
        )


def _building(
    area: Area, axis: int, room: int, random: np.random.RandomState
) -> Iterator[tuple[Area, bool]]:
    """The places of an area, each with whether it is a corridor; the first divides `axis`."""
    (start, depth), length = area[axis], area[1 - axis][1]
    to_share = depth - CORRIDOR - 2
    if to_share < 3 * room or length < 3 * room:
        yield from ((part, False) for part in _rooms(area, room, random))
        return
    first = _between(random, to_share // 3, to_share - to_share // 3)
    yield _cut(area, axis, (start + first + 1, CORRIDOR)), True
    for part in ((start, first), (start + first + CORRIDOR + 2, to_share - first)):
        yield from _building(_cut(area, axis, part), 1 - axis, room, random)


def _rooms(area: Area, room: int, random: np.random.RandomState) -> Iterator[Area]:
    """An area divided by walls, across its longer side first, until no side exceeds 2 · room."""
    axis = 0 if area[0][1] > area[1][1] else 1
    start, depth = area[axis]
    if depth <= 2 * room:
        yield area
        return
    first = _between(random, room, depth - 1 - room)
    yield from _rooms(_cut(area, axis, (start, first)), room, random)
    yield from _rooms(_cut(area, axis, (start + first + 1, depth - first - 1)), room, random)


def _cut(area: Area, axis: int, span: Span) -> Area:
    return (span, area[1]) if axis == 0 else (area[0], span)


def _between(random: np.random.RandomState, minimum: int, maximum: int) -> int:
    # The default type is the platform's.
    return int(random.randint(minimum, maximum + 1, dtype=np.int64))


def _with_doors(
    labels: Ints, is_corridor: Bools, openings: float, random: np.random.RandomState
) -> Bools:
    """The free cells once places are joined, shape ``(n_rows, n_cols)``.

    Parameters
    ----------
    labels : int array, shape (n_rows, n_cols)
        Number of the place that each cell belongs to, from 1; 0 for walls.
    is_corridor : bool array, shape (n_places + 1,)
        Corridors that meet are opened to each other in full; a room prefers a door to a corridor.
    openings : float
        Share of the pairs of neighbours left apart that is joined as well.
    random : RandomState
        Where all choices come from.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree

    cells, pairs = _walls_between(labels)
    order = random.permutation(len(cells))
    cells, pairs = cells[order], pairs[order]
    # In random order the first wall cell of a pair is a random one.
    joins, first, join_of = np.unique(pairs, axis=0, return_index=True, return_inverse=True)
    n_rooms = 2 - is_corridor[joins].sum(axis=1)
    weight = 1 + random.permutation(len(joins)) + len(joins) * n_rooms
    # All weights differ, so there is one minimum tree, whatever the algorithm.
    graph = coo_array((weight.astype(float), tuple(joins.T)), shape=(len(is_corridor),) * 2)
    opened = np.isin(weight, minimum_spanning_tree(graph).data) | (n_rooms == 0)
    apart = random.permutation(np.flatnonzero(~opened))
    opened[apart[: share_of(openings, len(apart))]] = True
    free = labels > 0
    free[tuple(cells[first[opened]].T)] = True
    free[tuple(cells[n_rooms[join_of.reshape(-1)] == 0].T)] = True
    return free


def _walls_between(labels: Ints) -> tuple[Ints, Ints]:
    """Wall cells with two places on opposite sides, and those two, shapes ``(n_walls, 2)``."""
    cells, pairs = [], []
    for before, wall, after, corner in (
        (labels[:-2], labels[1:-1], labels[2:], (1, 0)),
        (labels[:, :-2], labels[:, 1:-1], labels[:, 2:], (0, 1)),
    ):
        thin = (wall == 0) & (before > 0) & (after > 0)
        cells.append(np.argwhere(thin) + corner)
        pairs.append(np.sort(np.stack([before[thin], after[thin]], axis=1), axis=1))
    return np.concatenate(cells), np.concatenate(pairs)


def _growth(
    region: frozenset[Cell], start: Cell, maximum: int
) -> Iterator[tuple[int, tuple[Cell, ...]]]:
    """Parts that grow from `start`: how many cells, and the cells of `region` around them."""
    seen = {start}
    border = {start: 0}  # in the order of discovery, each with the number of its unseen neighbours

    def around(cell: Cell) -> list[Cell]:
        row, col = cell
        beside = ((row - 1, col), (row, col - 1), (row, col + 1), (row + 1, col))
        return [other for other in beside if other in region]

    for size in range(1, maximum + 1):
        cell = min(border, key=border.__getitem__)
        del border[cell]
        found = [other for other in around(cell) if other not in seen]
        seen.update(found)
        for neighbour in (beside for other in found for beside in around(other)):
            if neighbour in border:
                border[neighbour] -= 1
        border |= {other: sum(cell not in seen for cell in around(other)) for other in found}
        yield size, tuple(sorted(border))
