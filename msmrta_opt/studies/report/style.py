"""Pictures that follow the page's colour scheme."""

from __future__ import annotations

import io
from types import MappingProxyType

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plots.saving import FORMATS
from ...plots.style import INK

PAPER = "#FFFFFF"
GRID = "#C8C8C8"
ON_DARK = MappingProxyType(
    {
        INK: "#E4E6E8",
        PAPER: "#1B1E22",
        GRID: "#4A4F55",
        # Colours of contenders that cannot be seen on a dark ground, lightened.
        "#0072B2": "#3B95D6",
        "#009E73": "#1DB98C",
        "#882255": "#C2568B",
        "#332288": "#8F80E6",
        "#661100": "#BF6A52",
    }
)
"""What becomes of a colour where the reader prefers a dark page."""


def own_axes(width: float = 6.0, height: float = 4.2) -> tuple[Figure, Axes]:
    """A figure with one pair of axes, in the report's colours; inches."""
    figure = Figure(figsize=(width, height), layout="constrained", facecolor=PAPER)
    ax = figure.subplots()
    ax.set_facecolor(PAPER)
    for spine in ax.spines.values():
        spine.set_color(INK)
    ax.tick_params(which="both", colors=INK)
    for text in (ax.xaxis.label, ax.yaxis.label, ax.title):
        text.set_color(INK)
    ax.grid(color=GRID, linewidth=0.6)
    ax.set_axisbelow(True)
    return figure, ax


def add_legend(figure: Figure, ax: Axes) -> None:
    """A legend below the axes: it hides no data, however many entries it has."""
    handles, labels = ax.get_legend_handles_labels()
    columns = 2 if len(labels) > 4 and max(map(len, labels)) < 32 else 1
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        fontsize=9,
        labelcolor=INK,
    )


def svg(figure: Figure) -> str:
    """`figure` as SVG without anything from elsewhere, dark where the reader prefers that.

    The same figure gives the same text.
    """
    out = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "msmrta_opt", "svg.fonttype": "path"}):
        figure.savefig(out, format="svg", metadata=dict(FORMATS["svg"]))
    text = out.getvalue()
    text = text[text.index("<svg") :]
    light, dark = [], []
    for number, (colour, other) in enumerate(ON_DARK.items()):
        text = text.replace(colour.lower(), f"var(--c{number})")
        light.append(f"--c{number}:{colour}")
        dark.append(f"--c{number}:{other}")
    style = (
        f"<style>:root{{{';'.join(light)}}}"
        f"@media (prefers-color-scheme:dark){{:root{{{';'.join(dark)}}}}}</style>"
    )
    start = text.index(">") + 1
    return text[:start] + style + text[start:]
