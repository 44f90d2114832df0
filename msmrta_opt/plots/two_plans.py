"""Two plans beside each other: the paths of both, and what another robot serves."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from ..mission.plan import Plan
from .canvas import Scale, panel_size
from .figure import Picture
from .legends import LEGEND_FONT, mark_handle, robot_handles
from .lettering import as_written, shortened
from .paths import plot_paths
from .style import INK, robot_styles


@as_written
def plot_two_plans(before: Plan, after: Plan, *, ringed: Sequence[int] = ()) -> Figure:
    """Draw the paths of two plans side by side.

    Parameters
    ----------
    before, after : Plan
        Robots of the same id have the same colour where both plans are for one mission.
    ringed : sequence of int
        Ids of victims to put a ring around.

    Returns
    -------
    Figure
        Not known to pyplot; `save_figure` writes it, a notebook shows it.
    """
    sizes = [panel_size(p.instance.map) for p in (before, after)]
    width, height = (max(size[i] for size in sizes) for i in (0, 1))
    styles = {**robot_styles(after.instance), **robot_styles(before.instance)}
    columns = min(len(styles) + 1, 8)
    figure = Picture(
        figsize=(2 * (width + 0.7), height + 2.0 + 0.2 * -(-len(styles) // columns)),
        layout="constrained",
    )
    for plan, ax in zip((before, after), figure.subplots(1, 2), strict=True):
        plot_paths(plan, ax, robot_key=False)
        walked = (
            f"{plan.metrics.distance} cells walked, makespan {plan.metrics.makespan:g} time units"
        )
        ax.set_title(f"{shortened(plan.planner, 40)}: {walked}", fontsize=10)
        ax.set_anchor("N")
        cells = [v.cell for v in plan.instance.victims if v.id in ringed]
        size = (2.6 * Scale.of(ax, plan.instance.map).mark) ** 2
        ax.scatter(
            [col for _, col in cells],
            [row for row, _ in cells],
            s=size,
            facecolors="none",
            edgecolors=INK,
            linewidths=1.6,
            linestyles="dotted",
            zorder=3,
        )
    handles = robot_handles(styles)
    if ringed:
        handles.append(mark_handle("o", "another robot serves this victim", edge=INK, face="white"))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns,
        fontsize=LEGEND_FONT + 0.5,
        frameon=False,
    )
    return figure
