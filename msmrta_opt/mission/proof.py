r"""What proves a bound on the joint problem: dual values of its relaxation's rows, and its cuts.

No coefficient is stored. Every row is named by what it is about, and whoever checks the proof writes
it out again from the instance (`certify.linear_relaxation`), so a row that does not hold cannot be
claimed. Rows with a dual value of 0 prove nothing and are left out; so a proof is small. Robots and
victims are named by their ids.

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
count: for the makespan, or under an endurance. Dual values are of a minimisation: those of ≤ rows are
at most 0, those of ≥ rows at least 0.

Latency is decomposed by robots (`certify.pricing_bound`): each task has the dual value of its being
served, and densities, which are the dual values of its victim's completion over time. A task is what
one robot will serve in one visit: those requirements of a victim that only one and the same robot can
serve, or else one requirement.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    AliasChoices,
    BaseModel,
    ConfigDict,
    Field,
    NonNegativeInt,
    model_validator,
)

Finite = Annotated[float, Field(allow_inf_nan=False)]
Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


def _renamed(name: str, *earlier: str) -> Any:
    """A field that files of earlier versions name otherwise."""
    return Field(validation_alias=AliasChoices(name, *earlier))


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class _Dual(_Record):
    dual: Finite = _renamed("dual", "price")


class RobotDual(_Dual):
    """The dual value of a robot's row."""

    robot: NonNegativeInt


class VisitDual(RobotDual):
    """The dual value of a row about a robot and a victim."""

    victim: NonNegativeInt


class RequirementDual(_Dual):
    """The dual value of a requirement's row."""

    victim: NonNegativeInt
    kind: str


class ServiceDual(VisitDual):
    """The dual value of a row about a robot that serves a requirement."""

    kind: str


class PathCut(RobotDual):
    """A cut of a robot and a set of victims, and its dual value."""

    victims: tuple[NonNegativeInt, ...]


class SubtourCut(PathCut):
    """A cut of a robot, a set of victims and one victim, and its dual value."""

    victim: NonNegativeInt


class RootProof(_Record):
    """The dual values that prove a bound on the joint problem without any branching.

    ``bound`` is what they prove, rounded up to a value that the objective can take; ``solver`` is
    who found them.
    """

    objective: Literal["total_time", "makespan"]
    bound: Finite
    solver: str
    degree: tuple[VisitDual, ...] = ()
    leaves: tuple[RobotDual, ...] = ()
    ends: tuple[RobotDual, ...] = ()
    served: tuple[RequirementDual, ...] = ()
    present: tuple[ServiceDual, ...] = ()
    walk: tuple[RobotDual, ...] = ()
    endurance: tuple[RobotDual, ...] = ()
    makespan: tuple[RobotDual, ...] = ()
    subtour: tuple[SubtourCut, ...] = ()
    outside: tuple[SubtourCut, ...] = ()
    first: tuple[PathCut, ...] = ()
    last: tuple[PathCut, ...] = ()

    @property
    def n_cuts(self) -> int:
        """Number of cuts with a dual value."""
        return len(self.subtour) + len(self.outside) + len(self.first) + len(self.last)


class TaskDuals(_Record):
    """The dual value of serving a task, and its density between its victim's breakpoints.

    Until the task is done, each unit of time costs the density of then.
    """

    victim: NonNegativeInt
    kinds: tuple[str, ...]
    dual: Finite = _renamed("dual", "reward")
    densities: tuple[Time, ...] = _renamed("densities", "charges")


class Breakpoints(_Record):
    """Where the densities of a victim's tasks may change, in time units; 0 is left out."""

    victim: NonNegativeInt
    times: tuple[Time, ...] = _renamed("times", "begin")


class Neighbourhood(_Record):
    """The victims that a robot remembers having visited for as long as it is at this one."""

    robot: NonNegativeInt
    victim: NonNegativeInt
    remembers: tuple[NonNegativeInt, ...]


class PricingRound(_Record):
    """Dual values, and the ng-route relaxation that they are for.

    Victims that are not among `breakpoints` have none; neighbourhoods hold their own victim unsaid.
    """

    tasks: tuple[TaskDuals, ...] = _renamed("tasks", "needs")
    breakpoints: tuple[Breakpoints, ...] = Field(
        default=(), validation_alias=AliasChoices("breakpoints", "steps")
    )
    neighbourhoods: tuple[Neighbourhood, ...] = ()


class TimeStep(_Record):
    """The step of time to whole multiples of which a robot's legs and services are rounded down."""

    robot: NonNegativeInt
    length: Annotated[float, Field(gt=0, allow_inf_nan=False)]


class LatencyProof(_Record):
    """The dual values that prove a bound on latency without any branching, round by round.

    Each round rules out what no better plan than the one at hand does, for those after it. ``bound``
    is what they prove together, rounded up to a value that latency can take.
    """

    bound: Finite
    solver: str
    time_steps: tuple[TimeStep, ...] = _renamed("time_steps", "clocks")
    rounds: Annotated[tuple[PricingRound, ...], Field(min_length=1)]


class Branch(_Record):
    """One side of a branch of the tree of a latency's proof.

    Of a robot: on the high side it serves the task, on the low one it does not. Of a time: on the low
    side the task is done by then, on the high one later.
    """

    victim: NonNegativeInt
    kinds: tuple[str, ...]
    robot: NonNegativeInt | None = None
    until: Time | None = None
    high: bool

    @model_validator(mode="after")
    def _of_one(self) -> Branch:
        if (self.robot is None) == (self.until is None):
            raise ValueError("a branch is of a robot or of a time")
        return self

    @property
    def what(self) -> tuple[object, ...]:
        """What is branched on."""
        return self.victim, tuple(sorted(self.kinds)), self.robot, self.until


class LatencyLeaf(_Record):
    """A leaf: the branches from the root to it, and the dual values that prove that nothing is there."""

    branches: tuple[Branch, ...]
    duals: PricingRound


class LatencyTree(_Record):
    """The whole proof of a latency: what precedes branching, and the leaves from low to high."""

    format: Literal["msmrta-latency-proof/1"] = "msmrta-latency-proof/1"
    root: LatencyProof | None
    """``None`` where what follows from the requirements alone is enough."""
    leaves: tuple[LatencyLeaf, ...] = ()


class ProofFile(_Record):
    """What a file proves of a plan, to the last branch, and what that took; the file is apart.

    ``digest`` is the file's SHA-256, ``size`` its bytes; seconds are of finding and of checking it.
    """

    status: Literal["proved", "partial"]
    bound: Finite
    digest: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    size: NonNegativeInt
    leaves: NonNegativeInt
    seconds: Time
    check_seconds: Time
    remark: str = ""
    """Why not all is proved; empty if it is."""

    @property
    def summary(self) -> str:
        """What is proved and what it took, in words."""
        leaves = "1 leaf" if self.leaves == 1 else f"{self.leaves} leaves"
        took = f"{leaves}, {self.size} bytes, {self.seconds:.1f} s"
        if self.status == "proved":
            return f"proved ({took})"
        return f"proved up to {self.bound:.9g} ({took}): {self.remark}"
