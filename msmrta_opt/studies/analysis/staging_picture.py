"""A picture of what staging costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from ...plots.figure import own_axes
from ...plots.legends import legend_below
from ...plots.lettering import as_written, name_ticks
from ...plots.style import STEPS
from .staging import Loss


@as_written
def staging_losses(
    priced: Mapping[str, Sequence[Loss]], objective: str, ax: Axes | None = None
) -> Axes:
    """Per mission a bar: what a staged plan needs at best, and what each stage adds.

    Parameters
    ----------
    priced : mapping of str to sequence of Loss
        What `price_of_staging` finds, by the mission's name.
    objective : str
        What was priced.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        The objective on x, in time units; a row per mission.
    """
    ax = own_axes(9, 1.9 + 0.35 * len(priced)) if ax is None else ax
    priced = {name: losses for name, losses in priced.items() if losses}
    for row, losses in enumerate(priced.values()):
        left = losses[-1].after
        needed = "needed even if nothing is staged" if not row else ""
        ax.barh(row, left, color="#D9D9D9", edgecolor="white", label=needed)
        for i, item in enumerate(reversed(losses)):
            label = f"lost by {item.stage}" if not row else ""
            colour = STEPS[i % len(STEPS)]
            ax.barh(row, item.loss, left=left, color=colour, edgecolor="white", label=label)
            left += item.loss
        ax.text(left, row, f" {left:.1f}", va="center")
    name_ticks(ax.yaxis, range(len(priced)), priced)
    ax.invert_yaxis()
    ax.set_xlabel(f"{objective.replace('_', ' ')} (time units)")
    ax.set_title("What each stage of the staged plan costs", fontsize=10)
    ax.margins(x=0.12)
    legend_below(ax)
    return ax
