r"""What proves a bound on the joint problem: the prices of its linear relaxation's rows, and its cuts.

No coefficient is stored. Every row is named by what it is about, and whoever checks the proof writes
it out again from the instance (`bounds.duality`), so a row that does not hold cannot be claimed. Rows of
price 0 prove nothing and are left out; so a proof is small. Robots and victims are named by their ids.

With y for the visits of a robot, f and l for its first and last victim, e for the edges it walks
between victims, in either direction, a for who serves what, and T for the makespan, the rows are

    degree     Σ e at v + f[v] + l[v] = 2 y[v]                 for a robot and a victim v
    leaves     Σ f ≤ 1                                         for a robot
    ends       Σ f = Σ l                                       for a robot
    served     Σ y of the robots able ≥ 1, or Σ a = 1          for a victim and a kind
    present    a ≤ y                                           for a robot, a victim and a kind
    walk       travel ≤ longest walk                           for a robot
    endurance  travel + service ≤ endurance                    for a robot
    makespan   travel + service ≤ T                            for a robot
    subtour    e(S) ≤ y(S) − y[v]                              for a robot, victims S, and v in S
    outside    e(S) + f(S) + l(S) ≤ y(S) − y[v] + Σ f          for a robot, victims S, v not in S
    first      e(S) + f(S) ≤ y(S)                              for a robot and victims S
    last       e(S) + l(S) ≤ y(S)                              for a robot and victims S

where e(S) are the edges with both ends in S. The ``a`` and their rows are there only where loads
count: for the makespan, or under an endurance. Prices are of a minimisation: those of ≤ rows are at
most 0, those of ≥ rows at least 0.

Latency has prices of another kind (`bounds.pricing`): a reward for serving a need, charges for when it
is done, and robots' routes that are cheapest at these. A need is what one robot will serve in one visit:
those requirements of a victim that only one and the same robot can serve, or else one requirement.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt

Price = Annotated[float, Field(allow_inf_nan=False)]
Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class RobotPrice(_Record):
    """The price of a robot's row."""

    robot: NonNegativeInt
    price: Price


class VisitPrice(_Record):
    """The price of a row about a robot and a victim."""

    robot: NonNegativeInt
    victim: NonNegativeInt
    price: Price


class RequirementPrice(_Record):
    """The price of a requirement's row."""

    victim: NonNegativeInt
    kind: str
    price: Price


class ServicePrice(_Record):
    """The price of a row about a robot that serves a requirement."""

    robot: NonNegativeInt
    victim: NonNegativeInt
    kind: str
    price: Price


class PathCut(_Record):
    """A cut of a robot and a set of victims, and its price."""

    robot: NonNegativeInt
    victims: tuple[NonNegativeInt, ...]
    price: Price


class SubtourCut(PathCut):
    """A cut of a robot, a set of victims and one victim, and its price."""

    victim: NonNegativeInt


class RootProof(_Record):
    """The prices that prove a bound on the joint problem without any branching.

    ``bound`` is what they prove, rounded up to a value that the objective can take; ``solver`` is
    who found them.
    """

    objective: Literal["total_time", "makespan"]
    bound: Price
    solver: str
    degree: tuple[VisitPrice, ...] = ()
    leaves: tuple[RobotPrice, ...] = ()
    ends: tuple[RobotPrice, ...] = ()
    served: tuple[RequirementPrice, ...] = ()
    present: tuple[ServicePrice, ...] = ()
    walk: tuple[RobotPrice, ...] = ()
    endurance: tuple[RobotPrice, ...] = ()
    makespan: tuple[RobotPrice, ...] = ()
    subtour: tuple[SubtourCut, ...] = ()
    outside: tuple[SubtourCut, ...] = ()
    first: tuple[PathCut, ...] = ()
    last: tuple[PathCut, ...] = ()

    @property
    def n_cuts(self) -> int:
        """Number of cuts with a price."""
        return len(self.subtour) + len(self.outside) + len(self.first) + len(self.last)


class NeedPrices(_Record):
    """Reward of a need, and what each unit of time until it is done is charged, step by step."""

    victim: NonNegativeInt
    kinds: tuple[str, ...]
    reward: Price
    charges: tuple[Time, ...]


class VictimSteps(_Record):
    """Where the steps of a victim's charges begin, after the first, which begins at 0."""

    victim: NonNegativeInt
    begin: tuple[Time, ...]


class Neighbourhood(_Record):
    """The victims that a robot remembers having visited for as long as it is at this one."""

    robot: NonNegativeInt
    victim: NonNegativeInt
    remembers: tuple[NonNegativeInt, ...]


class PriceRound(_Record):
    """Prices, and the routes that they are for.

    Victims that are not among `steps` have one step; neighbourhoods hold their own victim unsaid.
    """

    needs: tuple[NeedPrices, ...]
    steps: tuple[VictimSteps, ...] = ()
    neighbourhoods: tuple[Neighbourhood, ...] = ()


class RobotStep(_Record):
    """The steps of time that a robot's legs and services are rounded down to."""

    robot: NonNegativeInt
    length: Annotated[float, Field(gt=0, allow_inf_nan=False)]


class LatencyProof(_Record):
    """The prices that prove a bound on latency without any branching, round by round.

    Each round rules out what no better plan than the one at hand does, for those after it. ``bound``
    is what they prove together, rounded up to a value that latency can take.
    """

    bound: Price
    solver: str
    clocks: tuple[RobotStep, ...]
    rounds: Annotated[tuple[PriceRound, ...], Field(min_length=1)]
