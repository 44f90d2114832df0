"""Heat maps over robots × victims, after the paper's Fig. 3: one panel per map and contender.

The page draws the panels itself, from `Panel`, so that they fit any width and each cell tells its
value; `sheet` draws all of them on one picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm, Normalize, to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ...mission.metrics import METRICS
from ...plots.lettering import shortened, told_apart
from ...plots.style import FAINT, INK, readable_on
from .blocks import Cell, HeatMaps, MapHeat, Panel
from .runs import METHODS, contenders, varying
from .style import PAPER
from .text import compact, number

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

NOTE = (
    "Across: victims; up: robots. The contenders of a map share its scale of colours. A cross: every run"
    " of the cell failed; a dot: some did; hatched: not run."
)
COLOURS = colormaps["viridis"]
STOPS = 16
MISSING, FAILED, FOUND, PARTLY = "not run", "failed", "", "partly failed"
NO_TIME = {"planner": "failed", "formulation": "ended without a proven optimum"}
"""Why runs do not count."""
VALUED = (6, 6)
"""Up to so many robots and victims, each cell of a panel tells its value."""
GAP = 0.18
"""Between the panels of a sheet, in panels."""


def time_heat(runs: pd.DataFrame, method: str) -> HeatMaps | None:
    """Planning (or solving) time, on logarithmic scales."""
    what = METHODS[method]
    return _heat(runs, "seconds", what, "s", log=True, failed=NO_TIME[method])


def metric_heats(runs: pd.DataFrame) -> list[HeatMaps]:
    """One for each metric of the plans."""
    found = []
    for metric in varying(runs):
        heat = _heat(runs, metric.name, metric.label, metric.unit, log=False)
        if heat is not None:
            found.append(heat)
    return found


def _heat(
    runs: pd.DataFrame, column: str, what: str, unit: str, *, log: bool, failed: str = "failed"
) -> HeatMaps | None:
    """`None` if on no map both robots and victims vary, or nothing finished."""
    cells = _cells(runs, column)
    maps = list(_maps(cells, unit, log=log, order=contenders(runs)))
    if not maps:
        return None
    scale = "logarithmic" if log else "linear"
    data = cells.rename(columns={"value": f"{what} ({unit})"})
    return HeatMaps(
        name=f"heat-{what.replace(' ', '-')}",
        title=what.capitalize(),
        caption=f"Mean of the instances of a cell, {scale} scale."
        + (f" A cross: every run {failed}." if failed != FAILED else ""),
        unit=unit,
        maps=maps,
        sheet=_sheet(maps, f"{what} ({unit})"),
        data=data[data["map"].isin([item.map for item in maps])].reset_index(drop=True),
    )


def _cells(runs: pd.DataFrame, column: str) -> pd.DataFrame:
    """By map, contender, robots and victims: mean of `column`, runs that count, failed runs."""
    keys = ["map", "contender", "n_robots", "n_victims"]
    values = runs[column].where(runs["counts"])
    shown = METRICS[column].scaled(values) if column in METRICS else values
    known = runs.assign(value=shown, failed=~runs["counts"])
    instances = known.groupby([*keys, "instance"], sort=False)
    each = instances.agg(value=("value", "mean"), runs=("failed", "size"), failed=("failed", "sum"))
    return (
        each.groupby(keys, sort=False)
        .agg(value=("value", "mean"), runs=("runs", "sum"), failed=("failed", "sum"))
        .reset_index()
    )


def _maps(cells: pd.DataFrame, unit: str, *, log: bool, order: Sequence[str]) -> Iterator[MapHeat]:
    for name, here in cells.groupby("map", sort=False):
        robots, victims = (sorted(set(here[side])) for side in ("n_robots", "n_victims"))
        values = here["value"].dropna()
        if log:
            values = values[values > 0]
        if len(robots) < 2 or len(victims) < 2 or values.empty:
            continue
        low, high = float(values.min()), float(values.max())
        norm: Normalize = LogNorm(low, high) if log else Normalize(low, high)
        groups = dict(iter(here.groupby("contender", sort=False)))
        panels = [
            _panel(contender, groups[contender], robots, victims, norm, unit)
            for contender in order
            if contender in groups
        ]
        middle = float(norm.inverse(0.5))
        yield MapHeat(str(name), panels, low, middle, high, log, _gradient())


def _gradient() -> str:
    stops = COLOURS(np.linspace(0, 1, STOPS))
    return f"linear-gradient(to right, {', '.join(to_hex(stop) for stop in stops)})"


def _panel(
    contender: str,
    here: pd.DataFrame,
    robots: Sequence[int],
    victims: Sequence[int],
    norm: Normalize,
    unit: str,
) -> Panel:
    values = {(row.n_robots, row.n_victims): row for row in here.itertuples()}
    # All of one value: the middle of the scale, which has no width.
    share = np.ma.filled(norm(here["value"].to_numpy(float)), np.nan)
    share = share if norm.vmax != norm.vmin else np.where(np.isnan(share), np.nan, 0.5)
    colours = dict(zip(values, map(to_hex, COLOURS(share)), strict=True))
    small = len(robots) <= VALUED[0] and len(victims) <= VALUED[1]
    cells = []
    for y, n_robots in enumerate(robots):
        for x, n_victims in enumerate(victims):
            row = values.get((n_robots, n_victims))
            state, told = _state(row, unit)
            cells.append(
                Cell(
                    x, y, state,
                    colours[n_robots, n_victims] if state in (FOUND, PARTLY) else None,
                    f"{n_robots} robots, {n_victims} victims: {told}",
                    *(_written(row, colours[n_robots, n_victims])
                      if small and state in (FOUND, PARTLY) else ("", "")),
                )
            )  # fmt: skip
    known = here.dropna(subset="value")
    n_failed = sum(cell.state == FAILED for cell in cells)
    told = (
        f"from {number(known['value'].min())} to {number(known['value'].max())} {unit}"
        if len(known)
        else "no value"
    )
    alt = f"{contender}: {told}; {len(known)} of {len(cells)} cells have a value, {n_failed} failed"
    return Panel(contender, robots, victims, cells, alt)


def _written(row: Any, colour: str) -> tuple[str, str]:
    """The value in as many letters as a cell holds, and the ink that can be read on its colour."""
    return compact(row.value), readable_on(colour)


def _state(row: Any, unit: str) -> tuple[str, str]:
    if row is None:
        return MISSING, "not run"
    if np.isnan(row.value):
        return FAILED, f"failed ({row.failed} of {row.runs} runs)"
    told = f"{number(row.value)} {unit}"
    if row.failed:
        return PARTLY, f"{told}; {row.failed} of {row.runs} runs failed"
    return FOUND, told


def _sheet(maps: Sequence[MapHeat], title: str) -> Figure:
    """A row per map, a column per contender, and each row's scale of colours."""
    columns: Mapping[str, int] = {
        name: i for i, name in enumerate(dict.fromkeys(p.contender for m in maps for p in m.panels))
    }
    width, height = 2.6 * (len(columns) * (1 + GAP) + 0.9), 2.4 * (len(maps) * 1.32 + 0.25)
    figure = Figure(figsize=(width, height), facecolor=PAPER)
    # One pair of axes for all panels: hundreds of pairs would take minutes.
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set_axis_off()
    right = len(columns) * (1 + GAP)
    said = told_apart(columns, 36)
    for row, item in enumerate(maps):
        for panel in item.panels:
            left = columns[panel.contender] * (1 + GAP)
            _draw_panel(ax, panel, said[panel.contender], left, row * 1.32)
        ax.text(
            -0.27, row * 1.32 + 0.5, shortened(item.map), rotation=90, ha="center", va="center",
            fontsize=10, weight="bold",
        )  # fmt: skip
        ramp = COLOURS(np.linspace(1, 0, 64))[:, None]
        ax.imshow(ramp, extent=(right, right + 0.06, row * 1.32 + 1, row * 1.32), aspect="auto")
        for at, value in ((1, item.low), (0.5, item.middle), (0, item.high)):
            ax.text(right + 0.09, row * 1.32 + at, number(value), va="center", fontsize=7)
    ax.text(-0.2, -0.24, title[0].upper() + title[1:], fontsize=12, va="bottom")
    ax.set_xlim(-0.36, right + 0.5)
    ax.set_ylim(len(maps) * 1.32, -0.36)
    return figure


def _draw_panel(ax: Axes, panel: Panel, said: str, left: float, top: float) -> None:
    n_x, n_y = len(panel.victims), len(panel.robots)
    image = np.ones((n_y, n_x, 4))
    for cell in panel.cells:
        if cell.colour is not None:
            image[cell.y, cell.x, :3] = [int(cell.colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        x, y = left + (cell.x + 0.5) / n_x, top + 1 - (cell.y + 0.5) / n_y
        if cell.state == FAILED:
            ax.text(x, y, "×", ha="center", va="center", fontsize=8, color=INK)
        elif cell.state == PARTLY:
            ax.plot(x, y, "o", markersize=2.5, color="white", markeredgecolor=INK, mew=0.5)
        elif cell.state == MISSING:
            ax.add_patch(
                Rectangle(
                    (left + cell.x / n_x, top + 1 - (cell.y + 1) / n_y), 1 / n_x, 1 / n_y,
                    hatch="////", facecolor="#EEEEEE", edgecolor=FAINT, linewidth=0,
                )
            )  # fmt: skip
    ax.imshow(image, extent=(left, left + 1, top + 1, top), origin="lower", aspect="auto", zorder=0)
    ax.add_patch(Rectangle((left, top), 1, 1, fill=False, edgecolor=INK, linewidth=0.6))
    for cell in panel.cells:
        if cell.text and cell.state == FOUND:
            ax.text(
                left + (cell.x + 0.5) / n_x, top + 1 - (cell.y + 0.5) / n_y, cell.text,
                ha="center", va="center", fontsize=7, color=cell.ink,
            )  # fmt: skip
    for x, label in panel.x_labels:
        ax.text(left + (x + 0.5) / n_x, top + 1.03, str(label), ha="center", va="top", fontsize=7)
    for y, label in panel.y_labels:
        ax.text(
            left - 0.02, top + 1 - (y + 0.5) / n_y, str(label), ha="right", va="center", fontsize=7
        )
    ax.text(left + 0.5, top + 1.11, "victims", ha="center", va="top", fontsize=7)
    ax.text(left - 0.13, top + 0.5, "robots", rotation=90, ha="center", va="center", fontsize=7)
    ax.text(left + 0.5, top - 0.03, said, ha="center", va="bottom", fontsize=8)
