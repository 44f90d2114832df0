"""HiGHS run within a stopping criterion: it asks between its iterations and between its nodes."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version

import highspy
import numpy as np

from ..optimise.solvers.highs import new_highs
from .stop import StoppingCriterion

_ASK_EVERY = 32
"""Iterations of the simplex method from one question to the next: asking costs microseconds."""


def quiet_highs(seed: int = 0) -> highspy.Highs:
    """A model that prints nothing and keeps to one thread."""
    highs: highspy.Highs = new_highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("random_seed", seed)
    return highs


def run_highs(
    highs: highspy.Highs,
    stop: StoppingCriterion,
    proved: Callable[[float], object] = lambda bound: None,
) -> None:
    """Run `highs` until it is done or `stop` leaves no more seconds.

    Parameters
    ----------
    highs : Highs
        With a linear or mixed-integer program.
    stop : StoppingCriterion
        When to end; how far the program was solved is then said by its status.
    proved : callable
        Told the dual bound of a mixed-integer program, now and then.
    """
    n_asked = 0

    def at_iteration(event: highspy.HighsCallbackEvent) -> None:
        nonlocal n_asked
        n_asked += 1
        if n_asked % _ASK_EVERY == 0 and stop.seconds_left() <= 0.0:
            event.interrupt()

    def at_node(event: highspy.HighsCallbackEvent) -> None:
        proved(float(event.data_out.mip_dual_bound))
        if stop.seconds_left() <= 0.0:
            event.interrupt()

    left = stop.seconds_left()
    highs.setOptionValue("time_limit", highs.getRunTime() + left if np.isfinite(left) else np.inf)
    highs.cbSimplexInterrupt += at_iteration
    highs.cbMipInterrupt += at_node
    try:
        highs.run()
    finally:
        highs.cbSimplexInterrupt -= at_iteration
        highs.cbMipInterrupt -= at_node


def highs_version() -> str:
    """Name and version, for certificates."""
    return f"highs {version('highspy')}"
