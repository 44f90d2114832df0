"""Performance profiles: how often each is within a factor of the quickest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from ...plots.style import line_styles
from ..analysis.profile import draw_profile
from ..analysis.times import finished, profile
from .blocks import Picture
from .runs import of_method, per_instance
from .style import add_legend, own_axes


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
    return _picture(times, "solving-profile", "solver", "programs", line_styles(list(times)))


def _picture(
    times: pd.DataFrame, name: str, who: str, what: str, looks: Mapping[str, Mapping[str, Any]]
) -> Picture | None:
    steps, tried = profile(times), finished(times)
    if times.shape[1] < 2 or len(tried) < 2:
        return None
    figure, ax = own_axes(5.2, 3.7 + 0.2 * len(looks))
    draw_profile(ax, times, looks)
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
