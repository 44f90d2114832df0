"""Pictures of trade-offs: the optimal value over ψ or β, the front, who takes what, and both at once.

Every ``plot_x(..., ax=None)`` draws into the axes it is given, or into a figure of its own, and
returns the axes; `tradeoff_figure` and `regions_figure` compose them and return the figure.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import groupby, pairwise, zip_longest
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from ...mission.errors import InputError
from ...mission.metrics import METRICS, metrics_of
from ...mission.plan import Plan
from ...plots.canvas import panel_size
from ...plots.figure import Picture, own_axes, size_of
from ...plots.legends import legend_below
from ...plots.lettering import as_written, shortened
from ...plots.paths import plot_paths
from ...plots.style import FAINT, INK, PALETTE
from .tradeoff import Assignment, Region, Regions, Segment, Tradeoff

BLUE, VERMILION, GREEN = PALETTE[:3]
SYMBOL = {"psi": "ψ", "beta": "β"}
UNIT = {"psi": "requirements", "beta": "time units"}
OBJECTIVES = {
    "psi": ("requirements met", "requirements met of fully satisfied victims"),
    "beta": ("success time", "failure time"),
}
MOST_NAMED = 12
"""Breakpoints that are named one by one; of more, the names would overlap."""
NAME_FONT = 7.0
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
    for which, (colour, line) in enumerate(((GREEN, "--"), (VERMILION, ":"))):
        steps = np.array([float(s.objectives[which]) for s in result.segments])
        label = f"{OBJECTIVES[result.over][which]} of the optimum"
        ax.stairs(
            steps, edges, baseline=None, color=colour, linestyle=line, linewidth=1.8, label=label
        )
    corners = [*(s.low for s in result.segments), result.segments[-1].high]
    values = [float(result.at(t).value(t)) for t in corners]
    ax.plot([float(t) for t in corners], values, color=BLUE, linewidth=2.6, label="optimal value")
    ax.plot(
        edges[1:-1], values[1:-1], "o", color="white", markeredgecolor=BLUE, markeredgewidth=1.6,
        label="breakpoint",
    )  # fmt: skip
    ax.set_ylabel(f"objective ({UNIT[result.over]})")
    _parameter_axis(ax, result)
    ax.set_title(f"Optimal value over {SYMBOL[result.over]}, {_count(result)}", fontsize=10)
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
        *supported.T, "o", color=BLUE, markersize=8,
        label=f"reached by a {SYMBOL[result.over]} ({len(supported)})",
    )  # fmt: skip
    if groups[False]:
        behind = np.array(groups[False])
        ax.plot(
            *behind.T, "D", color="white", markeredgecolor=VERMILION, markersize=6,
            markeredgewidth=1.5, label=f"reached by no {SYMBOL[result.over]} ({len(behind)})",
        )  # fmt: skip
    first, second = OBJECTIVES[result.over]
    unit = f" ({UNIT[result.over]})" if result.over == "beta" else ""
    better = "more" if result.sense == "max" else "less"
    ax.set_xlabel(f"{first}{unit}; {better} is better")
    ax.set_ylabel(f"{second}{unit}; {better} is better")
    ax.margins(0.12)
    cut = "" if result.frontier.complete else ", cut short"
    ax.set_title(f"Points that nothing dominates{cut}", fontsize=10)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return ax


@as_written
def plot_bands(result: Tradeoff, ax: Axes | None = None) -> Axes:
    """Per robot a band over the parameter: which cluster, or which victims, it takes.

    A colour is one choice; where a band's colour changes, that robot's choice does.
    """
    robots = result.segments[0].plan.instance.robots
    ax = own_axes(8, 1.2 + 0.32 * len(robots)) if ax is None else ax
    colours: dict[str, str] = {}
    for row in range(len(robots)):
        for low, high, name in _runs(result, row):
            colour = colours.setdefault(name, PALETTE[len(colours) % len(PALETTE)])
            width = float(high - low)
            ax.broken_barh(
                [(float(low), width)], (row - 0.38, 0.76), edgecolor="white", linewidth=0.8,
                facecolor=colour if name else "#E6E6E6",
            )  # fmt: skip
            if width > 0.012 * max(len(name), 2):
                label = ax.text(
                    float(low) + width / 2, row, name or "nothing", ha="center",
                    va="center_baseline", fontsize=8, color=INK,
                )  # fmt: skip
                label.set_bbox({"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none"})
    ax.set_yticks(range(len(robots)), [f"R{robot.id}" for robot in robots], fontsize=8)
    ax.set_ylim(len(robots) - 0.5, -0.5)
    ax.set_ylabel("robot")
    _parameter_axis(ax, result)
    what = "cluster" if result.over == "psi" else "victim"
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
    scale = ax.figure.colorbar(_scale(norm), ax=ax, label=METRICS[metric].title)
    if not spread:
        scale.set_ticks([min(values)])
    number = _numbers(regions)
    for region, value in zip(regions.regions, values, strict=True):
        _draw_region(ax, region, scale.cmap(norm(value)), str(number[region.plan.routes]))
    ax.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    ax.set_xlabel("ψ (full over partial satisfaction)")
    ax.set_ylabel("β (failure time over success time)")
    ax.set_title(METRICS[metric].label.capitalize(), fontsize=10)
    return ax


@as_written
def tradeoff_figure(result: Tradeoff, *, breakpoint_: Fraction | None = None) -> Figure:
    """One page on one parameter: value, front, bands, and the plans on either side of a breakpoint.

    Parameters
    ----------
    result : Tradeoff
        Over one parameter.
    breakpoint_ : Fraction, optional
        Where to compare plans; by default where most robots change what they take.

    Raises
    ------
    InputError
        If `breakpoint_` is none of the result's.
    """
    sides = _sides(result, breakpoint_)
    instance = result.segments[0].plan.instance
    width, height = panel_size(instance.map)
    bands = 1.5 + 0.3 * instance.n_robots
    maps = height + 2.2 + 0.14 * instance.n_robots
    figure = Picture(figsize=(max(2 * width + 2, 12), 5.2 + bands + maps), layout="constrained")
    parts: Any = figure.subfigures(3, 1, height_ratios=(4.6, bands, maps))
    top, middle, bottom = parts
    exact = "exact" if result.exact else "to 1e-9"
    figure.suptitle(
        f"{shortened(instance.name, 80) or 'unnamed mission'}: {SYMBOL[result.over]} in {result.model}"
        f" ({exact}, {result.n_solves} solves)",
        fontsize=12,
    )
    left, right = top.subplots(1, 2, width_ratios=(1.25, 1))
    plot_value(result, left)
    plot_front(result, right)
    plot_bands(result, middle.subplots())
    symbol = SYMBOL[result.over]
    _draw_plans(
        bottom,
        [(f"{symbol} from {_short(s.low)} to {_short(s.high)}", s.plan) for s in sides],
    )
    return figure


@as_written
def regions_figure(regions: Regions) -> Figure:
    """One page on both parameters: the square by some metrics, and the two plans furthest apart."""
    plans = sorted(regions.plans, key=lambda plan: (plan.metrics.distance, plan.metrics.makespan))
    instance = plans[0].instance
    number = _numbers(regions)
    width, height = panel_size(instance.map)
    maps = height + 2.2 + 0.14 * instance.n_robots
    figure = Picture(figsize=(max(2 * width + 2, 11.5), 9.6 + maps), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=(9, maps))
    top, bottom = parts
    exact = "exact" if regions.exact else "to 1e-9"
    figure.suptitle(
        f"{shortened(instance.name, 80) or 'unnamed mission'}: {len(regions.regions)} regions of ψ × β, "
        f"{len(plans)} different plans ({exact}, {regions.n_solves} solves)\n"
        "a number names a plan; hatched where it is one of several optimal ones",
        fontsize=12,
    )
    measured = [metric.name for metric in metrics_of("plans") if metric.better == "less"]
    panels = top.subplots(-(-len(measured) // 2), 2).flat
    for ax, metric in zip_longest(panels, measured):
        plot_regions(regions, ax, metric=metric) if metric else ax.set_axis_off()
    chosen = plans if len(plans) == 1 else [plans[0], plans[-1]]
    words = ["shortest", "longest"] if len(chosen) > 1 else ["the only"]
    titles = [f"plan {number[p.routes]} ({w})" for w, p in zip(words, chosen, strict=True)]
    _draw_plans(bottom, list(zip(titles, chosen, strict=True)))
    return figure


def _draw_plans(figure: SubFigure, plans: list[tuple[str, Plan]]) -> None:
    for ax, (title, plan) in zip(np.ravel(figure.subplots(1, len(plans))), plans, strict=True):
        plot_paths(plan, ax)
        m = plan.metrics
        ax.set_title(
            f"{title}\n{m.n_served} served, {m.distance} cells, makespan {m.makespan:.4g}, "
            f"mean completion {m.mean_completion:.4g} time units",
            fontsize=10,
        )


def _sides(result: Tradeoff, at: Fraction | None) -> list[Segment]:
    """The segments on either side of a breakpoint; the only one if there is none."""
    pairs = list(pairwise(result.segments))
    if at is not None and at not in result.breakpoints:
        known = ", ".join(map(str, result.breakpoints)) or "none"
        raise InputError(f"{at}; the breakpoints are {known}", field="breakpoint_")
    if not pairs:
        return list(result.segments)
    if at is not None:
        return list(pairs[result.breakpoints.index(at)])
    most = max(pairs, key=lambda pair: _changes(pair[0].assignment, pair[1].assignment))
    return [*most]


def _changes(before: Assignment, after: Assignment) -> int:
    return sum(a != b for a, b in zip(before, after, strict=True))


def _runs(result: Tradeoff, row: int) -> Iterator[tuple[Fraction, Fraction, str]]:
    """Longest intervals over which one robot takes the same."""
    named = [(s, result.named(s.assignment)[row]) for s in result.segments]
    for name, run in groupby(named, key=lambda item: item[1]):
        pieces = [segment for segment, _ in run]
        yield pieces[0].low, pieces[-1].high, name


def _parameter_axis(ax: Axes, result: Tradeoff) -> None:
    """The parameter on x, with its breakpoints as lines, named on top."""
    symbol = SYMBOL[result.over]
    ax.set_xlim(0, 1)
    ax.set_xlabel(f"{symbol} (weight of {OBJECTIVES[result.over][1]})")
    for t in result.breakpoints:
        ax.axvline(float(t), color=FAINT, linewidth=0.8, linestyle="--", zorder=0.5)
    if 0 < len(result.breakpoints) <= MOST_NAMED:
        _name_breakpoints(ax, result.breakpoints)


def _name_breakpoints(ax: Axes, breakpoints: Sequence[Fraction]) -> None:
    """Names above the axes: upright where they fit side by side, else turned and moved apart."""
    names = [_short(t) for t in breakpoints]
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


def apart(places: NDArray[np.float64], least: float) -> NDArray[np.float64]:
    """Ascending places, moved as little as can be (least squares) to be `least` apart."""
    steps = least * np.arange(len(places))
    return np.asarray(isotonic_regression(places - steps).x + steps, dtype=np.float64)


def _draw_region(ax: Axes, region: Region, colour: tuple[float, ...], text: str) -> None:
    (left, right), (low, high) = region.psi, region.beta
    width, height = float(right - left), float(high - low)
    ax.add_patch(
        Rectangle(
            (float(left), float(low)), width, height, facecolor=colour, edgecolor="white",
            linewidth=1, hatch="" if region.unique else "....",
        )
    )  # fmt: skip
    if min(width, height) > 0.035:
        red, green, blue, *_ = colour
        ink = "black" if 0.299 * red + 0.587 * green + 0.114 * blue > 0.5 else "white"
        label = ax.text(
            float(left) + width / 2, float(low) + height / 2, text, ha="center",
            va="center_baseline", fontsize=8, color=ink,
        )  # fmt: skip
        label.set_bbox({"boxstyle": "round,pad=0.15", "fc": colour, "ec": "none"})


def _numbers(regions: Regions) -> dict[object, int]:
    """Plans by what their robots do, numbered from 1 in the order of the regions."""
    return {plan.routes: i for i, plan in enumerate(regions.plans, start=1)}


def _scale(norm: Normalize) -> ScalarMappable:
    return ScalarMappable(norm, "cividis")


def _short(t: Fraction) -> str:
    """A fraction where it is short, else a decimal."""
    return str(t) if t.denominator <= 10_000 else f"{float(t):.6g}"


def _count(result: Tradeoff) -> str:
    n = len(result.breakpoints)
    return f"{n} breakpoint{'' if n == 1 else 's'}"
