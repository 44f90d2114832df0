"""What a parameter does to a mission: every assignment that is ever optimal, and where they change.

The cost of Eq. 1 is linear in ψ and that of Eq. 2 in β, and those of other formulations may be linear in
parameters of their own. Each optimum then holds on an interval, and the intervals are found exactly
(`optimise.parametric`), not sampled. Over ψ and β at once: ψ decides stage B2 and through it the data of
Eq. 2, so the unit square falls into strips, one per piece of ψ, each cut by the breakpoints of β there.
Within a region the plan stays the same, up to ties.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeVar, overload

import numpy as np

from ...interruption import interrupted
from ...mission.errors import InputError, MsmrtaError, SolverError
from ...mission.instance import Instance, require_mission
from ...mission.plan import Plan
from ...optimise import registry
from ...optimise.compile import compile_for
from ...optimise.frontier import frontier, optima
from ...optimise.parametric import Envelope, Family, Line, Piece, envelope
from ...optimise.solve import solve
from ...planners import plan as make_plan
from ...stages.data import stage_data
from ...stages.options import StagedOptions
from .tradeoff_results import Assignment, Region, Regions, Segment, Tradeoff

STAGES = ("cluster", "victim")
"""Whose formulations may have a parameter to trade off: those that say who takes what."""
Item = TypeVar("Item")
Done = TypeVar("Done")
MAX_TIES = 20
"""Maximum number of optimal assignments that are reported of one breakpoint."""


@overload
def tradeoff(
    mission: Instance, over: str = ..., *, model: str | None = ..., **options: Any
) -> Tradeoff: ...
@overload
def tradeoff(
    mission: Instance, over: tuple[str, str] | list[str], *, model: None = ..., **options: Any
) -> Regions: ...
def tradeoff(
    mission: Instance,
    over: str | tuple[str, str] | list[str] = "psi",
    *,
    model: str | None = None,
    **options: Any,
) -> Tradeoff | Regions:
    """Every piece of the optimal value over a parameter, or every region over ψ and β.

    Parameters
    ----------
    mission : Instance
        What is planned.
    over : str, or ("psi", "beta")
        The parameter that runs over its range, ψ of Eq. 1 or β of Eq. 2 or one of the formulation's
        own; or both ψ and β.
    model : str, optional
        The formulation, of stage cluster or victim; by default that of the options which has the
        parameter. Over both give ``cluster_model`` and ``victim_model`` instead.
    **options
        Of the staged planner, as for `plan`: a preset, other parameters, and so on.

    Returns
    -------
    Tradeoff or Regions
        `Regions` over both, as `tradeoff_regions`.

    Raises
    ------
    InputError
        If an option is wrong, or no formulation has the parameter.
    ModelError
        If the formulation's value is not linear in the parameter, so that it has no such pieces.
    """
    if isinstance(over, (tuple, list)) and sorted(map(str, over)) == ["beta", "psi"]:
        if model is not None:
            raise InputError(
                f"{model!r}; over both give cluster_model and victim_model", field="model"
            )
        return tradeoff_regions(mission, **options)
    if not isinstance(over, str):
        raise InputError(f"{over!r}; give a parameter, or psi and beta", field="over")
    settings = _settings(options, model)
    stage, chosen = _formulation(over, model, settings)
    problem = _first(mission, over, stage, chosen, settings)
    family, pieces = problem.family, problem.envelope
    segments = _in_time(pieces.pieces, lambda piece: _segment(problem, piece))
    if not segments:
        raise KeyboardInterrupt  # which alone leaves none
    breakpoints = [piece.low for piece in pieces.pieces[1 : len(segments)]]
    found = _in_time(breakpoints, lambda t: (t, *optima(family, t, maximum=MAX_TIES)))
    front = frontier(family, pieces)
    return Tradeoff(
        over=over,
        model=chosen,
        sense=family.program.sense,
        segments=tuple(segments),
        ties={
            family.parameter(t): tuple(assignment(family, line) for line in lines)
            for t, lines, _ in found
        },
        more_ties=frozenset(family.parameter(t) for t, _, are_all in found if not are_all),
        frontier=front,
        frontier_assignments=tuple(assignment(family, point.line) for point in front.points),
        names=_names(stage, segments[0].plan),
        exact=pieces.exact,
        n_solves=pieces.n_solves,
        stage=stage,
        span=(family.low, family.high),
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

    Raises
    ------
    InputError
        If an option is wrong.
    ModelError
        If a formulation's value is not linear in its parameter.
    """
    settings = _settings(options, None)
    eq1 = _first(mission, "psi", "cluster", settings.cluster_model, settings)
    strips = _in_time(eq1.envelope.pieces, lambda strip: _strip(mission, settings, eq1, strip))
    regions = tuple(region for found, _ in strips for region in found)
    if not regions:
        raise KeyboardInterrupt  # which alone leaves none
    envelopes = [eq1.envelope, *(eq2 for _, eq2 in strips if eq2 is not None)]
    return Regions(regions, all(x.exact for x in envelopes), sum(x.n_solves for x in envelopes))


def _strip(
    mission: Instance, settings: StagedOptions, eq1: _Problem, strip: Piece
) -> tuple[list[Region], Envelope | None]:
    """The regions over one piece of ψ, and the envelope of Eq. 2 there, if it has anything to decide."""
    here = replace(settings, psi=_middle(strip.low, strip.high))
    one_post, pieces = eq1.is_unique(strip), [(Fraction(0), Fraction(1), True)]
    eq2 = None
    if stage_data(mission, "victim", here).can_serve.any():
        problem = _Problem(mission, "beta", "victim", here.victim_model, here)
        eq2 = problem.envelope
        pieces = _in_time(eq2.pieces, lambda x: (x.low, x.high, problem.is_unique(x)))

    def region(piece: tuple[Fraction, Fraction, bool]) -> Region:
        low, high, one_choice = piece
        plan = make_plan(mission, **replace(here, beta=_middle(low, high)).as_dict())
        return Region((strip.low, strip.high), (low, high), plan, one_post and one_choice)

    return _in_time(pieces, region), eq2


def _first(*what: Any) -> _Problem:
    """The `_Problem`, unless `interruption` left no time to solve even the ends of its range."""
    try:
        return _Problem(*what)
    except SolverError:
        if interrupted():
            raise KeyboardInterrupt from None
        raise


def _in_time(items: Iterable[Item], do: Callable[[Item], Done]) -> list[Done]:
    """What comes of each of `items`, until `interruption`: of those that are whole by then."""
    done: list[Done] = []
    for item in items:
        if interrupted():
            break
        try:
            done.append(do(item))
        except MsmrtaError:  # a solver that was interrupted has no proven optimum
            if not interrupted():
                raise
            break
    return done


class _Problem:
    """One stage's formulation on a mission, solved for all values of its parameter."""

    def __init__(
        self, mission: Instance, over: str, stage: str, model: str, settings: StagedOptions
    ) -> None:
        self.mission, self.over, self.settings = require_mission(mission), over, settings
        self.model = registry.for_plans(model, stage)
        self.data = stage_data(mission, stage, settings)
        self.others = settings.values_for(self.model)
        self.family = Family(compile_for(self.model, self.data), over, **self.others)
        self.envelope = envelope(self.family)

    def is_unique(self, piece: Piece) -> bool:
        """Whether nothing else is optimal inside `piece`."""
        lines, all_of_them = optima(self.family, (piece.low + piece.high) / 2, maximum=2)
        return len(lines) == 1 and all_of_them

    def chosen_by_planner(self, piece: Piece) -> Line:
        """What the planner takes in the middle of `piece`, where several points are optimal."""
        middle = {**self.others, self.over: self.middle(piece)}
        values = solve(self.model, self.data, **middle).require().values
        line = self.family.line(self.family.program.flat(values))
        return line if line.same_line(piece.line) else piece.line

    def middle(self, piece: Piece) -> float:
        """The parameter in the middle of `piece`."""
        return float(self.family.parameter((piece.low + piece.high) / 2))


def _settings(options: dict[str, Any], model: str | None) -> StagedOptions:
    given = dict(options)
    preset = given.pop("preset", "paper")
    if model is not None:
        stage = registry.get(model).spec.stage
        if stage not in STAGES:
            raise InputError(
                f"{model!r} is of stage {stage!r}; give one of {' or '.join(STAGES)}", field="model"
            )
        given[f"{stage}_model"] = model
    return StagedOptions.of(preset, **given)


def _formulation(over: str, model: str | None, settings: StagedOptions) -> tuple[str, str]:
    """The stage and the name of the formulation whose parameter `over` is.

    Raises
    ------
    InputError
        If none of them has it.
    """
    chosen = [(stage, getattr(settings, f"{stage}_model")) for stage in STAGES]
    if model is not None:
        chosen = [item for item in chosen if item[1] == model]
    there = {name: registry.get(name).spec.parameters for _, name in chosen}
    for stage, name in chosen:
        if over in there[name]:
            return stage, name
    known = "; ".join(f"{name} has {', '.join(of) or 'none'}" for name, of in there.items())
    raise InputError(f"{over!r} is no parameter: {known}", field="over")


def _segment(problem: _Problem, piece: Piece) -> Segment:
    line = problem.chosen_by_planner(piece)
    family = problem.family
    options = {**problem.settings.as_dict(), problem.over: problem.middle(piece)}
    return Segment(
        low=family.parameter(piece.low),
        high=family.parameter(piece.high),
        span=(family.low, family.high),
        objectives=(line.at_zero, line.at_one),
        assignment=assignment(problem.family, line),
        unique=problem.is_unique(piece),
        plan=make_plan(problem.mission, **options),
    )


def _names(stage: str, plan: Plan) -> tuple[str, ...]:
    if stage == "cluster":
        return tuple(f"C{c}" for c in range(len(plan.clusters)))
    missed = plan.scouting.not_found if plan.scouting else ()
    return tuple(f"v{victim.id}" for victim in plan.instance.victims if victim.id not in missed)


def assignment(family: Family, line: Line) -> Assignment:
    """Per robot what it takes at a point, by position: clusters for Eq. 1, victims for Eq. 2."""
    x = family.program.shaped(line.x)["x"]
    return tuple(tuple(int(i) for i in np.flatnonzero(row > 0.5)) for row in x)


def _middle(low: Fraction, high: Fraction) -> float:
    return float((low + high) / 2)
