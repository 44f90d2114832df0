"""Tuning parameters: what trades one part of a search against another, never what is right.

One frozen dataclass a method, and all of them in `Parameters`, which can be read from TOML:

    [heuristics]
    average_removed = 12
    [branch_and_cut]
    separation_tolerance = 0.05
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, field
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from annotated_types import Ge, Gt, Le, Lt
from pydantic import AllowInfNan, ConfigDict, Strict, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from ..mission.errors import InputError
from ..mission.files import read_toml
from ..mission.validation import first_problem

_Number = Annotated[float, Strict(), AllowInfNan(False)]
Share = Annotated[_Number, Ge(0), Le(1)]
Count = Annotated[int, Strict(), Ge(1)]
Positive = Annotated[_Number, Gt(0)]
NonNegative = Annotated[_Number, Ge(0)]
Factor = Annotated[_Number, Gt(1)]

_CONFIG = ConfigDict(extra="forbid")


@dataclass(frozen=True, config=_CONFIG)
class HeuristicsParameters:
    """Ruin and recreate, and fix-and-optimise on robot subsets and victim regions."""

    average_removed: Count = 8
    """Visits that a ruin takes out on average."""
    longest_string: Count = 8
    """Consecutive visits that a ruin takes out of one route, at the maximum."""
    blink: Share = 0.02
    """Probability of passing over a place when a requirement is put back."""
    perturbed_steps: Share = 0.2
    """Share of the steps in which insertion costs are perturbed, and of the robots whose cost is
    lowered there: the cost is that of one requirement, and does not see that others would come cheap
    after it."""
    first_temperature: Positive = 2e-2
    """Of simulated annealing, relative to one robot's share of the objective."""
    last_temperature: Positive = 1e-4
    """The same, when the search ends."""
    first_share: Share = 0.1
    """Share of the time for ruin and recreate before an exact method begins."""
    first_seconds: NonNegative = 0.05
    """Seconds of that per victim, at the maximum."""
    neighbours: Count = 100
    """Nearest victims around which a ruin looks for routes, and an insertion for robots."""
    candidates: Count = 10
    """Robots that are asked to serve a requirement, where more than these can."""
    default_iterations: Count = 20_000
    """Iterations where neither time nor iterations are limited."""
    smallest_subset: Count = 3
    """Robots of a subset to begin with."""
    largest_subset: Count = 7
    """Robots of a subset at last."""
    subset_failures: Count = 10
    """Subsets in a row that bring nothing, after which they grow by a robot."""
    subset_seconds: Positive = 10.0
    """Seconds for one subset at the maximum."""
    subset_share: Share = 0.25
    """Share of the time for all subsets that one may take."""
    smallest_region: Count = 40
    """Victims of a region to begin with."""
    smallest_region_share: Share = 0.4
    """Share of all victims that a region has to begin with, at the maximum."""
    region_growth: Factor = 1.1
    """Factor by which a region grows after an easy one, and shrinks after one that was too hard."""
    region_seconds: Positive = 5.0
    """Seconds for the program of a region at the maximum."""
    region_failures: Count = 25
    """Regions in a row that bring nothing, after which the search leaves off."""


@dataclass(frozen=True, config=_CONFIG)
class BranchAndCutParameters:
    """The edge formulation: cutting planes, fix-and-optimise, and the search tree."""

    maximum_edges: Count = 1_000_000
    """Of all robots, beyond which the formulation takes too long to write down: there is none."""
    neighbours: Count = 6
    """Edges per robot and victim that the relaxation starts with."""
    purge_after: Count = 4
    """Rounds that a cut may be slack before it is purged."""
    cuts_per_robot: Count = 25
    """Cuts of one robot that are added in one round at the root."""
    remembered_points: Count = 15
    """Last points of the relaxation whose edges restricted programs take in."""
    root_tolerance: Positive = 1e-2
    """Violation from which on a cut is added at the root."""
    tailing_off_rounds: Count = 15
    """Rounds at the root that together must raise the bound by `tailing_off_gain`."""
    tailing_off_gain: NonNegative = 2e-5
    """Relative to the bound."""
    separation_tolerance: Positive = 0.02
    """Violation from which on a cut is added at fractional points of the tree."""
    tree_cuts_per_robot: Count = 10
    """Cuts of one robot that are added at once in the tree."""
    time_weight: NonNegative = 1e-3
    """Weight of all robots' times together beside the makespan, at the maximum."""
    polish_above_gap: Share = 0.005
    """Gap from which on ruin and recreate comes before restricted programs."""
    polish_share: Share = 0.2
    """Share of the time left for ruin and recreate after the root."""
    polish_seconds: NonNegative = 30.0
    """Seconds of that at the maximum."""
    many_robots: Count = 6
    """Robots from which on fix-and-optimise comes before the tree."""
    restricted_share: Share = 0.3
    """Share of the time left for the restricted program where there are fewer; it takes no longer than
    all before it."""
    incumbent_share: Share = 0.85
    """Share of the time left for fix-and-optimise where there are as many."""
    incumbent_seconds: NonNegative = 60.0
    """Seconds of that at the maximum."""
    program_share: Share = 0.4
    """Share of what is left of these for one restricted program."""
    subsets_share: Share = 0.4
    """Share of what is left of these for subsets of robots."""
    easy_share: Share = 0.2
    """Share of its limit that an easy program takes at the maximum."""
    reduced_costs: tuple[NonNegative, ...] = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
    """Reduced costs up to which restricted programs take columns in, one after the other, as shares
    of what is open; before these, none."""


@dataclass(frozen=True, config=_CONFIG)
class BranchAndPriceParameters:
    """Column generation over ng-routes, enumeration and branching."""

    first_neighbourhood: Count = 4
    """Victims in a neighbourhood to begin with, itself included."""
    largest_neighbourhood: Annotated[Count, Le(47)] = 40
    """Victims in a neighbourhood at the maximum."""
    maximum_steps: Annotated[Count, Le(20_000)] = 4000
    """Of time up to a robot's horizon; beyond them times are rounded down to coarser ones."""
    maximum_cells: Count = 20_000_000
    """States times steps of one network, beyond which neighbourhoods grow no more."""
    paths_per_pricing: Count = 10
    """Paths taken from one network at one set of dual values."""
    smoothing: Annotated[NonNegative, Lt(1)] = 0.6
    """Share that dual values keep of the best so far."""
    first_tolerance: Positive = 2e-2
    """Relative to the incumbent's value: how well column generation converges at first."""
    tolerance_factor: Annotated[Positive, Lt(1)] = 0.3
    """Of the next round's tolerance."""
    last_tolerance: Positive = 5e-5
    """At the root, at last."""
    node_tolerance: Positive = 3e-4
    """After branching."""
    growing_tolerance: Positive = 1e-3
    """From which on neighbourhoods grow."""
    notable_share: Share = 0.01
    """Share of a path in the relaxation from which on its cycles make neighbourhoods grow."""
    breakpoint_gain: Share = 0.03
    """Share of the open gap that new breakpoints must bring for another round."""
    maximum_breakpoints: Count = 8
    """Of a victim, from which on those that do nothing are taken out."""
    artificial_cost: Positive = 3.0
    """Cost of an artificial variable at first, in mean completion times."""
    largest_artificial_cost: Positive = 4.0
    """At last, in values of the incumbent."""
    artificial_factor: Factor = 4.0
    """By which it is raised where it is too low."""
    maximum_options: Count = 256
    """Sets of tasks that a robot may serve in one visit, beyond which there is no column generation."""
    maximum_labels: Count = 30_000
    """Labels of one robot beyond which enumeration is given up."""
    maximum_routes: Count = 4_000
    """Routes of all robots that are enumerated for one program at the maximum."""
    compared_labels: Count = 12
    """Labels that one is compared with for dominance."""
    undecided_share: Share = 0.05
    """Distance from the nearest whole number from which on branching is on who serves."""
    selection_share: Share = 0.02
    """Share of the time left for choosing among the paths known."""
    enumeration_share: Share = 0.2
    """Share of the time left for choosing among all routes that matter."""
    polish_share: Share = 0.1
    """Share of the time left for ruin and recreate."""
    polish_seconds: NonNegative = 20.0
    """Seconds of that at the maximum."""


@dataclass(frozen=True, config=_CONFIG)
class Parameters:
    """Those of all methods."""

    heuristics: HeuristicsParameters = field(default_factory=HeuristicsParameters)
    branch_and_cut: BranchAndCutParameters = field(default_factory=BranchAndCutParameters)
    branch_and_price: BranchAndPriceParameters = field(default_factory=BranchAndPriceParameters)

    @classmethod
    def read(cls, path: str | Path) -> Parameters:
        """Those of a TOML file; what it leaves out keeps its default.

        Raises
        ------
        InputError
            If the file cannot be read, or names or values are wrong.
        """
        try:
            return cls.of(read_toml(path))
        except InputError as error:
            raise error.within(path) from None

    @classmethod
    def of(cls, given: Parameters | Mapping[str, Any] | None) -> Parameters:
        """Those that are given, by names of methods and parameters; the others at their defaults.

        Raises
        ------
        InputError
            If there is no such parameter, or its value is out of range.
        """
        try:
            return given if isinstance(given, cls) else _adapter().validate_python(given or {})
        except ValidationError as error:
            raise first_problem(error) from None

    def changed(self) -> dict[str, dict[str, Any]]:
        """Those that are not at their defaults, by names of methods and parameters."""
        methods = asdict(Parameters())
        changed = {
            method: {name: x for name, x in values.items() if x != methods[method][name]}
            for method, values in asdict(self).items()
        }
        return {method: values for method, values in changed.items() if values}


@cache
def _adapter() -> TypeAdapter[Parameters]:
    return TypeAdapter(Parameters)
