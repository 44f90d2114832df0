"""Robot assignment (Algorithm 1, RobotAssign): a sealed-bid auction of what is still open, stage B4.

Every available requirement that is unserved is announced. Each potential robot that can reach the
victim bids its walking distance from where its queue ends; the lowest bid wins, ties to the first
robot. A winner that fully satisfies the victim takes all that remains of it, so that nobody else comes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .cluster_assignment import kinds
from .options import StagedOptions
from .requirement_analysis import RequirementAnalysis
from .situation import Situation, Stop

STAGE = "B4"


def robot_assignment(
    situation: Situation,
    stops: Sequence[Stop],
    remaining: NDArray[np.bool_],
    analysis: RequirementAnalysis,
    options: StagedOptions,
) -> list[Stop]:
    """Award every requirement of `remaining`, victim by victim.

    Parameters
    ----------
    stops : sequence of Stop
        Stages B2 and B3.
    remaining : bool array, shape (n_victims, n_kinds)
        Available requirements that they leave open.
    analysis : RequirementAnalysis
        Who fully satisfies whom.
    options : StagedOptions
        ``award``: whether all bids are in before any award, or the winner's queue, and so its next
        bid, is updated after each.
    """
    cells = situation.cells
    ends, _ = situation.after(stops)
    bids = situation.distances.between(ends, cells)
    victims = np.flatnonzero(remaining.any(axis=1)).tolist()
    sealed = _winners(bids, situation.able) if options.award == "sealed" else None
    awarded: list[Stop] = []
    for v in victims:
        announced = kinds(remaining[v])
        offers = bids[:, v].copy()
        won: dict[int, list[int]] = {}
        for k in announced:
            if sealed is None:
                robot = int(
                    _winners(offers[:, None], situation.able[:, v : v + 1, k : k + 1])[0, 0]
                )
                offers[robot] = 0.0
            else:
                robot = int(sealed[v, k])
            won.setdefault(robot, []).append(k)
        # The nearest robot that fully satisfies a victim wins every kind of it that it wins at all,
        # so there is at most one such winner.
        for robot in [robot for robot in won if analysis.full[robot, v]]:
            won = {robot: list(announced)}
        if sealed is None:
            field = situation.distances.between([cells[v]], cells)[0]
            bids[list(won)] = field
        awarded.extend(Stop(robot, cells[v], STAGE, v, tuple(own)) for robot, own in won.items())
    return awarded


def _winners(bids: NDArray[np.float64], potential: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The potential robot with the lowest bid for each requirement, ties to the first.

    `bids` are of shape ``(n_robots, n_victims)``, `potential` of ``(n_robots, n_victims, n_kinds)``.
    """
    return np.asarray(np.where(potential, bids[:, :, None], np.inf).argmin(axis=0))
