"""What a trade-off found: pieces of one parameter, or regions of two, each with its plan; as tables."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ...mission import display
from ...mission.metrics import Metrics, metrics_of
from ...mission.plan import Plan
from ...optimise.frontier import Frontier

if TYPE_CHECKING:
    import pandas as pd

Assignment = tuple[tuple[int, ...], ...]
"""Per robot, in the mission's order, what it takes: clusters (Eq. 1) or victims (Eq. 2), by position."""


@dataclass(frozen=True, eq=False, repr=False)
class Segment:
    """An interval of the parameter with one optimal line, and the plan that comes of it.

    ``objectives`` are the two that the parameter weighs: the values of what is chosen here at the ends
    of its range, ``span``. ``unique`` says whether nothing else is optimal inside the interval; where
    something is, ``assignment`` and ``plan`` are what the planner chooses in the middle.
    """

    low: Fraction
    high: Fraction
    objectives: tuple[Fraction, Fraction]
    assignment: Assignment
    unique: bool
    plan: Plan
    span: tuple[Fraction, Fraction] = (Fraction(0), Fraction(1))

    @property
    def slope(self) -> Fraction:
        """Change of the optimal value for one unit of the parameter."""
        return (self.objectives[1] - self.objectives[0]) / (self.span[1] - self.span[0])

    def value(self, t: Fraction | float) -> Fraction | float:
        """The optimal value where the parameter is `t`."""
        return self.objectives[0] + (t - self.span[0]) * self.slope

    @property
    def metrics(self) -> Metrics:
        """Of the plan."""
        return self.plan.metrics

    def __repr__(self) -> str:
        return f"Segment({self.low} to {self.high}, slope {self.slope})"


@dataclass(frozen=True, eq=False, repr=False)
class Tradeoff:
    """All pieces over one parameter.

    Parameters
    ----------
    segments : tuple of Segment
        In order, covering the parameter's range; only the first of it, if `interruption` ended it.
    ties : dict of Fraction to tuple of Assignment
        At each breakpoint all optimal assignments, up to `MAX_TIES`.
    more_ties : frozenset of Fraction
        Breakpoints that have more of them.
    frontier : Frontier
        Every point that nothing dominates, whether a weight reaches it or not.
    frontier_assignments : tuple of Assignment
        One that gives each point of the frontier.
    names : tuple of str
        What an assignment's positions stand for: ``C0``, … for clusters, ``v0``, … for victims by id.
    exact : bool
        Whether breakpoints are exact fractions of rational data.
    n_solves : int
        Programs solved for the segments.
    stage : str
        Of the formulation: ``cluster`` or ``victim``.
    span : tuple of Fraction
        The parameter's range.
    """

    over: str
    model: str
    sense: str
    segments: tuple[Segment, ...]
    ties: dict[Fraction, tuple[Assignment, ...]]
    more_ties: frozenset[Fraction]
    frontier: Frontier
    frontier_assignments: tuple[Assignment, ...]
    names: tuple[str, ...]
    exact: bool
    n_solves: int
    stage: str = "cluster"
    span: tuple[Fraction, Fraction] = (Fraction(0), Fraction(1))

    @property
    def breakpoints(self) -> list[Fraction]:
        """Where the optimum changes."""
        return [segment.low for segment in self.segments[1:]]

    def at(self, t: Fraction | float) -> Segment:
        """The segment that holds `t`; at a breakpoint the left one."""
        return next(segment for segment in self.segments if t <= segment.high)

    def named(self, assignment: Assignment) -> list[str]:
        """Per robot the names of what it takes: ``C1``, or ``v3+v7``; empty for nothing."""
        return ["+".join(self.names[i] for i in taken) for taken in assignment]

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row a segment: its interval, the optimal value's slope and ends, who takes what, metrics."""
        return [
            {
                "low": float(segment.low),
                "high": float(segment.high),
                "slope": float(segment.slope),
                "at 0": float(segment.objectives[0]),
                "at 1": float(segment.objectives[1]),
                "robots take": ", ".join(name or "∅" for name in self.named(segment.assignment)),
                "unique": segment.unique,
                **{entry.name: entry.of(segment.metrics) for entry in metrics_of("plans")},
            }
            for segment in self.segments
        ]

    def document(self) -> dict[str, Any]:
        """Everything, ready for JSON; breakpoints as exact fractions, too."""
        return {
            "over": self.over,
            "model": self.model,
            "sense": self.sense,
            "exact": self.exact,
            "breakpoints": [str(t) for t in self.breakpoints],
            "pieces": self.rows,
            "ties": [
                {
                    "at": str(t),
                    "robots take": self.named(assignment),
                    "all": t not in self.more_ties,
                }
                for t, assignments in self.ties.items()
                for assignment in assignments
            ],
            "frontier": [
                {
                    "at 0": float(point.line.at_zero),
                    "at 1": float(point.line.at_one),
                    "supported": point.supported,
                    "robots take": self.named(assignment),
                }
                for point, assignment in zip(
                    self.frontier.points, self.frontier_assignments, strict=True
                )
            ],
        }

    def to_frame(self) -> pd.DataFrame:
        """`rows` as a table; the exact ends are in `segments`."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    @property
    def _summary(self) -> str:
        ends = ", ".join(map(str, self.breakpoints[:8])) + (
            ", …" if len(self.breakpoints) > 8 else ""
        )
        at = f", breakpoints {ends}" if ends else ""
        pieces = display.counted(len(self.segments), "piece")
        return f"{self.model} over {self.over}: {pieces}, {self.sense}{at}"

    def __repr__(self) -> str:
        return f"Tradeoff({self._summary})"

    def _repr_html_(self) -> str:
        return display.page(self._summary, display.table("Pieces", self.rows))


@dataclass(frozen=True, eq=False)
class Region:
    """A rectangle of the ψ × β square in which the plan stays the same, up to ties.

    ``unique`` says whether there are none inside: neither Eq. 1 nor Eq. 2 has another optimum.
    """

    psi: tuple[Fraction, Fraction]
    beta: tuple[Fraction, Fraction]
    plan: Plan
    unique: bool


@dataclass(frozen=True, eq=False, repr=False)
class Regions:
    """The whole square, in regions; ``exact`` as in `Tradeoff`."""

    regions: tuple[Region, ...]
    exact: bool
    n_solves: int

    @property
    def plans(self) -> list[Plan]:
        """The plans that differ in what the robots do."""
        kept: dict[Any, Plan] = {}
        for region in self.regions:
            kept.setdefault(region.plan.routes, region.plan)
        return list(kept.values())

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row a region: its intervals, the number of its plan in `plans` from 1, metrics."""
        number = {plan.routes: n for n, plan in enumerate(self.plans, start=1)}
        return [
            {
                "psi low": float(region.psi[0]),
                "psi high": float(region.psi[1]),
                "beta low": float(region.beta[0]),
                "beta high": float(region.beta[1]),
                "plan": number[region.plan.routes],
                "unique": region.unique,
                **{entry.name: entry.of(region.plan.metrics) for entry in metrics_of("plans")},
            }
            for region in self.regions
        ]

    def document(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        return {"exact": self.exact, "regions": self.rows}

    def to_frame(self) -> pd.DataFrame:
        """`rows` as a table; the exact ends are in `regions`."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    @property
    def _summary(self) -> str:
        counts = (
            display.counted(len(self.regions), "region"),
            display.counted(len(self.plans), "plan"),
        )
        return f"psi and beta: {counts[0]}, {counts[1]}"

    def __repr__(self) -> str:
        return f"Regions({self._summary})"

    def _repr_html_(self) -> str:
        return display.page(self._summary, display.table("Regions", self.rows))
