"""The matrix of a program: rows by label, columns by variable, coloured by what its structure proves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...arrays import Ints
from ...optimise.program import Block, Program
from ...optimise.structure import Structure, recognise
from ...plots.figure import own_axes
from ...plots.legends import legend_below
from ...plots.lettering import as_written, name_ticks, shortened, width_of
from ...plots.style import FAINT, INK, PALETTE, readable_on

NAMED = 40
"""Up to so many rows, or columns, each has its name; of more their blocks have."""
VALUED = 24
"""Up to so many columns, entries tell their coefficients."""
MAX = 1500
"""Dots along a side; of a larger matrix several entries share one."""
OUTSIDE = "#C9CCD1"
CLASSES = {
    "bipartite": (
        ("rows of the one kind", PALETTE[0]),
        ("rows of the other kind", PALETTE[1]),
        ("rows with every column", PALETTE[3]),
    ),
    "network": (("+1", PALETTE[0]), ("−1", PALETTE[1])),
    "interval": (("consecutive ones", PALETTE[0]), ("−1", PALETTE[1])),
    "": (("+1", PALETTE[0]), ("−1", PALETTE[1]), ("neither +1 nor −1", PALETTE[6])),
}
"""By kind of structure, what the classes of entries are called, and their colours."""


@as_written
def plot_matrix(program: Program, ax: Axes | None = None) -> Axes:
    """Draw the entries of a program's matrix that are not zero.

    Parameters
    ----------
    program : Program
        For instance of ``mo.program("cluster_one_to_one", data)``.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Columns on x, in blocks by variable; rows on y, in blocks by label, the first on top. Entries
        are coloured by what the proof of structure says of their rows, or of their signs; those that
        it leaves out, in rows of one entry and in fixed columns, are grey.
    """
    n, m = program.n_rows, program.n_columns
    ax = own_axes(9.0, 2.2 + float(np.clip(0.2 * n, 1.2, 6.5))) if ax is None else ax
    structure = recognise(program)
    row, column, value = _entries(program)
    kind = structure.kind if structure else ""
    classes = classified(program, structure)
    names = CLASSES[kind]
    colours = np.array([*(to_rgb(colour) for _, colour in names), to_rgb(OUTSIDE)])
    step = (-(-n // MAX), -(-m // MAX))
    image = np.ones((max(-(-n // step[0]), 1), max(-(-m // step[1]), 1), 3))
    image[row // step[0], column // step[1]] = colours[classes]
    ax.imshow(
        image, aspect="auto", interpolation="none" if max(n, m) <= 400 else "antialiased",
        extent=(-0.5, m - 0.5, n - 0.5, -0.5),
    )  # fmt: skip
    if m <= VALUED and n <= NAMED:
        for r, c, a, k in zip(row, column, value, classes, strict=True):
            ax.text(
                c, r, f"{a:.3g}", ha="center", va="center_baseline", fontsize=6.5,
                color=readable_on(colours[k]),
            )  # fmt: skip
    _name_side(ax, program.rows, n, [program.row_name(i) for i in range(min(n, NAMED + 1))], "y")
    _name_side(
        ax, program.columns, m, [program.column_name(i) for i in range(min(m, NAMED + 1))], "x"
    )
    ax.tick_params(length=2, labelsize=7)
    proved = structure.description if structure else "no structure recognised"
    ax.set_title(f"{n} rows × {m} columns, {program.matrix.nnz} entries\n{proved}", fontsize=9.5)
    present = set(np.unique(classes).tolist())
    handles = [Patch(fc=c, label=name) for i, (name, c) in enumerate(names) if i in present]
    if len(names) in present:
        handles.append(Patch(fc=OUTSIDE, label="bounds and fixed columns, left out of the proof"))
    columns = [program.column_name(i) for i in range(m)] if m <= NAMED else []
    turned = max((width_of(shortened(name), 7) for name in columns), default=0.0)
    legend_below(ax, handles, clear=max(turned - 12, 0.0))
    return ax


def classified(program: Program, structure: Structure | None) -> Ints:
    """The class of each entry, in the order of the matrix; the last is of those left out.

    Positions in `CLASSES`, shape ``(n_entries,)``.
    """
    row, column, value = _entries(program)
    sign = np.where(value == 1, 0, np.where(value == -1, 1, 2))
    if structure is None:
        return sign.astype(np.int64)
    core, outside = structure.core, len(CLASSES[structure.kind])
    of_row = np.full(program.n_rows, -1)
    of_row[core.rows] = np.arange(len(core.rows))
    inside = np.zeros(program.n_columns, dtype=bool)
    inside[core.columns] = True
    side = structure.side
    found = sign if side is None else np.append(side, 0)[of_row[row]]
    left_out = (of_row[row] < 0) | ~inside[column]
    return np.where(left_out, outside, found).astype(np.int64)


def _entries(program: Program) -> tuple[Ints, Ints, NDArray[np.float64]]:
    """Row, column and value of each entry that is not zero, row by row."""
    entries = program.matrix.tocoo()
    order = np.lexsort((entries.col, entries.row))
    order = order[entries.data[order] != 0]
    return entries.row[order], entries.col[order], entries.data[order]


def _name_side(ax: Axes, blocks: Sequence[Block], n: int, names: Sequence[str], side: str) -> None:
    """Names of all places, or of blocks in their middle; lines between blocks."""
    axis = ax.yaxis if side == "y" else ax.xaxis
    line = ax.axhline if side == "y" else ax.axvline
    for block in blocks[1:]:
        line(block.start - 0.5, color=INK, linewidth=0.7)
    if n <= NAMED:
        name_ticks(axis, range(n), names)
        if side == "x":
            ax.tick_params(axis="x", rotation=90)
        for place in range(1, n):
            line(place - 0.5, color=FAINT, linewidth=0.15, zorder=1.5)
        return
    # Of neighbours that are too near to be named both, the larger.
    kept: list[Block] = []
    for block in sorted(blocks, key=lambda block: -block.size):
        middle = _middle(block)
        if all(abs(middle - _middle(other)) > n / (28 if side == "y" else 6) for other in kept):
            kept.append(block)
    said = [f"{shortened(block.words)} ({block.size})" for block in kept]
    name_ticks(axis, [_middle(block) for block in kept], said)


def _middle(block: Block) -> float:
    return (block.start + block.stop - 1) / 2
