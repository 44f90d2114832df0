"""Robot assignment (Algorithm 1, RobotAssign): a sealed-bid auction of what is still open, stage B4.

Every available requirement that is unserved is announced. Each potential robot that can reach the
victim bids its walking distance from where its queue ends; the lowest bid wins, ties to the first
robot. A winner that fully satisfies the victim takes all that remains of it, so that nobody else comes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..mission.grid import Cell
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
    cells, (ends, _) = situation.cells, situation.after(stops)
    sealed = options.award == "sealed"
    lowest = _lowest_bids(situation, ends, remaining).tolist() if sealed else []
    bids = None if sealed else situation.distances.between(ends, cells)
    awarded: list[Stop] = []
    for v in np.flatnonzero(remaining.any(axis=1)).tolist():
        announced = kinds(remaining[v])
        if bids is None:
            winners = [lowest[v][k] for k in announced]
        else:
            winners = _in_turn(bids[:, v], situation.able[:, v], announced)
        won: dict[int, list[int]] = {}
        for k, robot in zip(announced, winners, strict=True):
            won.setdefault(robot, []).append(k)
        # The nearest robot that fully satisfies a victim wins every kind of it that it wins at all,
        # so there is at most one such winner.
        for robot in [robot for robot in won if analysis.full[robot, v]]:
            won = {robot: list(announced)}
        if bids is not None:
            bids[list(won)] = situation.distances.between([cells[v]], cells)[0]
        awarded.extend(Stop(robot, cells[v], STAGE, v, tuple(own)) for robot, own in won.items())
    return awarded


def _lowest_bids(
    situation: Situation, ends: Sequence[Cell], remaining: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """The robot that has each kind and is nearest to each victim, ``(n_victims, n_kinds)``.

    Only where they are `remaining`; ties go to the first robot.
    """
    instance, places = situation.instance, np.array(ends).reshape(-1, 2)
    cells = np.array(situation.cells).reshape(-1, 2)
    winner = np.full(remaining.shape, -1)
    for k in range(remaining.shape[1]):
        robots, victims = np.flatnonzero(instance.P[:, k]), np.flatnonzero(remaining[:, k])
        if victims.size:
            winner[victims, k] = robots[instance.map.nearest(places[robots], cells[victims])]
    return winner


def _in_turn(
    bids: NDArray[np.float64], able: NDArray[np.bool_], announced: Sequence[int]
) -> list[int]:
    """Who wins each kind of a victim, when whoever has won one is there already.

    `bids` are of shape ``(n_robots,)``, `able` is of ``(n_robots, n_kinds)``; ties go to the first.
    """
    offers, winners = bids.copy(), []
    for k in announced:
        winners.append(int(np.where(able[:, k], offers, np.inf).argmin()))
        offers[winners[-1]] = 0.0
    return winners
