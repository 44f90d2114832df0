"""Performance profiles: how often each is within a factor of the quickest.

Source: Dolan and Moré (2002).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.ticker import FuncFormatter, NullFormatter

from .blocks import Picture
from .runs import of_method, per_instance
from .style import add_legend, own_axes, styles


def profile(times: pd.DataFrame) -> pd.DataFrame:
    """The steps of a performance profile.

    Parameters
    ----------
    times : DataFrame
        Seconds by problem (rows) and competitor (columns); NaN where that did not finish.

    Returns
    -------
    DataFrame
        Columns ``who``, ``factor`` (of the quickest on the same problem) and ``share (%)``, of the
        problems that anybody finished, within that factor.
    """
    times = times.where(times > 0).dropna(how="all")
    factors = times.div(times.min(axis="columns"), axis="index")
    parts = []
    for who in factors:
        steps = np.sort(factors[who].dropna().to_numpy(float))
        share = 100 * np.arange(1, len(steps) + 1) / max(len(times), 1)
        part = pd.DataFrame({"who": who, "factor": steps, "share (%)": share})
        parts.append(part.drop_duplicates("factor", keep="last"))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def planning_profile(runs: pd.DataFrame, looks: Mapping[str, Mapping[str, Any]]) -> Picture | None:
    """Of the planning times of planners, instance by instance; `None` without two to compare."""
    times = per_instance(of_method(runs, "planner"), "seconds")
    return _picture(times, "planning-profile", "planner", "instances", looks)


def solving_profile(runs: pd.DataFrame) -> Picture | None:
    """Of the solving times of solvers, program by program; `None` without two to compare.

    A program is a formulation with its options on an instance; it counts as finished when solved
    to optimality.
    """
    mine = of_method(runs, "formulation")
    program = ["instance", "model", "options_json"]
    solved = mine["seconds"].where(mine["counts"])
    each = mine.assign(solved=solved).groupby([*program, "solver"], sort=False)["solved"].mean()
    times = each.unstack("solver")  # noqa: PD010 - one value each, as grouped
    return _picture(times, "solving-profile", "solver", "programs", styles(list(times)))


def _picture(
    times: pd.DataFrame, name: str, who: str, what: str, looks: Mapping[str, Mapping[str, Any]]
) -> Picture | None:
    steps = profile(times)
    tried = times.where(times > 0).dropna(how="all")
    if times.shape[1] < 2 or len(tried) < 2:
        return None
    worst = max(steps["factor"].max() * 1.1, 1.5)
    figure, ax = own_axes(5.2, 3.7 + 0.2 * len(looks))
    for competitor in times:
        mine = steps[steps["who"] == competitor]
        share = mine["share (%)"].to_numpy(float)
        x = np.concatenate([[1.0], mine["factor"].to_numpy(float), [worst]])
        y = np.concatenate([[0.0], share, share[-1:] if len(share) else [0.0]])
        look = {k: v for k, v in looks[competitor].items() if k != "marker"}
        ax.plot(
            x, y, **look, drawstyle="steps-post", linewidth=2,
            label=f"{competitor} ({int(tried[competitor].notna().sum())} of {len(tried)})",
        )  # fmt: skip
    ax.set_xscale("log")
    ax.set_xlim(1.0, worst)
    factors = FuncFormatter(lambda factor, _: f"{factor:g}×")
    ax.xaxis.set_major_formatter(factors)
    ax.xaxis.set_minor_formatter(factors if worst < 5 else NullFormatter())
    ax.set_ylim(-2, 102)
    ax.set_xlabel(f"time, as a multiple of the quickest {who}'s")
    ax.set_ylabel(f"{what} within it (%)")
    add_legend(figure, ax)
    kind = "planning" if who == "planner" else "solving"
    at_one = steps[steps["factor"] <= 1].set_index("who")["share (%)"]
    return Picture(
        name,
        f"Performance profile of {kind} time",
        f"Share of the {len(tried)} {what} that each {'contender' if who == 'planner' else who}"
        f" finished within a factor of the quickest on the same; at 1× it is the share where it was"
        " itself the quickest. In brackets: finished, of all that anybody finished.",
        f"Performance profile of {kind} time; quickest on "
        + ", ".join(f"{at_one.get(c, 0.0):.0f} % for {c}" for c in times),
        figure,
        steps,
    )
