"""An assignment as a heat map: who could take what at which value, the choice, duals in the margins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from ...mission.errors import InputError
from ...optimise.program import Block, Program
from ...optimise.solution import Solution
from ...plots.figure import own_axes
from ...plots.legends import legend_below
from ...plots.lettering import as_written, name_ticks, shortened, width_of
from ...plots.style import FAINT, INK, SERIES, readable_on

VALUED = 24
"""Up to so many things along a side, each cell tells its value."""
COLOURS = colormaps["cividis"]
MAX_NAMED = 40
"""Names along a side."""
IMPOSSIBLE = "#EEEEEE"


@as_written
def plot_solution(program: Program, solution: Solution, ax: Axes | None = None) -> Axes:
    """Draw the coefficients of a stage's assignment in the objective, and what was chosen.

    Parameters
    ----------
    program : Program
        For instance of ``mo.program("cluster_one_to_one", data)``.
    solution : Solution
        Of the same formulation, parameters and data.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Who takes on y, what is taken on x, by id. A cell has its coefficient in the objective; the
        chosen ones are outlined; what is impossible is pale and crossed. In the margins are the dual
        values of the constraints over one side, where the solution has any.

    Raises
    ------
    InputError
        If the formulation has no 0-1 variable over two axes, or there is no solution.
    """
    solution.require()
    block = assignment_of(program)
    values, possible, where = coefficients(program, block)
    chosen = np.asarray(solution.values[block.name]) > 0.5
    rows, columns = block.ids
    ax = own_axes(
        2.9 + float(np.clip(0.5 * len(columns), 2.2, 9)),
        2.4 + float(np.clip(0.34 * len(rows), 1.2, 8)),
    ) if ax is None else ax  # fmt: skip
    known = values[possible]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    norm = Normalize(low, high if high > low else low + 1)
    image = COLOURS(norm(values))
    image[~possible] = (*(int(IMPOSSIBLE[i : i + 2], 16) / 255 for i in (1, 3, 5)), 1.0)
    ax.imshow(image, aspect="auto", interpolation="none")
    small = max(values.shape) <= VALUED
    for i, j in np.ndindex(values.shape):
        if small:
            text = f"{values[i, j]:.4g}" if possible[i, j] else "×"
            ink = readable_on(image[i, j, :3]) if possible[i, j] else FAINT
            ax.text(j, i, text, ha="center", va="center_baseline", fontsize=7, color=ink)
        if chosen[i, j]:
            ax.add_patch(
                Rectangle((j - 0.46, i - 0.46), 0.92, 0.92, fill=False, ec="white", lw=3.4)
            )
            ax.add_patch(Rectangle((j - 0.46, i - 0.46), 0.92, 0.92, fill=False, ec=INK, lw=1.8))
    duals = margins(program, solution, block)
    _name(ax, block, duals)
    parameters = ", ".join(f"{name} = {x:g}" for name, x in solution.parameters.items())
    ax.set_title(
        f"{block.name} of {solution.formulation}{f' ({parameters})' if parameters else ''}: "
        f"{solution.status}, "
        f"{solution.sense} {solution.objective:.6g}",
        fontsize=10,
    )
    handles = [
        Patch(fc=COLOURS(0.5), ec=INK, lw=1.8, label="chosen"),
        Patch(fc=COLOURS(0.0), label=f"{low:.4g} in {shortened(where, 44)}"),
        Patch(fc=COLOURS(1.0), label=f"{high:.4g}"),
    ]
    if not possible.all():
        handles.append(Patch(fc=IMPOSSIBLE, label="× impossible"))
    said = dict.fromkeys(label for side in duals for label, _ in side)
    handles += [Patch(fc="none", ec="none", label=f"dual: {shortened(name, 52)}") for name in said]
    turned = max(width_of(str(name), 7.5) for name in columns) if _turned(columns) else 0.0
    legend_below(ax, handles, clear=max(turned - 12, 0.0))
    return ax


def assignment_of(program: Program) -> Block:
    """The first 0-1 variable over two named axes.

    Raises
    ------
    InputError
        If there is none.
    """
    for block in program.columns:
        own = slice(block.start, block.stop)
        is_binary = program.integer[own].all() and (program.upper[own] <= 1).all()
        if is_binary and len(block.shape) == 2 and all(block.nouns) and len(block.ids) == 2:
            return block
    names = ", ".join(f"{block.name} over {len(block.shape)} axes" for block in program.columns)
    raise InputError(
        f"there is no 0-1 variable over two axes, only {names or 'none with a name'}; "
        "give a formulation that assigns one thing to another",
        field="formulation",
    )


def coefficients(
    program: Program, block: Block
) -> tuple[NDArray[np.float64], NDArray[np.bool_], str]:
    """What each choice is worth, whether it can be made, and what it is worth it in.

    That is its coefficient in the objective. Where all are 0, since the objective is of another
    variable, it is what it adds to the constraints with that variable. Arrays of the block's shape.
    """
    own = slice(block.start, block.stop)
    values, where = program.cost[own], "the objective"
    if not values.any() and program.cost.any():
        columns = program.matrix.tocsc()
        rows = np.unique(columns[:, np.flatnonzero(program.cost)].tocoo().row)
        values = np.abs(program.matrix[rows][:, own]).sum(axis=0)
        names = [item.words for item in program.rows if np.any(_within(item, rows))]
        where = f"'{', '.join(names)}'" if names else where
    possible = (program.upper[own] > 0.5).reshape(block.shape, order="F")
    shaped = np.asarray(values, dtype=float).reshape(block.shape, order="F")
    return shaped, possible, where


def _within(block: Block, positions: NDArray[np.int64]) -> NDArray[np.bool_]:
    return np.asarray((positions >= block.start) & (positions < block.stop))


Margin = list[tuple[str, NDArray[np.float64]]]


def margins(program: Program, solution: Solution, block: Block) -> tuple[Margin, Margin]:
    """The dual values of constraints over the block's first axis alone, and its second, by label."""
    found: tuple[Margin, Margin] = ([], [])
    for row in program.rows:
        dual = solution.duals.get(row.name)
        if dual is None or len(row.shape) != 1:
            continue
        for side, letter in enumerate(block.letters):
            if row.letters == (letter,) and row.size == block.shape[side]:
                found[side].append((row.words, np.asarray(dual, dtype=float)))
                break
    return found


def _every(n: int) -> range:
    """Which of `n` places are named: all, or of many one in so many."""
    return range(0, n, -(-n // MAX_NAMED))


def _turned(names: Sequence[object]) -> bool:
    """Whether names along x are turned to fit."""
    return len(names) > VALUED // 2 or max(len(str(name)) for name in names) > 4


def _name(ax: Axes, block: Block, duals: tuple[Margin, Margin]) -> None:
    """Ids and nouns at the near sides, the margins of dual values at the far ones."""
    (rows, columns), (row_noun, column_noun) = block.ids, block.nouns
    every = [_every(len(ids)) for ids in (rows, columns)]
    name_ticks(ax.yaxis, every[0], [rows[i] for i in every[0]], fontsize=7.5)
    name_ticks(ax.xaxis, every[1], [columns[i] for i in every[1]], fontsize=7.5)
    if _turned(columns):
        ax.tick_params(axis="x", rotation=90)
    ax.set_ylabel(row_noun, fontsize=8)
    ax.set_xlabel(column_noun, fontsize=8)
    ax.tick_params(length=2)
    for side, found in enumerate(duals):
        if not found:
            continue
        places = every[side]
        texts = [
            "\n".join(f"{round(float(dual[i]), 9) + 0.0:.4g}" for _, dual in found) for i in places
        ]
        far = ax.secondary_yaxis("right") if side == 0 else ax.secondary_xaxis("top")
        (far.set_yticks if side == 0 else far.set_xticks)(
            places, texts, fontsize=7, color=SERIES[1]
        )
        far.tick_params(length=2, rotation=90 if side and len(columns) > VALUED // 2 else 0)
        (far.set_ylabel if side == 0 else far.set_xlabel)("dual", fontsize=7.5, color=SERIES[1])
