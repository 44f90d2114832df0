r"""Dual values that decompose a latency into one problem per robot.

A victim v with tasks g, done at t_g, is complete at max_g t_g. For any densities

    mu_g(t) >= 0   with   sum over the tasks g of v of mu_g(t) = priority_v   at every time t,

the costs phi_g(t) = integral of mu_g from 0 to t satisfy

    priority_v max_g t_g >= sum_g phi_g(t_g),

since at each time before t_g only what is not yet done costs. So a cost for every task by itself
bounds the latency from below, and robots come apart. Constant densities would only average the tasks'
times; densities that change over time bound their maximum. They are steps here: constant between
breakpoints, which are put where they help (`breakpoints`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Bools, Floats, Ints
from .tasks import Tasks


@dataclass(frozen=True, eq=False)
class Duals:
    """Dual values of serving tasks, and the densities of what they cost until they are done."""

    value: Floats
    """Of each task's being served, at least 0, ``(n_tasks,)``."""
    density: tuple[Floats, ...]
    """mu_g between the breakpoints of g's victim, ``(n_breakpoints,)`` for each task."""
    breakpoints: tuple[Floats, ...]
    """Of each victim, the first at 0."""
    victim: tuple[int, ...]
    """The victim of each task."""

    def reduced_cost(self, task: int, times: Floats) -> Floats:
        """phi_g(t) at `times`, less the dual value."""
        parts = time_in_intervals(self.breakpoints[self.victim[task]], times)
        return np.asarray(parts @ self.density[task] - self.value[task])

    @classmethod
    def zero(
        cls, priority: Floats, breakpoints: tuple[Floats, ...], victim: tuple[int, ...]
    ) -> Duals:
        """Dual values of 0, and the same density for all tasks of a victim."""
        share = [priority[v] / victim.count(v) for v in victim]
        density = tuple(
            np.full(len(breakpoints[v]), part) for v, part in zip(victim, share, strict=True)
        )
        return cls(np.zeros(len(victim)), density, breakpoints, victim)

    def on(self, breakpoints: tuple[Floats, ...]) -> Duals:
        """The same with other breakpoints; between these, each density is the first there."""
        density = tuple(
            own[np.searchsorted(self.breakpoints[v], breakpoints[v], side="right") - 1]
            for v, own in zip(self.victim, self.density, strict=True)
        )
        return replace(self, density=density, breakpoints=breakpoints)

    def towards(self, other: Duals, share: float) -> Duals:
        """A `share` of the way to `other`, which has the same breakpoints."""
        density = tuple(
            (1 - share) * mine + share * theirs
            for mine, theirs in zip(self.density, other.density, strict=True)
        )
        return replace(self, value=(1 - share) * self.value + share * other.value, density=density)

    def scaled(self, time: float, priority: float) -> Duals:
        """The same in units of which these are so many times as large."""
        return Duals(
            self.value * (time * priority),
            tuple(density * priority for density in self.density),
            tuple(own * time for own in self.breakpoints),
            self.victim,
        )


def time_in_intervals(breakpoints: Floats, times: Floats) -> Floats:
    """How much of each interval lies before each time, ``(..., n_breakpoints)``."""
    length = np.append(np.diff(breakpoints), np.inf)
    return np.clip(np.asarray(times)[..., None] - breakpoints, 0.0, length)


@dataclass(frozen=True, eq=False)
class Round:
    """The dual values that a round of column generation ended with, and its neighbourhoods."""

    duals: Duals
    neighbours: dict[int, tuple[Ints, Bools]]
    """By robot: its victims ``(m,)``, and which of them it remembers at which, ``(m, m)``."""


@dataclass(frozen=True, eq=False)
class LatencyRoot:
    """What was proved before branching, round by round, and by what.

    Every round but the first is on networks in which those before it ruled out what no solution
    better than the incumbent does.
    """

    value: float
    """No solution better than the incumbent is worth less."""
    tasks: Tasks
    time_steps: dict[int, float]
    """By robot."""
    rounds: tuple[Round, ...]
