r"""Prices that take a latency apart into one problem per robot.

A victim v with needs g, done at t_g, is complete at max_g t_g. For any densities

    mu_g(t) >= 0   with   sum over the needs g of v of mu_g(t) = priority_v   at every time t,

the charges phi_g(t) = integral of mu_g from 0 to t satisfy

    priority_v max_g t_g >= sum_g phi_g(t_g),

since at each time before t_g only what is not yet done is charged. So charging every need by itself
bounds the latency from below, and robots come apart. Constant densities would only average the needs'
times; densities that change over time bound their maximum. They are steps here: constant between
breakpoints, which are put where they help (`latency_master`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Bools, Floats, Ints
from .tasks import Needs


@dataclass(frozen=True, eq=False)
class Prices:
    """Rewards for serving needs, charges for when they are done."""

    reward: Floats
    """Of each need, at least 0, ``(n_needs,)``."""
    density: tuple[Floats, ...]
    """mu_g between the breakpoints of g's victim, ``(n_breaks,)`` for each need."""
    breaks: tuple[Floats, ...]
    """Where each victim's steps begin, the first at 0."""
    victim: tuple[int, ...]
    """The victim of each need."""

    def charge(self, need: int, times: Floats) -> Floats:
        """phi_g(t) at `times`, less the reward."""
        steps = portions(self.breaks[self.victim[need]], times)
        return np.asarray(steps @ self.density[need] - self.reward[need])

    @classmethod
    def without_reward(
        cls, priority: Floats, breaks: tuple[Floats, ...], victim: tuple[int, ...]
    ) -> Prices:
        """Prices that reward nothing, and charge the needs of a victim alike."""
        share = [priority[v] / victim.count(v) for v in victim]
        density = tuple(
            np.full(len(breaks[v]), part) for v, part in zip(victim, share, strict=True)
        )
        return cls(np.zeros(len(victim)), density, breaks, victim)

    def on(self, breaks: tuple[Floats, ...]) -> Prices:
        """The same prices with other breakpoints; between these, each density is the first there."""
        density = tuple(
            own[np.searchsorted(self.breaks[v], breaks[v], side="right") - 1]
            for v, own in zip(self.victim, self.density, strict=True)
        )
        return Prices(self.reward, density, breaks, self.victim)

    def towards(self, other: Prices, share: float) -> Prices:
        """Prices a `share` of the way to `other`, which has the same breakpoints."""
        return Prices(
            (1 - share) * self.reward + share * other.reward,
            tuple(
                (1 - share) * mine + share * theirs
                for mine, theirs in zip(self.density, other.density, strict=True)
            ),
            self.breaks,
            self.victim,
        )


def portions(breaks: Floats, times: Floats) -> Floats:
    """How much of each step lies before each time, ``(..., n_breaks)``."""
    length = np.append(np.diff(breaks), np.inf)
    return np.clip(np.asarray(times)[..., None] - breaks, 0.0, length)


@dataclass(frozen=True, eq=False)
class Round:
    """The prices that a round of column generation ended with, and what paths remembered then."""

    prices: Prices
    neighbours: dict[int, tuple[Ints, Bools]]
    """By robot: its victims ``(m,)``, and which of them it remembers at which, ``(m, m)``."""


@dataclass(frozen=True, eq=False)
class LatencyRoot:
    """What was proved before branching, round by round, and by what.

    Every round but the first is on networks in which those before it ruled out what no answer better
    than the incumbent does.
    """

    value: float
    """No answer better than the incumbent is worth less."""
    needs: Needs
    clocks: dict[int, float]
    """The robots' steps of time."""
    rounds: tuple[Round, ...]
