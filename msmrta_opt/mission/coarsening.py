"""A floor in pixels made a grid of cells, on which robots of a given radius can do what cells promise.

A robot stands on a pixel if its disc touches nothing occupied: if the centres of all occupied pixels
are farther than its radius, as in the inscribed layer of ROS' costmaps. Beyond the image nothing is
free. Within a cell, such pixels fall into connected pieces, of which the largest stands for the cell.

Cells are then blocked until the grid promises no walk that there is not: of two neighbours between
whose pieces no pixel leads straight to the other, the smaller gives way. Last, of every region of the
floor only the largest part is kept that the cells connect. So two free cells are connected on the grid
if and only if their pieces are on the floor, and every move of the grid stays within its two cells.

A robot in a free cell stands at its centre if it fits there, and else on the pixel of the cell's piece
that is nearest to the centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Bools, Ints
from .counting import rows_by_columns
from .errors import InputError, shown
from .frame import Frame
from .grid import GridMap
from .occupancy import FREE, OCCUPIED, Occupancy, is_finite

LARGEST_CELLS = 4_000_000
"""Of a grid."""
Unknown = Literal["blocked", "free"]


@dataclass(frozen=True, eq=False)
class Coarsening:
    """What became of a floor.

    Attributes
    ----------
    floor : Occupancy
        What was read.
    grid : GridMap
        The cells, with their frame.
    fits : bool array, shape (n_pixel_rows, n_pixel_cols)
        Where the robot's disc fits.
    fits_somewhere : bool array, shape (n_rows, n_cols)
        The cells in which it does.
    area : float
        Where it fits, in square metres.
    n_regions : int
        Connected regions of where it fits.
    left_out : float
        Of `area`, what lies in no free cell's piece, in square metres: corners beside other pieces, and
        what is too narrow for cells of this size.
    """

    floor: Occupancy
    grid: GridMap
    fits: Bools
    fits_somewhere: Bools
    area: float
    n_regions: int
    left_out: float


def coarsen(
    floor: Occupancy,
    cell_size: float,
    *,
    robot_radius: float = 0.0,
    unknown: Unknown = "blocked",
) -> Coarsening:
    """Cells of `cell_size` metres for robots of `robot_radius` metres.

    Parameters
    ----------
    floor : Occupancy
        What is free.
    cell_size : float
        Side of a cell in metres, at least that of a pixel. Cells are laid from the lower left corner;
        those at the other sides may reach beyond the image.
    robot_radius : float
        In metres.
    unknown : {"blocked", "free"}
        How unknown space counts.

    Raises
    ------
    InputError
        If a number is out of range, or the robot fits nowhere.
    """
    _check(floor, cell_size, robot_radius, unknown)
    rows, cols = (_cells(n, floor.resolution, cell_size) for n in floor.state.shape)
    rows = rows[-1] - rows[::-1]  # cells are counted from the bottom, rows from the top
    shape = int(rows[-1]) + 1, int(cols[-1]) + 1
    if shape[0] * shape[1] > LARGEST_CELLS:
        raise InputError(
            f"{shown(cell_size)} makes {rows_by_columns(shape)}; give a larger one, for at most "
            f"{LARGEST_CELLS:,} in all",
            field="cell_size",
        )
    fits = _fits(floor, robot_radius, unknown)
    chosen, size = _pieces(fits, rows, cols, shape)
    aside, below = _links(chosen, rows, cols, shape)
    free = _without_false_moves(size, aside, below)
    regions, n_regions = _labelled(fits)
    free &= _largest_parts(free, _region_of(chosen, regions, rows, cols, shape))
    if not free.any():
        raise InputError(
            f"{shown(robot_radius)}; no disc of this radius fits on the map", field="robot_radius"
        )
    kept = chosen & free[np.ix_(rows, cols)]
    pixel = floor.resolution**2
    off_centre = _off_centre(kept, free, rows, cols, floor.resolution, cell_size)
    frame = Frame(cell_size, floor.origin, shape[0], off_centre)
    return Coarsening(
        floor=floor,
        grid=GridMap(free, name=floor.name, source=floor.source, frame=frame),
        fits=fits,
        fits_somewhere=size > 0,
        area=float(fits.sum()) * pixel,
        n_regions=n_regions,
        left_out=float(fits.sum() - kept.sum()) * pixel,
    )


def _check(floor: Occupancy, cell_size: float, robot_radius: float, unknown: str) -> None:
    if not isinstance(floor, Occupancy):
        raise InputError(
            f"{shown(floor)}; give an Occupancy, as Occupancy(array, 0.05) makes", field="floor"
        )
    if not (is_finite(cell_size) and floor.resolution * (1 - 1e-9) <= cell_size):
        raise InputError(
            f"{shown(cell_size)}; give metres, at least a pixel's {floor.resolution:g}",
            field="cell_size",
        )
    if not (is_finite(robot_radius) and robot_radius >= 0):
        raise InputError(f"{shown(robot_radius)}; give metres, 0 or more", field="robot_radius")
    if unknown not in ("blocked", "free"):
        raise InputError(f"{shown(unknown)}; give blocked or free", field="unknown")


def _fits(floor: Occupancy, radius: float, unknown: Unknown) -> Bools:
    """Where a disc of `radius` metres touches nothing, shape of the image."""
    from scipy import ndimage

    free: Bools = floor.state == FREE if unknown == "blocked" else floor.state != OCCUPIED
    if not free.any():
        share = floor.share
        raise InputError(
            f"{unknown}; no pixel is free ({share['unknown']:.1%} unknown, "
            f"{share['occupied']:.1%} occupied); give "
            + ("a map that shows free space" if share["unknown"] == 0 else "free"),
            field="unknown",
        )
    if radius == 0:
        return free
    distance = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
    fits: Bools = distance * floor.resolution > radius
    return fits


def _cells(n_pixels: int, resolution: float, cell_size: float) -> Ints:
    """The cell in which each pixel's centre lies, counted from 0, ``(n_pixels,)``."""
    pixels = np.arange(n_pixels)
    ratio = _ratio(resolution, cell_size)
    return pixels // int(ratio) if ratio.is_integer() else ((pixels + 0.5) / ratio).astype(np.intp)


def _ratio(resolution: float, cell_size: float) -> float:
    """Pixels along a cell's side."""
    ratio = cell_size / resolution
    return float(round(ratio)) if abs(ratio - round(ratio)) < 1e-6 * ratio else ratio


def _labelled(fits: Bools) -> tuple[NDArray[np.int32], int]:
    """The 4-connected regions of pixels, 1 and up, and their number."""
    from scipy import ndimage

    labels = np.empty(fits.shape, np.int32)
    return labels, int(ndimage.label(fits, output=labels))


def _pieces(fits: Bools, rows: Ints, cols: Ints, shape: tuple[int, int]) -> tuple[Bools, Ints]:
    """The pixels of each cell's largest piece, and how many there are, ``(n_rows, n_cols)``.

    Of pieces of the same size the one nearest to the upper left is taken.
    """
    # A row or column of nothing between cells keeps pieces of neighbours apart.
    at_rows, at_cols = np.arange(len(rows)) + rows, np.arange(len(cols)) + cols
    apart = np.zeros((at_rows[-1] + 1, at_cols[-1] + 1), dtype=bool)
    apart[np.ix_(at_rows, at_cols)] = fits
    labels, count = _labelled(apart)
    labels = labels[np.ix_(at_rows, at_cols)]
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    cell = rows[:, None] * shape[1] + cols
    home = np.zeros(count + 1, np.intp)
    home[labels] = cell
    # The last written wins: by size, then by the smaller label.
    order = np.lexsort((-np.arange(1, count + 1), sizes[1:])) + 1
    best = np.zeros(shape[0] * shape[1], np.int32)
    best[home[order]] = order
    chosen = fits & (labels == best[cell])
    size = np.where(best > 0, sizes[best], 0)
    return chosen, size.reshape(shape)


def _links(chosen: Bools, rows: Ints, cols: Ints, shape: tuple[int, int]) -> tuple[Bools, Bools]:
    """Whether a pixel of a cell's piece touches one of the next cell's piece: aside, and below.

    Shapes ``(n_rows, n_cols - 1)`` and ``(n_rows - 1, n_cols)``.
    """
    last_col = np.flatnonzero(np.diff(cols))
    touching = chosen[:, last_col] & chosen[:, last_col + 1]
    aside = np.logical_or.reduceat(touching, _firsts(rows), axis=0)
    last_row = np.flatnonzero(np.diff(rows))
    touching = chosen[last_row] & chosen[last_row + 1]
    below = np.logical_or.reduceat(touching, _firsts(cols), axis=1)
    return aside.reshape(shape[0], shape[1] - 1), below.reshape(shape[0] - 1, shape[1])


def _firsts(cells: Ints) -> Ints:
    """The first pixel of each cell."""
    return np.flatnonzero(np.diff(cells, prepend=-1))


def _without_false_moves(size: Ints, aside: Bools, below: Bools) -> Bools:
    """Free cells of which no two neighbours are unlinked; smaller pieces give way to larger ones."""
    index = np.arange(size.size).reshape(size.shape)
    some = size > 0
    pairs = np.concatenate(
        [
            _pairs(index[:, :-1], index[:, 1:], some[:, :-1] & some[:, 1:] & ~aside),
            _pairs(index[:-1], index[1:], some[:-1] & some[1:] & ~below),
        ]
    )
    rank = np.empty(size.size, np.intp)
    rank[np.lexsort((-index.ravel(), size.ravel()))] = np.arange(size.size)
    free = some.ravel().copy()
    # A cell gives way once it is the smallest of all with which it disagrees.
    while len(open_ := pairs[free[pairs].all(axis=1)]):
        smallest = np.full(size.size, size.size)
        for one, other in (open_.T, open_.T[::-1]):
            np.minimum.at(smallest, one, rank[other])
        free[(rank < smallest) & (smallest < size.size)] = False
    # Then whoever has no free neighbour left to disagree with comes back, the largest first.
    while True:
        waiting = some.ravel() & ~free
        for one, other in (pairs.T, pairs.T[::-1]):
            waiting[one[free[other]]] = False
        if not waiting.any():
            return free.reshape(size.shape)
        largest = np.full(size.size, -1)
        among = pairs[waiting[pairs].all(axis=1)]
        for one, other in (among.T, among.T[::-1]):
            np.maximum.at(largest, one, rank[other])
        free[waiting & (rank > largest)] = True


def _pairs(one: Ints, other: Ints, where: Bools) -> Ints:
    return np.stack([one[where], other[where]], axis=1)


def _region_of(
    chosen: Bools, regions: NDArray[np.int32], rows: Ints, cols: Ints, shape: tuple[int, int]
) -> Ints:
    """The region of the floor in which each cell's piece lies, 0 if it has none."""
    region = np.zeros(shape[0] * shape[1], np.intp)
    at_rows, at_cols = np.nonzero(chosen)
    region[rows[at_rows] * shape[1] + cols[at_cols]] = regions[at_rows, at_cols]
    return region.reshape(shape)


def _largest_parts(free: Bools, region: Ints) -> Bools:
    """Of each region's cells, those of its largest connected part."""
    parts, count = _labelled(free)
    sizes = np.bincount(parts.ravel(), minlength=count + 1)
    region_of = np.zeros(count + 1, np.intp)
    region_of[parts] = region
    order = np.lexsort((-np.arange(1, count + 1), sizes[1:])) + 1
    largest = np.zeros(int(region.max(initial=0)) + 1, np.intp)
    largest[region_of[order]] = order
    kept: Bools = (parts > 0) & (parts == largest[region])
    return kept


def _off_centre(
    kept: Bools, free: Bools, rows: Ints, cols: Ints, resolution: float, cell_size: float
) -> tuple[tuple[int, int, float, float], ...]:
    """The free cells at whose centre no robot stands, and where one does, as `Frame` has it.

    A centre on the border of pixels is among the cell's piece only if all of them are.
    """
    ratio = _ratio(resolution, cell_size)
    up = len(rows) - 0.5 - np.arange(len(rows))  # of the centres of pixels, in pixels
    along = np.arange(len(cols)) + 0.5
    centre_up = (free.shape[0] - 0.5 - np.arange(free.shape[0])) * ratio
    centre_along = (np.arange(free.shape[1]) + 0.5) * ratio
    padded = np.pad(kept, 1)  # what is beyond the image is no piece of it
    at_centre = np.ones_like(free)
    for side in (-1e-6, 1e-6):
        row = np.clip(len(rows) - np.floor(centre_up + side), 0, len(rows) + 1).astype(np.intp)
        for other in (-1e-6, 1e-6):
            col = np.clip(np.floor(centre_along + other) + 1, 0, len(cols) + 1).astype(np.intp)
            at_centre &= padded[np.ix_(row, col)]
    moved = free & ~at_centre
    candidates = kept & moved[np.ix_(rows, cols)]
    from_up, from_along = up - centre_up[rows], along - centre_along[cols]
    # Rounded, so that equal distances stay equal: of such pixels the first is taken, row by row.
    distance = (from_up[:, None] ** 2 + from_along**2).round(6)
    distance[~candidates] = np.inf
    nearest = np.minimum.reduceat(distance, _firsts(rows), axis=0)
    nearest = np.minimum.reduceat(nearest, _firsts(cols), axis=1)
    found: dict[tuple[int, int], tuple[float, float]] = {}
    # A pixel's centre on the border of two cells is kept within its own.
    limit = ratio / 2 * (1 - 1e-6)
    for i, j in np.argwhere(candidates & (distance == nearest[np.ix_(rows, cols)])).tolist():
        offset = np.clip([from_along[j], from_up[i]], -limit, limit) * resolution
        found.setdefault((int(rows[i]), int(cols[j])), tuple(offset.round(9).tolist()))
    return tuple((*cell, *offset) for cell, offset in sorted(found.items()))
