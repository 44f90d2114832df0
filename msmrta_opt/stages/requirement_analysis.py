"""Requirement analysis (Algorithm 2) and missing capabilities (Algorithm 1, MissingCap).

Who can satisfy whom fully or partly is a matter of capabilities alone, as in the paper; what cannot
be served is told apart by cause: no robot has the kind, or none that has it can reach the victim.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RequirementAnalysis:
    """The three sets of Algorithm 2.

    Parameters
    ----------
    full, partial : bool array, shape (n_robots, n_victims)
        Whether r meets all requirements of v, or some but not all.
    potential : bool array, shape (n_victims, n_kinds, n_robots)
        Whether r has a kind that v needs.
    """

    full: Bools
    partial: Bools
    potential: Bools

    def fully(self, robot: int) -> list[int]:
        """L_full of a robot: positions of victims."""
        return [int(v) for v in np.flatnonzero(self.full[robot])]

    def partially(self, robot: int) -> list[int]:
        """L_partial of a robot: positions of victims."""
        return [int(v) for v in np.flatnonzero(self.partial[robot])]

    def potential_robots(self, victim: int) -> list[list[int]]:
        """L_potential of a victim: per kind, positions of robots."""
        return [[int(r) for r in np.flatnonzero(row)] for row in self.potential[victim]]


def requirement_analysis(P: Bools, Q: Bools) -> RequirementAnalysis:  # noqa: N803 - the paper's
    """The sets of Algorithm 2 from its two matrices.

    Parameters
    ----------
    P : bool array, shape (n_robots, n_kinds)
        Capabilities.
    Q : bool array, shape (n_victims, n_kinds)
        Requirements.
    """
    U = P.astype(int) @ Q.T.astype(int)  # noqa: N806 - the paper's name
    S = Q.sum(axis=1)  # noqa: N806 - the paper's name
    full, partial = (U > 0) & (U == S), (U > 0) & (U < S)
    # The loop of Algorithm 2 runs over the union of the two sets: over all (r, v) that share a kind.
    potential = P[:, None, :] & Q[None, :, :]
    return RequirementAnalysis(full, partial, potential.transpose(1, 2, 0))


@dataclass(frozen=True)
class Missing:
    """Requirements that cannot be served, as pairs of positions (victim, kind)."""

    unavailable: tuple[tuple[int, int], ...]
    """L_unavailable: no robot has the kind."""
    unreachable: tuple[tuple[int, int], ...]
    """Robots have the kind, but none of them can reach the victim."""


def missing_capabilities(Q: Bools, potential: Bools, reach: Bools) -> Missing:  # noqa: N803
    """Every requirement that cannot be served, by cause.

    Parameters
    ----------
    Q : bool array, shape (n_victims, n_kinds)
        Requirements.
    potential : bool array, shape (n_victims, n_kinds, n_robots)
        From `requirement_analysis`.
    reach : bool array, shape (n_robots, n_victims)
        Whether r can walk to v.
    """
    has = potential.any(axis=2)
    can = (potential & reach.T[:, None, :]).any(axis=2)
    return Missing(_pairs(Q & ~has), _pairs(Q & has & ~can))


def _pairs(table: Bools) -> tuple[tuple[int, int], ...]:
    return tuple((int(v), int(k)) for v, k in np.argwhere(table))
