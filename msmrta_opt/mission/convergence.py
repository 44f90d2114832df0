"""How a search closed in: its incumbent and its dual bound over time, of one plan or of several."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import Field

from ..public import load
from . import display
from .errors import InputError
from .proof import Finite
from .route import PlanRecord, Time

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


class SearchStep(PlanRecord):
    """What was known after `seconds` of the search, and what had just happened.

    ``incumbent`` is what the best routes so far are worth, ``bound`` what none can be below, ``None``
    while nothing is known; ``event`` is ``better routes``, how the bound was proved, or the phase that
    began.
    """

    seconds: Time
    incumbent: Finite
    bound: Finite | None
    event: str

    @property
    def gap(self) -> float | None:
        """Share of the incumbent's value that the bound leaves open."""
        if self.bound is None:
            return None
        open_ = max(self.incumbent - self.bound, 0.0)
        return open_ / abs(self.incumbent) if self.incumbent else 0.0


class SearchRecord(PlanRecord):
    """A minimising search, step by step in the order of time; the last step is its end.

    Times depend on the machine, and so may the steps; plans are compared without them.
    """

    objective: str
    unit: str
    steps: tuple[SearchStep, ...] = Field(min_length=1)

    @property
    def seconds(self) -> float:
        """How long it took."""
        return self.steps[-1].seconds

    @property
    def best_after(self) -> float:
        """Seconds until the best routes were there."""
        best = self.steps[-1].incumbent
        return next(step.seconds for step in self.steps if step.incumbent <= best)


class Searched(Protocol):
    """What keeps a record of its search: a `Plan`."""

    @property
    def planner(self) -> str:
        """Who made it."""

    @property
    def search(self) -> SearchRecord | None:
        """The record, if there is one."""


@dataclass(frozen=True)
class Convergence:
    """The searches of plans, by name.

    Raises
    ------
    InputError
        If a plan keeps no record of a search, or searches differ in what they minimise.
    """

    plans: Mapping[str, Searched]

    def __post_init__(self) -> None:
        for name, plan in self.plans.items():
            if plan.search is None:
                raise InputError(
                    f"{name!r} of the planner {plan.planner!r} has no record of a search; give "
                    "plans of the planner 'exact'",
                    field="search",
                )
        aims = {search.objective: name for name, search in self.searches.items()}
        if len(aims) > 1:
            said = ", ".join(f"{name!r} minimises {aim}" for aim, name in aims.items())
            raise InputError(f"{said}; give plans with one objective", field="search")

    @property
    def searches(self) -> dict[str, SearchRecord]:
        """The records by name."""
        return {name: plan.search for name, plan in self.plans.items() if plan.search is not None}

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for each step: the plan's name, seconds, what happened, incumbent, bound and gap."""
        return [
            {
                "plan": name,
                "seconds": step.seconds,
                "event": step.event,
                "incumbent": step.incumbent,
                "bound": step.bound,
                "gap": step.gap,
            }
            for name, search in self.searches.items()
            for step in search.steps
        ]

    @property
    def summary(self) -> list[dict[str, Any]]:
        """A row for each plan: what it ended with, when its best routes were there, how long it took."""
        return [
            {
                "plan": name,
                "incumbent": search.steps[-1].incumbent,
                "bound": search.steps[-1].bound,
                "gap": search.steps[-1].gap,
                "best after (s)": search.best_after,
                "seconds": search.seconds,
            }
            for name, search in self.searches.items()
        ]

    def to_frame(self) -> pd.DataFrame:
        """`rows` as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Incumbents and bounds over time in one picture; see `plots.plot_convergence`."""
        drawn: Axes = load("plots").plot_convergence(self, ax)
        return drawn

    def __repr__(self) -> str:
        return f"Convergence({', '.join(self.plans)})"

    def _repr_html_(self) -> str:
        aim = next(iter(self.searches.values())).objective if self.plans else ""
        return display.page(f"Convergence: {aim}", display.table("Searches", self.summary))
