"""Pictures of trade-offs: the optimal value over ψ or β, the front, who takes what, and both at once.

Every ``plot_x(..., ax=None)`` draws into the axes it is given, or into a figure of its own, and
returns the axes; `tradeoff_pages` composes them.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from ...mission.errors import InputError
from ...mission.metrics import METRICS
from ...plots.figure import own_axes, size_of
from ...plots.legends import legend_below
from ...plots.lettering import as_written, width_of
from ...plots.style import FAINT, INK, SERIES, readable_on, robot_colour
from .tradeoff_results import Region, Regions, Tradeoff

VALUE, FIRST, SECOND = SERIES
SYMBOL = {"psi": "ψ", "beta": "β"}
NAME = {
    "psi": "ψ (importance of full over partial satisfaction)",
    "beta": "β (importance of failure time over success time)",
}
"""What the parameters are called on every axis."""
UNIT = {"psi": "requirements", "beta": "time units"}
OBJECTIVES = {
    "psi": ("requirements met", "requirements met of fully satisfied victims"),
    "beta": ("success time", "failure time"),
}
MAX_NAMED = 12
"""Breakpoints that are named one by one; of more, the names would overlap."""
NAME_FONT, SMALL = 7.5, 8.0
LEADER = 5.0
"""Points between the axes and the names of breakpoints, crossed by a line to each."""


@as_written
def plot_value(result: Tradeoff, ax: Axes | None = None) -> Axes:
    """The optimal value over the parameter, its breakpoints, and the two objectives it weighs.

    Parameters
    ----------
    result : Tradeoff
        Over one parameter.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        The parameter on x; the value on y, in requirements (ψ) or time units (β).
    """
    ax = own_axes(6.5, 4.2) if ax is None else ax
    ends = np.array([(float(s.low), float(s.high)) for s in result.segments])
    edges = np.append(ends[:, 0], ends[-1, 1])
    for which, (colour, line) in enumerate(((FIRST, "--"), (SECOND, ":"))):
        steps = np.array([float(s.objectives[which]) for s in result.segments])
        label = f"{_objectives(result)[which]} of the optimum"
        ax.stairs(
            steps, edges, baseline=None, color=colour, linestyle=line, linewidth=1.8, label=label
        )
    corners = [*(s.low for s in result.segments), result.segments[-1].high]
    values = [float(result.at(t).value(t)) for t in corners]
    ax.plot([float(t) for t in corners], values, color=VALUE, linewidth=2.2, label="optimal value")
    ax.plot(
        edges[1:-1], values[1:-1], "o", color="white", markeredgecolor=VALUE, markeredgewidth=1.6,
        label="breakpoint",
    )  # fmt: skip
    ax.set_ylabel(f"objective{_unit(result)}", fontsize=SMALL)
    _parameter_axis(ax, result)
    ax.set_title(f"Optimal value, {_count(result)}", fontsize=10)
    legend_below(ax)
    return ax


@as_written
def plot_changes(result: Tradeoff, ax: Axes | None = None) -> Axes:
    """How the two objectives of the optimum change from where the parameter is 0.

    On a scale of their own, on which changes that are small beside the objectives are seen.

    Returns
    -------
    Axes
        The parameter on x; the change on y, in requirements (ψ) or time units (β).
    """
    ax = own_axes(6.5, 4.2) if ax is None else ax
    edges = [*(float(s.low) for s in result.segments), float(result.segments[-1].high)]
    start = f"{symbol_of(result)} = {float(result.span[0]):g}"
    for which, (colour, line) in enumerate(((FIRST, "--"), (SECOND, ":"))):
        steps = np.array([float(s.objectives[which]) for s in result.segments])
        ax.stairs(
            steps - steps[0], edges, baseline=None, color=colour, linestyle=line, linewidth=2.2,
            label=f"{_objectives(result)[which]}, {steps[0]:.6g} at {start}",
        )  # fmt: skip
    ax.margins(y=0.15)
    ax.set_ylabel(f"change{_unit(result)}", fontsize=SMALL)
    _parameter_axis(ax, result)
    ax.set_title(f"Change of the objectives since {start}", fontsize=10)
    legend_below(ax)
    return ax


@as_written
def plot_front(result: Tradeoff, ax: Axes | None = None) -> Axes:
    """The points that nothing dominates: those that a weight reaches, and those that none does.

    Returns
    -------
    Axes
        The two objectives, in requirements (ψ) or time units (β).
    """
    ax = own_axes(5.5, 4.2) if ax is None else ax
    groups: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
    for point in result.frontier.points:
        groups[point.supported].append((float(point.line.at_zero), float(point.line.at_one)))
    supported = np.array(groups[True]).reshape(-1, 2)
    ax.plot(
        *supported.T, color=FAINT, linewidth=1, zorder=1, label="weighted sums reach up to here"
    )
    ax.plot(
        *supported.T, "o", color=VALUE, markersize=8,
        label=f"reached by a {symbol_of(result)} ({len(supported)})",
    )  # fmt: skip
    if groups[False]:
        behind = np.array(groups[False])
        ax.plot(
            *behind.T, "D", color="white", markeredgecolor=SECOND, markersize=6,
            markeredgewidth=1.5, label=f"reached by no {symbol_of(result)} ({len(behind)})",
        )  # fmt: skip
    first, second = _objectives(result)
    unit = f" ({UNIT[result.over]})" if result.over == "beta" else ""
    better = "more" if result.sense == "max" else "less"
    width, height = (0.24 * points for points in size_of(ax))
    for say, words, room in ((ax.set_xlabel, first, width), (ax.set_ylabel, second, height)):
        say(textwrap.fill(f"{words}{unit}; {better} is better", max(int(room), 18)), fontsize=SMALL)
    ax.margins(0.12)
    cut = "" if result.frontier.complete else ", cut short"
    ax.set_title(f"Points that nothing dominates{cut}", fontsize=10)
    ax.grid(alpha=0.3)
    ax.tick_params(labelsize=SMALL)
    legend_below(ax)
    return ax


@as_written
def plot_bands(result: Tradeoff, ax: Axes | None = None) -> Axes:
    """Per robot a band over the parameter: which cluster, or which victims, it takes.

    A band has its robot's colour; where its shade changes, so does what the robot takes.
    """
    robots = result.segments[0].plan.instance.robots
    ax = own_axes(8, 1.2 + 0.32 * len(robots)) if ax is None else ax
    points, _ = size_of(ax)
    for row in range(len(robots)):
        for number, (low, high, name) in enumerate(_runs(result, row)):
            width = float(high - low)
            ax.broken_barh(
                [(float(low), width)], (row - 0.38, 0.76), edgecolor="white", linewidth=1.2,
                facecolor=(robot_colour(row), (0.6, 0.3)[number % 2]) if name else "#EDEDED",
            )  # fmt: skip
            text = name or "nothing"
            if width_of(text, SMALL) + 6 <= width * points:
                ax.text(
                    float(low) + width / 2, row, text, ha="center", va="center_baseline",
                    fontsize=SMALL, color="black",
                )  # fmt: skip
    ax.set_yticks(range(len(robots)), [f"R{robot.id}" for robot in robots], fontsize=SMALL)
    ax.set_ylim(len(robots) - 0.5, -0.5)
    ax.set_ylabel("robot", fontsize=SMALL)
    _parameter_axis(ax, result)
    what = result.stage
    ax.set_title(f"Which {what} each robot takes", fontsize=10)
    return ax


@as_written
def plot_regions(regions: Regions, ax: Axes | None = None, *, metric: str = "distance") -> Axes:
    """The ψ × β square, each region coloured by a metric of its plan and numbered by its plan.

    Parameters
    ----------
    regions : Regions
        Of the whole square.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    metric : str
        One of `mission.metrics.METRICS`.

    Raises
    ------
    InputError
        If there is no such metric.
    """
    if metric not in METRICS:
        raise InputError(f"{metric!r}; give one of {', '.join(METRICS)}", field="metric")
    ax = own_axes(5.4, 4.4) if ax is None else ax
    values = [float(getattr(region.plan.metrics, metric)) for region in regions.regions]
    spread = max(values) - min(values)
    norm = Normalize(min(values), max(values) if spread else min(values) + 1)
    scale = ax.figure.colorbar(_scale(norm), ax=ax)
    scale.set_label(METRICS[metric].title, fontsize=SMALL)
    scale.ax.tick_params(labelsize=SMALL)
    if not spread:
        scale.set_ticks([min(values)])
    number = numbers_of(regions)
    for region, value in zip(regions.regions, values, strict=True):
        _draw_region(ax, region, scale.cmap(norm(value)), str(number[region.plan.routes]))
    ax.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    ax.set_xlabel(NAME["psi"], fontsize=SMALL)
    ax.set_ylabel(textwrap.fill(NAME["beta"], 34), fontsize=SMALL)
    ax.tick_params(labelsize=SMALL)
    ax.set_title(METRICS[metric].label.capitalize(), fontsize=10)
    return ax


def _runs(result: Tradeoff, row: int) -> Iterator[tuple[Fraction, Fraction, str]]:
    """Longest intervals over which one robot takes the same."""
    named = [(s, result.named(s.assignment)[row]) for s in result.segments]
    for name, run in groupby(named, key=lambda item: item[1]):
        pieces = [segment for segment, _ in run]
        yield pieces[0].low, pieces[-1].high, name


def _parameter_axis(ax: Axes, result: Tradeoff) -> None:
    """The parameter on x, with its breakpoints as lines, named on top."""
    ax.set_xlim(*map(float, result.span))
    ax.set_xlabel(NAME.get(result.over, result.over), fontsize=SMALL)
    ax.tick_params(labelsize=SMALL)
    for t in result.breakpoints:
        ax.axvline(float(t), color=FAINT, linewidth=0.8, linestyle="--", zorder=0.5)
    if 0 < len(result.breakpoints) <= MAX_NAMED:
        _name_breakpoints(ax, result.breakpoints)


def _name_breakpoints(ax: Axes, breakpoints: Sequence[Fraction]) -> None:
    """Names above the axes: upright where they fit side by side, else turned and moved apart."""
    names = [short(t) for t in breakpoints]
    width, _ = size_of(ax)
    places = np.array([float(t) for t in breakpoints])
    room = (0.62 * max(map(len, names)) + 1) * NAME_FONT / width
    turned = bool(np.any(np.diff(places) < room))
    spots = apart(places, 1.35 * NAME_FONT / width) if turned else places
    upper = ax.secondary_xaxis("top")
    upper.set_xticks(spots, names, fontsize=NAME_FONT, rotation=90 if turned else 0)
    upper.tick_params(length=0, pad=LEADER + 1)
    for place, spot in zip(places, spots, strict=True):
        ax.annotate(
            "",
            (place, 1),
            xycoords=("data", "axes fraction"),
            xytext=((spot - place) * width, LEADER),
            textcoords="offset points",
            arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.7, "shrinkA": 0, "shrinkB": 0},
        ).set_in_layout(False)


def apart(places: NDArray[np.float64], minimum: float) -> NDArray[np.float64]:
    """Ascending places, moved as little as can be (least squares) to be `minimum` apart."""
    steps = minimum * np.arange(len(places))
    return np.asarray(isotonic_regression(places - steps).x + steps, dtype=np.float64)


def _draw_region(ax: Axes, region: Region, colour: tuple[float, ...], text: str) -> None:
    (left, right), (low, high) = region.psi, region.beta
    width, height = float(right - left), float(high - low)
    named = min(width, height) > 0.05
    ax.add_patch(
        Rectangle(
            (float(left), float(low)), width, height, facecolor=colour, edgecolor="white",
            linewidth=1, hatch="" if region.unique or named else "....",
        )
    )  # fmt: skip
    if named:
        ax.text(
            float(left) + width / 2, float(low) + height / 2, text if region.unique else f"{text}*",
            ha="center", va="center_baseline", fontsize=SMALL, color=readable_on(colour),
        )  # fmt: skip


def numbers_of(regions: Regions) -> dict[object, int]:
    """Plans by what their robots do, numbered from 1 in the order of the regions."""
    return {plan.routes: i for i, plan in enumerate(regions.plans, start=1)}


def _scale(norm: Normalize) -> ScalarMappable:
    return ScalarMappable(norm, "cividis")


def short(t: Fraction) -> str:
    """A fraction where it is short, else a decimal."""
    return str(t) if t.denominator <= 10_000 else f"{float(t):.6g}"


def _count(result: Tradeoff) -> str:
    n = len(result.breakpoints)
    return f"{n} breakpoint{'' if n == 1 else 's'}"


def symbol_of(result: Tradeoff) -> str:
    """ψ or β, or a formulation's own parameter by its name."""
    return SYMBOL.get(result.over, result.over)


def _unit(result: Tradeoff) -> str:
    return f" ({UNIT[result.over]})" if result.over in UNIT else ""


def _objectives(result: Tradeoff) -> tuple[str, str]:
    """The two that the parameter weighs: those of a formulation's own, by the ends of its range."""
    low, high = (f"objective at {result.over} = {float(end):g}" for end in result.span)
    return OBJECTIVES.get(result.over, (low, high))
