"""Breakpoints where the relaxation lacks them: where a victim's tasks change places as the last.

That is where no single task's time tells when the victim is complete.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ...arrays import Floats
from .duals import Duals, time_in_intervals
from .master import TINY, Master

_WORTHLESS = 1e-6
"""Relative to the victim's times."""


def refine(master: Master, duals: Duals, maximum: int) -> float:
    """Put breakpoints where they strengthen the relaxation; returns by how much at its solution.

    Where a victim has more than `maximum`, those at which `duals` do not change are taken out.
    """
    gain = 0.0
    tasks = master.tasks
    times: dict[int, dict[float, float]] = defaultdict(lambda: defaultdict(float))
    for share, (_, stops) in master.used:
        for _, served, time in stops:
            for g in served:
                times[g][time] += share
    for v, own in enumerate(tasks.of):
        if not tasks.split(v):
            continue
        more, changes = _missed(master.breakpoints[v], [times[g] for g in own])
        if not len(changes):
            continue
        gain += float(master.data.priority[v]) * more
        kept = master.breakpoints[v]
        if len(kept) > maximum:
            density = np.array([duals.density[g] for g in own])
            kept = kept[np.append(True, (abs(np.diff(density)) > TINY).any(axis=0))]
        master.set_breakpoints(v, np.union1d(kept, changes))
    return gain


def _missed(breakpoints: Floats, times: list[dict[float, float]]) -> tuple[float, Floats]:
    """How much later a victim is complete than its intervals see, and the breakpoints that they lack.

    Parameters
    ----------
    breakpoints : array, shape (n_breakpoints,)
        Of the victim.
    times : list of {time: share}
        For each of its tasks when it is done, in a relaxation.
    """
    at = np.unique([0.0, *(t for own in times for t in own)])
    done = np.array([[own.get(t, 0.0) for t in at] for own in times])
    # Rounded, so that equal sums taken in different orders tie.
    undone = np.round(done.sum(axis=1, keepdims=True) - done.cumsum(axis=1), 9)
    length = np.append(np.diff(at), 0.0)
    intervals = time_in_intervals(breakpoints, at)
    passed = np.diff(intervals, axis=0, append=intervals[-1:])
    more = float(undone.max(axis=0) @ length - (undone @ passed).max(axis=0).sum())
    if more <= _WORTHLESS * max(1.0, at[-1]):
        return 0.0, np.empty(0)
    return more, at[np.flatnonzero(np.diff(undone.argmax(axis=0))) + 1]
