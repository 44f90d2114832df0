"""Clusters of victims on a map: their outline, their centre, and who took them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from ..mission.grid import Cell
from ..mission.plan import Cluster, Plan
from .canvas import Scale
from .lettering import width_of
from .placing import Box, free_spot
from .style import INK, NOBODY, STAGES, RobotStyle, robot_styles

MARGIN = 0.72
"""Cells by which an outline stays clear of the centres of its victims' cells."""
LABEL = 2.2
"""Height of a name in font sizes, with what keeps it clear of captions if the layout, which comes
later, makes cells smaller."""


def outline(cells: Sequence[Cell]) -> NDArray[np.float64]:
    """The convex hull of discs around `cells`, as ``(col, row)`` points, shape ``(n, 2)``.

    Discs make a hull of any number of cells, in line or not.
    """
    from scipy.spatial import ConvexHull

    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    disc = MARGIN * np.column_stack([np.cos(turn), np.sin(turn)])
    centres = np.array(cells, dtype=float)[:, ::-1]
    points = (centres[:, None] + disc).reshape(-1, 2)
    corners: NDArray[np.float64] = points[ConvexHull(points).vertices]
    return corners


def govern(plan: Plan) -> bool:
    """Whether clusters still say who serves whom: not once a search has improved what they gave."""
    stages = {visit.stage for route in plan.routes for visit in route.visits}
    return bool(plan.clusters) and (not stages or not stages.isdisjoint(STAGES))


def draw_outlines(ax: Axes, plan: Plan) -> None:
    """Draw the outline of each cluster in the colour of the robot that took it."""
    styles = robot_styles(plan.instance)
    cell_of = {victim.id: victim.cell for victim in plan.instance.victims}
    for cluster in plan.clusters:
        if not cluster.victims:
            continue
        corners = outline([cell_of[victim] for victim in cluster.victims])
        colour = _colour(cluster, styles)
        ax.add_patch(Polygon(corners, fc=colour, ec="none", alpha=0.16, zorder=1))
        ax.add_patch(Polygon(corners, fc="none", ec=colour, lw=0.9, alpha=0.8, zorder=1.1))


def draw_centres(ax: Axes, plan: Plan, scale: Scale, taken: Sequence[Box]) -> None:
    """Mark the mean of each cluster and name it, with who took it, where nothing of `taken` is."""
    styles = robot_styles(plan.instance)
    occupied = list(taken)
    for number, cluster in enumerate(plan.clusters):
        row, col = cluster.centre
        colour = _colour(cluster, styles)
        ax.plot(col, row, "P", ms=5, mfc=colour, mec="white", mew=0.6, zorder=4.5)
        takers = ",".join(f"R{robot}" for robot in cluster.robots)
        name = f"C{number}→{takers}" if takers else f"C{number}"
        letters = width_of(name, scale.font) + 0.8 * scale.font
        size = (LABEL * scale.font / scale.cell, letters / scale.cell)
        own = (row, col, 5 / scale.cell, 5 / scale.cell)
        spot = free_spot((row, col), size, [*occupied, own], plan.instance.map.shape)
        occupied.append((*spot, *size))
        ax.plot([col, spot[1]], [row, spot[0]], color=colour, lw=0.8, zorder=4.4)
        ax.text(
            spot[1], spot[0], name, ha="center", va="center_baseline", fontsize=scale.font,
            color=INK, zorder=8,
            bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": colour, "lw": 1.0},
        ).set_in_layout(False)  # fmt: skip


def _colour(cluster: Cluster, styles: dict[int, RobotStyle]) -> str:
    return styles[cluster.robots[0]].colour if cluster.robots else NOBODY
