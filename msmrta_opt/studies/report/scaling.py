"""How planning time grows: curves on logarithmic axes, with fitted exponents."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator
from numpy.typing import ArrayLike

from ...plots.lettering import shortened, told_apart
from ...plots.style import INK
from .blocks import Picture, Table
from .runs import METHODS, contenders, per_instance
from .style import add_legend, own_axes
from .text import file_names

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

VICTIMS = "victims"
PRODUCT = "robots × victims"
FITTED = {"error": "standard error", "r2": "R²", "coefficient": "coefficient (s)"}
"""What a table calls the fields of a `Fit`, where not by their names."""
MIN_SIZES = 5
"""Different sizes below which no exponent is fitted."""
MIN_DRAWN = 3
"""Different sizes below which nothing is drawn."""
MAX_ERROR, MAX_ERROR_SHARE = 0.05, 0.1
"""Standard error, and its share of the exponent, up to which a law is said: either suffices."""


@dataclass(frozen=True)
class Fit:
    """A power law, time = coefficient · size ^ exponent, by least squares on the logarithms.

    ``error`` is the standard error of the exponent, ``r2`` the share of the variance of log time that
    the law explains.
    """

    exponent: float
    error: float
    r2: float
    coefficient: float
    points: int


def fit(sizes: ArrayLike, seconds: ArrayLike) -> Fit | None:
    """The power law through `seconds` over `sizes`, both of shape ``(n_points,)``.

    Points that are missing or not positive do not count; `None` if fewer than five different
    sizes are left, or the exponent is not known well enough.
    """
    x, y = np.asarray(sizes, float), np.asarray(seconds, float)
    known = (x > 0) & (y > 0)
    x, y = np.log(x[known]), np.log(y[known])
    if len(np.unique(x)) < MIN_SIZES:
        return None
    dx, dy = x - x.mean(), y - y.mean()
    exponent = (dx @ dy) / (dx @ dx)
    residual = float(((dy - exponent * dx) ** 2).sum())
    total = float(dy @ dy)
    freedom = len(x) - 2
    error = float(np.sqrt(residual / freedom / (dx @ dx)))
    if error > max(MAX_ERROR, MAX_ERROR_SHARE * abs(exponent)):
        return None
    return Fit(
        exponent=float(exponent),
        error=error,
        r2=1 - residual / total if total else 1.0,
        coefficient=float(np.exp(y.mean() - exponent * x.mean())),
        points=len(x),
    )


@dataclass(frozen=True)
class Growth:
    """The times of contenders over one measure of size, on one map."""

    map: str
    over: str
    n_robots: int | None
    """The number of robots, where it is held fixed."""
    data: pd.DataFrame
    """Columns: contender, size, median, lower and upper quartile in seconds, instances."""
    fits: Mapping[str, Fit]
    """By contender; over all instances, not over the medians."""


def growths(runs: pd.DataFrame) -> Iterator[Growth]:
    """Per map, times over victims at the largest number of robots, and over robots × victims."""
    seconds = (
        per_instance(runs, "seconds")
        .melt(var_name="contender", value_name="seconds", ignore_index=False)
        .dropna()
        .reset_index()
    )
    for name, here in seconds.groupby("map", sort=False):
        maximum = int(here["n_robots"].max())
        largest = here[here["n_robots"] == maximum]
        found = [_growth(name, VICTIMS, maximum, largest.assign(size=largest["n_victims"]))]
        if maximum > here["n_robots"].min():
            product = here["n_robots"] * here["n_victims"]
            found.append(_growth(name, PRODUCT, None, here.assign(size=product)))
        yield from (growth for growth in found if growth.data["size"].nunique() >= MIN_DRAWN)


def _growth(name: str, over: str, n_robots: int | None, points: pd.DataFrame) -> Growth:
    points = points[points["size"] > 0]
    groups = points.groupby(["contender", "size"], sort=False)["seconds"]
    quantiles = groups.quantile([0.25, 0.5, 0.75]).unstack()  # noqa: PD010 - one value each
    quantiles.columns = ["lower quartile (s)", "median (s)", "upper quartile (s)"]
    data = quantiles.assign(instances=groups.size()).reset_index()
    order = {contender: i for i, contender in enumerate(contenders(points))}
    data = data.sort_values("size").sort_values(
        "contender", key=lambda column: column.map(order), kind="stable"
    )
    fits = {}
    for contender, mine in points.groupby("contender", sort=False):
        found = fit(mine["size"], mine["seconds"])
        if found is not None:
            fits[contender] = found
    return Growth(name, over, n_robots, data.reset_index(drop=True), fits)


def draw(growth: Growth, looks: Mapping[str, Mapping[str, Any]], method: str) -> Figure:
    """Medians with their quartiles, and the fitted law of each contender as a thin line."""
    figure, ax = own_axes(5.2, 3.8 + 0.2 * len(looks))
    said = told_apart(looks)
    for contender, mine in growth.data.groupby("contender", sort=False):
        look = looks[contender]
        law = growth.fits.get(contender)
        label = (
            said[contender] if law is None else f"{said[contender]}: exponent {_plus_minus(law)}"
        )
        size = mine["size"].to_numpy(float)
        ax.plot(size, mine["median (s)"], **look, linewidth=1.8, markersize=5, label=label)
        if (mine["instances"] > 1).any():
            ax.fill_between(
                size, mine["lower quartile (s)"], mine["upper quartile (s)"],
                color=look["color"], alpha=0.18, linewidth=0,
            )  # fmt: skip
        if law is not None:
            ends = np.array([size.min(), size.max()])
            ax.plot(
                ends, law.coefficient * ends**law.exponent,
                color=look["color"], linewidth=0.9, alpha=0.7,
            )  # fmt: skip
    ax.set_xscale("log")
    ax.set_yscale("log")
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    sizes = np.unique(growth.data["size"].to_numpy(float))
    ax.set_xticks(_spread(sizes))
    ax.xaxis.set_major_formatter(plain)
    ax.xaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(plain)
    low, high = ax.get_ylim()
    if high / low < 20:
        ax.yaxis.set_minor_formatter(plain)
    else:
        ax.yaxis.set_minor_locator(NullLocator())
    ax.set_xlabel(growth.over)
    ax.set_ylabel(f"{METHODS[method]} (s)")
    ax.set_title(f"{shortened(growth.map)}{_fixed(growth)}", fontsize=11, color=INK)
    add_legend(figure, ax)
    return figure


def scaling_blocks(
    runs: pd.DataFrame, method: str, looks: Mapping[str, Mapping[str, Any]]
) -> list[Picture | Table]:
    """A picture per map and measure of size, and the table of exponents; none without a fit."""
    found = list(growths(runs))
    names = file_names([growth.map for growth in found])
    what = METHODS[method]
    blocks: list[Picture | Table] = [
        Picture(
            f"{what.split()[0]}-scaling-{names[growth.map]}-"
            + ("victims" if growth.over == VICTIMS else "robots-times-victims"),
            f"{what.capitalize()} against {growth.over}, {growth.map}",
            f"Points: median{_fixed(growth)}. Band: quartiles, where a size has several"
            " instances."
            + (
                " Thin lines: fitted laws, with the standard errors of their exponents."
                if growth.fits
                else ""
            ),
            f"Log-log plot of {what} against {growth.over} on map {growth.map}"
            + "".join(f"; {who}: exponent {_plus_minus(law)}" for who, law in growth.fits.items()),
            draw(growth, looks, method),
            growth.data,
        )
        for growth in found
    ]
    rows = [
        {
            "map": growth.map,
            "against": growth.over + _fixed(growth),
            "contender": contender,
            **{FITTED.get(name, name): value for name, value in asdict(law).items()},
        }
        for growth in found
        for contender, law in growth.fits.items()
    ]
    if rows:
        blocks.append(
            Table(
                f"{what.split()[0]}-exponents",
                "Fitted exponents",
                pd.DataFrame(rows),
                "time = coefficient · size ^ exponent, by least squares on the logarithms of all"
                " instances that the contender finished; runs that ended at a limit have no time"
                " and are not in the fit, so where there are failures the exponent is of the"
                " easier instances. A law is given where there are"
                f" {MIN_SIZES} sizes or more and the standard error is at most {MAX_ERROR:g} or"
                f" {MAX_ERROR_SHARE:.0%} of the exponent.",
            )
        )
    return blocks


def _plus_minus(law: Fit) -> str:
    return f"{law.exponent:.2f} ± {law.error:.2f}"


def _fixed(growth: Growth) -> str:
    return "" if growth.n_robots is None else f", {growth.n_robots} robots"


def _spread(sizes: np.ndarray, maximum: int = 7) -> list[float]:
    """At most `maximum` of `sizes`, about evenly spread on a logarithmic axis, ends included."""
    if len(sizes) <= maximum:
        chosen = list(sizes)
    else:
        wanted = np.geomspace(sizes[0], sizes[-1], maximum)
        chosen = list(dict.fromkeys(sizes[np.abs(sizes - w).argmin()] for w in wanted))
    kept = chosen[:1]
    for size in chosen[1:]:
        # Labels of neighbours nearer than this overlap.
        if size / kept[-1] > 1.12 * (sizes[-1] / sizes[0]) ** 0.02:
            kept.append(size)
    return [float(size) for size in kept]
