"""What ψ and β do to a mission: every assignment that is ever optimal, and where they change.

The cost of Eq. 1 is linear in ψ and that of Eq. 2 in β, so each optimum holds on an interval, and the
intervals are found exactly (`optimise.parametric`), not sampled. Over both at once: ψ decides stage
B2 and through it the data of Eq. 2, so the unit square falls into strips, one per piece of ψ, each
cut by the breakpoints of β there. Within a region the plan stays the same, up to ties.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from ..mission.errors import InputError
from ..mission.instance import Instance
from ..mission.metrics import Metrics
from ..mission.plan import Plan
from ..optimise.frontier import Frontier, frontier, optima
from ..optimise.parametric import Envelope, Family, Line, envelope
from ..optimise.solve import compile_for
from ..planners import plan as make_plan
from ..stages.data import stage_data
from ..stages.options import StagedOptions

Over = Literal["psi", "beta"]
STAGE: dict[str, str] = {"psi": "cluster", "beta": "victim"}
MOST_TIES = 20


@dataclass(frozen=True, eq=False)
class Segment:
    """An interval of the parameter with one optimal line, and the plan that comes of it.

    ``objectives`` are the two that the parameter weighs: the values at 0 and at 1 of what is chosen
    here. ``unique`` says whether nothing else is optimal inside the interval.
    """

    low: Fraction
    high: Fraction
    objectives: tuple[Fraction, Fraction]
    assignment: tuple[tuple[int, ...], ...]
    unique: bool
    plan: Plan

    @property
    def slope(self) -> Fraction:
        """Change of the optimal value over the unit interval."""
        return self.objectives[1] - self.objectives[0]

    def value(self, t: Fraction | float) -> Fraction | float:
        """The optimal value at `t`."""
        return self.objectives[0] + t * self.slope

    @property
    def metrics(self) -> Metrics:
        """Of the plan."""
        return self.plan.metrics


@dataclass(frozen=True, eq=False)
class Tradeoff:
    """All pieces over one parameter.

    Parameters
    ----------
    segments : tuple of Segment
        In order, covering [0, 1].
    ties : dict of Fraction to tuple of assignments
        At each breakpoint all optimal assignments, up to `MOST_TIES`; an assignment lists per robot
        what it takes, by position.
    frontier : Frontier
        Every point that nothing dominates, whether a weight reaches it or not.
    exact : bool
        Whether breakpoints are exact fractions of rational data.
    n_solves : int
        Programs solved for the segments.
    """

    over: str
    model: str
    sense: str
    segments: tuple[Segment, ...]
    ties: dict[Fraction, tuple[tuple[tuple[int, ...], ...], ...]]
    frontier: Frontier
    exact: bool
    n_solves: int

    @property
    def breakpoints(self) -> list[Fraction]:
        """Where the optimum changes."""
        return [segment.low for segment in self.segments[1:]]


@dataclass(frozen=True, eq=False)
class Region:
    """A rectangle of the ψ × β square in which the plan stays the same, up to ties."""

    psi: tuple[Fraction, Fraction]
    beta: tuple[Fraction, Fraction]
    plan: Plan


@dataclass(frozen=True, eq=False)
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


def tradeoff(
    mission: Instance, over: Over = "psi", *, model: str | None = None, **options: Any
) -> Tradeoff:
    """Every piece of the optimal value over ψ (Eq. 1) or β (Eq. 2).

    Parameters
    ----------
    mission : Instance
        What is planned.
    over : {"psi", "beta"}
        The parameter that runs over [0, 1].
    model : str, optional
        The formulation; by default that of the options.
    **options
        Of the staged planner, as for `plan`: a preset, the other parameter, and so on.

    Raises
    ------
    InputError
        If an option is wrong.
    ModelError
        If the formulation's value is not linear in the parameter, so that it has no such pieces.
    """
    if over not in STAGE:
        raise InputError(f"{over!r}; give psi, beta, or both", field="over")
    stage = STAGE[over]
    settings = _settings(options, stage, model)
    chosen = getattr(settings, f"{stage}_model")
    family, pieces = _pieces(mission, over, chosen, settings)
    segments = tuple(
        _segment(mission, over, family, piece.low, piece.high, piece.line, settings)
        for piece in pieces.pieces
    )
    n_solves = pieces.n_solves
    ties = {}
    for t in pieces.breakpoints:
        lines, _ = optima(family, t, most=MOST_TIES)
        ties[t] = tuple(assignment(family, line) for line in lines)
    return Tradeoff(
        over=over,
        model=chosen,
        sense=family.program.sense,
        segments=segments,
        ties=ties,
        frontier=frontier(family, pieces),
        exact=pieces.exact,
        n_solves=n_solves,
    )


def tradeoff_regions(mission: Instance, **options: Any) -> Regions:
    """The regions of the ψ × β square in which the staged plan stays the same.

    The work grows with the number of regions, not with a resolution.

    Parameters
    ----------
    mission : Instance
        What is planned.
    **options
        Of the staged planner, as for `plan`.
    """
    settings = _settings(options, "cluster", None)
    _, strips = _pieces(mission, "psi", settings.cluster_model, settings)
    regions: list[Region] = []
    exact, n_solves = strips.exact, strips.n_solves
    for strip in strips.pieces:
        here = replace(settings, psi=_middle(strip.low, strip.high))
        for low, high in _beta_intervals(mission, here):
            at = replace(here, beta=_middle(low.t, high.t))
            plan = make_plan(mission, **at.as_dict())
            regions.append(Region((strip.low, strip.high), (low.t, high.t), plan))
            exact, n_solves = exact and low.exact, n_solves + low.n_solves
    return Regions(tuple(regions), exact, n_solves)


@dataclass(frozen=True)
class _End:
    t: Fraction
    exact: bool = True
    n_solves: int = 0


def _beta_intervals(mission: Instance, settings: StagedOptions) -> Iterator[tuple[_End, _End]]:
    data = stage_data(mission, "victim", settings)
    if not data.can_serve.any():
        yield _End(Fraction(0)), _End(Fraction(1))
        return
    _, pieces = _pieces(mission, "beta", settings.victim_model, settings)
    for i, piece in enumerate(pieces.pieces):
        cost = pieces.n_solves if i == 0 else 0
        yield _End(piece.low, pieces.exact, cost), _End(piece.high)


def _settings(options: dict[str, Any], stage: str, model: str | None) -> StagedOptions:
    given = dict(options)
    preset = given.pop("preset", "paper")
    if model is not None:
        given[f"{stage}_model"] = model
    return StagedOptions.of(preset, **given)


def _pieces(
    mission: Instance, over: str, model: str, settings: StagedOptions
) -> tuple[Family, Envelope]:
    data = stage_data(mission, STAGE[over], settings)
    family = Family(compile_for(model, data), over)
    return family, envelope(family)


def _segment(
    mission: Instance,
    over: str,
    family: Family,
    low: Fraction,
    high: Fraction,
    line: Line,
    settings: StagedOptions,
) -> Segment:
    middle = (low + high) / 2
    lines, all_of_them = optima(family, middle, most=2)
    changed: dict[str, Any] = {over: _middle(low, high)}
    at = replace(settings, **changed)
    return Segment(
        low=low,
        high=high,
        objectives=(line.at_zero, line.at_one),
        assignment=assignment(family, line),
        unique=len(lines) == 1 and all_of_them,
        plan=make_plan(mission, **at.as_dict()),
    )


def assignment(family: Family, line: Line) -> tuple[tuple[int, ...], ...]:
    """Per robot what it takes at a point, by position: clusters for Eq. 1, victims for Eq. 2."""
    x = family.program.shaped(line.x)["x"]
    return tuple(tuple(int(i) for i in np.flatnonzero(row > 0.5)) for row in x)


def _middle(low: Fraction, high: Fraction) -> float:
    return float((low + high) / 2)
