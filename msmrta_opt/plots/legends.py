"""Legends below the axes, and their entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import Container
from matplotlib.lines import Line2D
from matplotlib.path import Path

from .figure import size_of
from .lettering import shortened
from .style import FAINT, INK, RobotStyle

LEGEND_FONT = 8.0


def legend_below(
    ax: Axes,
    handles: Sequence[Artist | Container] | None = None,
    *,
    title: str = "",
    clear: float = 0.0,
) -> None:
    """A legend under the axes and its x label, in as many columns as fit; by default of all labels.

    It stays clear of `clear` points more, where names along the axis are turned.
    """
    handles = ax.get_legend_handles_labels()[0] if handles is None else handles
    if not handles:
        return
    longest = max(len(str(handle.get_label())) for handle in handles)
    width, _ = size_of(ax)
    columns = int(np.clip(width // (longest * 0.55 * LEGEND_FONT + 34), 1, len(handles)))
    ax.legend(
        handles=list(handles),
        loc="upper center",
        bbox_to_anchor=(0.5, 0),
        # In font sizes: clears tick labels and the axis label.
        borderaxespad=4.6 + clear / LEGEND_FONT,
        ncols=columns,
        title=title or None,
        title_fontsize=LEGEND_FONT,
        fontsize=LEGEND_FONT,
        frameon=False,
        handlelength=1.8,
        columnspacing=1.4,
    )


def mark_handle(marker: str | Path, label: str, *, face: str = FAINT, edge: str = INK) -> Line2D:
    """A legend entry that shows a marker, or its words alone."""
    return Line2D(
        [],
        [],
        linestyle="",
        marker=marker,
        markersize=8 if isinstance(marker, str) else 13,
        markerfacecolor=face,
        markeredgecolor=edge,
        markeredgewidth=0.6 if isinstance(marker, str) else 0,
        label=shortened(label, 80),
    )


def robot_handles(
    styles: Mapping[int, RobotStyle], words: Mapping[int, str] | None = None
) -> list[Line2D]:
    """Legend entries of robots: ``R0``, or ``R0: …`` with words for them."""
    return [
        Line2D(
            [],
            [],
            color=style.colour,
            linestyle=cast("Any", style.line),
            linewidth=2.2,
            marker=style.mark,
            markersize=7,
            markeredgecolor="white",
            markeredgewidth=0.6,
            label=f"R{robot}: {words[robot]}" if words else f"R{robot}",
        )
        for robot, style in styles.items()
    ]
