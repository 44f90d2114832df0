"""The picture of failures: what share of each contender's runs came to what."""

from __future__ import annotations

import pandas as pd

from ...plots.lettering import name_ticks, told_apart
from ...plots.style import INK, PALETTE
from ..record import FINISHED
from .blocks import Picture
from .runs import contenders
from .style import PAPER, add_legend, own_axes

COLOURS = {
    FINISHED: PALETTE[2],
    "timed out": PALETTE[4],
    "out of memory": PALETTE[3],
    "raised": PALETTE[1],
    "crashed": PALETTE[6],
    "skipped": "#9A9A9A",
}
HATCHES = {FINISHED: "", "timed out": "///", "out of memory": "...", "raised": "xxx"}


def outcome_picture(runs: pd.DataFrame) -> Picture:
    """Bars of the outcomes of each contender's runs, finished first."""
    names = contenders(runs)
    counts = pd.crosstab(runs["contender"], runs["outcome"]).reindex(names)
    order = [FINISHED, *(name for name in COLOURS if name != FINISHED), *sorted(counts)]
    counts = counts[[name for name in dict.fromkeys(order) if name in counts]]
    shares = 100 * counts.div(counts.sum(axis="columns"), axis="index")
    figure, ax = own_axes(5.6, 1.5 + 0.34 * len(names))
    left = pd.Series(0.0, index=names)
    for name in shares:
        ax.barh(
            range(len(names)), shares[name], left=left, height=0.7, label=name,
            color=COLOURS.get(name, PALETTE[5]), hatch=HATCHES.get(name, "\\\\\\"),
            edgecolor=PAPER, linewidth=0.5,
        )  # fmt: skip
        left += shares[name]
    name_ticks(ax.yaxis, range(len(names)), told_apart(names).values(), color=INK)
    ax.invert_yaxis()
    ax.set_xlim(0, 100)
    ax.set_xlabel("runs (%)")
    add_legend(figure, ax)
    failed = shares.drop(columns=FINISHED, errors="ignore").sum(axis="columns")
    return Picture(
        "outcome-shares",
        "What the runs came to",
        "Share of each contender's runs, by outcome.",
        "Bars of outcomes; without result: "
        + ", ".join(f"{share:.0f} % of {name}" for name, share in failed.items()),
        figure,
        counts.rename_axis(columns=None).reset_index(),
    )
