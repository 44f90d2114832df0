"""Pages on trade-offs: what a parameter does to the optimum and to the plans, and both at once."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from matplotlib.figure import Figure

from ...mission.errors import InputError
from ...mission.metrics import metrics_of
from ...mission.plan import Plan
from ...plots.figure import POINTS_PER_INCH, Page
from ...plots.key import columns_below, draw_key, key_height
from ...plots.lettering import as_written, fitted
from ...plots.mission import GAP, MARGIN, WIDTH
from ...plots.style import FAINT
from ...plots.titles import name_of
from ...plots.two_plans import Item, draw_maps, maps_height, plans_key
from .tradeoff_pictures import (
    numbers_of,
    plot_bands,
    plot_changes,
    plot_front,
    plot_regions,
    plot_value,
    short,
    symbol_of,
)
from .tradeoff_results import Assignment, Regions, Segment, Tradeoff

INNER = WIDTH - 2 * MARGIN
TITLE, PANEL, CHART = 0.72, 3.9, 2.0
"""Inches: the page's title, a panel with its legend, and a chart's axes."""
LEFT, UP = 0.62, 0.5
"""Inches that what is written beside and above a chart takes."""


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
    plans = [segment.plan for segment in sides]
    symbol, instance = symbol_of(result), plans[0].instance
    bands = 0.3 + 0.28 * instance.n_robots
    charts = 2 * PANEL + bands + 1.1 if result.breakpoints else 0.0
    exact = "exact" if result.exact else "to 1e-9"
    said = f"{symbol} in {result.model} ({exact}, {result.n_solves} solves)"
    if not result.breakpoints:
        ends = " to ".join(map(short, result.span))
        said = f"{symbol} has no effect on this mission, one optimum for all from {ends}: {said}"
    page, top = _page(name_of(instance), said, plans, charts)
    if result.breakpoints:
        half = INNER / 2 - LEFT - GAP
        for number, draw in enumerate((plot_value, plot_changes)):
            draw(result, page.place(MARGIN + LEFT + number * INNER / 2, top + UP, half, CHART))
        top += PANEL
        plot_front(result, page.place(MARGIN + LEFT, top + UP, half, CHART))
        _write_pieces(page, result, MARGIN + INNER / 2 + GAP, top + 0.2)
        top += PANEL
        plot_bands(result, page.place(MARGIN + LEFT, top + UP - 0.1, INNER - LEFT - GAP, bands))
        top += bands + 1.1
    titles = [f"{symbol} from {short(s.low)} to {short(s.high)}" for s in sides]
    _draw_plans(page, titles, plans, top)
    return page


@as_written
def regions_figure(regions: Regions) -> Figure:
    """One page on both parameters: the square by some metrics, and the two plans furthest apart."""
    plans = sorted(regions.plans, key=lambda plan: (plan.metrics.distance, plan.metrics.makespan))
    number = numbers_of(regions)
    measured = [metric.name for metric in metrics_of("plans") if metric.better == "less"]
    lines = -(-len(measured) // 2)
    side = INNER / 2 - LEFT - 1.0
    exact = "exact" if regions.exact else "to 1e-9"
    said = (
        f"{len(regions.regions)} regions of ψ × β, {len(plans)} different plans ({exact}, "
        f"{regions.n_solves} solves); a number names a plan, * marks one of several optimal ones"
    )
    chosen = plans if len(plans) == 1 else [plans[0], plans[-1]]
    if len(regions.regions) == 1:
        said = f"neither ψ nor β has an effect on this mission: one plan for all, {exact}"
        lines = 0
    page, top = _page(name_of(plans[0].instance), said, chosen, lines * (side + 1.1))
    if lines:
        for place, metric in enumerate(measured):
            line, column = divmod(place, 2)
            left = MARGIN + LEFT + 0.1 + column * INNER / 2
            ax = page.place(left, top + 0.3 + line * (side + 1.1), side + 0.75, side)
            plot_regions(regions, ax, metric=metric)
    words = ["shortest", "longest"] if len(chosen) > 1 else ["the only"]
    titles = [f"plan {number[p.routes]} ({w})" for w, p in zip(words, chosen, strict=True)]
    _draw_plans(page, titles, chosen, top + lines * (side + 1.1))
    return page


def _page(name: str, said: str, plans: Sequence[Plan], charts: float) -> tuple[Page, float]:
    """A page with its title, for charts of a height and the maps of plans; and where they begin."""
    sections = plans_key(plans)
    key = key_height(sections, INNER, columns_below(sections, INNER))
    page = Page(WIDTH, TITLE + charts + maps_height(plans, INNER) + key + GAP + MARGIN)
    room = INNER * POINTS_PER_INCH
    page.write(MARGIN, 0.1, fitted(name, 12, room, bold=True), 12, fontweight="bold")
    page.write(MARGIN, 0.36, fitted(said, 9, room), 9, color=FAINT)
    return page, TITLE


def _draw_plans(page: Page, titles: Sequence[str], plans: Sequence[Plan], top: float) -> None:
    draw_maps(page, [Item(*item) for item in zip(titles, plans, strict=True)], top, INNER)
    sections = plans_key(plans)
    bottom = top + maps_height(plans, INNER) + GAP
    draw_key(page, sections, MARGIN, bottom, INNER, columns_below(sections, INNER))


def _write_pieces(page: Page, result: Tradeoff, left: float, top: float) -> None:
    """What the plans cost on each interval, as many as there is room for."""
    symbol, line = symbol_of(result), 0.19
    rows = [f"What plans cost over {symbol}:"]
    for s in result.segments:
        m = s.metrics
        rows.append(
            f"{short(s.low)} to {short(s.high)}: makespan {m.makespan:.5g}, {m.distance} cells, "
            f"total {m.total_time:.5g}"
        )
    maximum = int((PANEL - 0.6) / line)
    if len(rows) > maximum:
        rows = [*rows[: maximum - 1], f"… and {len(rows) - maximum + 1} more"]
    room = (INNER / 2 - 2 * GAP) * POINTS_PER_INCH
    for number, row in enumerate(rows):
        page.write(left, top + number * line, fitted(row, 8, room), 8)


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
    maximum = max(pairs, key=lambda pair: _changes(pair[0].assignment, pair[1].assignment))
    return [*maximum]


def _changes(before: Assignment, after: Assignment) -> int:
    return sum(a != b for a, b in zip(before, after, strict=True))
