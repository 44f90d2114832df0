"""Five programs from textbooks in cvxpy, as people who do not know this package write them.

Each has data small enough for its optimum to be worked out by hand, and a number that, another way,
makes it infeasible.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cvxpy as cp
import numpy as np


def knapsack(things: int = 0) -> cp.Problem:
    """Weights 3, 4, 5 in 7, worth 4, 5, 7: the first two, 9. All three weigh 12."""
    x = cp.Variable(3, boolean=True, name="x")
    return cp.Problem(
        cp.Maximize(np.array([4, 5, 7]) @ x),
        [
            (np.array([3, 4, 5]) @ x <= 7).set_label("there is room"),
            (cp.sum(x) >= things).set_label("so many things at least"),
        ],
    )


def facility_location(capacity: int = 3) -> cp.Problem:
    """Opening costs 10 and 4, ways 1, 2, 3 and 4, 5, 1: the second for all, 14."""
    is_open = cp.Variable(2, boolean=True, name="open")
    serve = cp.Variable((2, 3), boolean=True, name="serve")
    ways = np.array([[1, 2, 3], [4, 5, 1]])
    return cp.Problem(
        cp.Minimize(np.array([10, 4]) @ is_open + cp.sum(cp.multiply(ways, serve))),
        [
            (cp.sum(serve, axis=0) == 1).set_label("customer {c} is served"),
            (cp.sum(serve, axis=1) <= capacity * is_open).set_label(
                "facility {f} has the capacity"
            ),
        ],
    )


def lot_sizing(capacity: float = 9) -> cp.Problem:
    """Demand 3, 2, 4; a setup costs 5, holding 1: lots in the first and third period, 12."""
    demand = np.array([3, 2, 4])
    setup = cp.Variable(3, boolean=True, name="setup")
    lot = cp.Variable(3, nonneg=True, name="lot")
    stock = cp.Variable(3, nonneg=True, name="stock")
    before = cp.hstack([0, stock[:-1]])
    return cp.Problem(
        cp.Minimize(5 * cp.sum(setup) + cp.sum(stock)),
        [
            (before + lot == demand + stock).set_label("stock of period {t} is balanced"),
            (lot <= capacity * setup).set_label("period {t} makes no more than it can"),
        ],
    )


def unit_commitment(peak: float = 7) -> cp.Problem:
    """Units of 2 to 5 at 2 + 3 an hour and 1 to 4 at 3 + 1; demand 4, 7, 3; a start costs 2: 44."""
    demand = np.array([4, peak, 3])
    on = cp.Variable((2, 3), boolean=True, name="on")
    start = cp.Variable((2, 3), boolean=True, name="start")
    power = cp.Variable((2, 3), nonneg=True, name="power")
    before = cp.hstack([np.zeros((2, 1)), on[:, :-1]])
    minimum, maximum = np.array([[2], [1]]), np.array([[5], [4]])
    running = cp.sum(np.array([3, 1]) @ on) + cp.sum(np.array([2, 3]) @ power)
    return cp.Problem(
        cp.Minimize(running + 2 * cp.sum(start)),
        [
            (cp.sum(power, axis=0) == demand).set_label("demand of period {t} is met"),
            (power <= cp.multiply(maximum, on)).set_label(
                "unit {u} gives no more than it can in {t}"
            ),
            (power >= cp.multiply(minimum, on)).set_label("unit {u} gives its least in {t} if on"),
            (on - before <= start).set_label("unit {u} is started before {t}"),
        ],
    )


def job_shop(deadline: float = 20) -> cp.Problem:
    """Job 0: 3 on machine 0, then 2 on 1; job 1: 2 on machine 1, then 4 on 0: 7, machine 0's load."""
    time = np.array([[3, 2], [4, 2]])  # of each job on each machine
    begin = cp.Variable((2, 2), nonneg=True, name="begin")
    first = cp.Variable(2, boolean=True, name="first")  # whether job 0 is, on each machine
    end = cp.Variable(name="end")
    big = 20
    return cp.Problem(
        cp.Minimize(end),
        [
            (begin[0, 1] >= begin[0, 0] + time[0, 0]).set_label("job 0 goes to machine 1 last"),
            (begin[1, 0] >= begin[1, 1] + time[1, 1]).set_label("job 1 goes to machine 0 last"),
            (begin[1] >= begin[0] + time[0] - big * (1 - first)).set_label("job 1 waits on {m}"),
            (begin[0] >= begin[1] + time[1] - big * first).set_label("job 0 waits on {m}"),
            (end >= begin + time).set_label("job {j} is done on {m} by the end"),
            (end <= deadline).set_label("all is done by the deadline"),
        ],
    )


@dataclass(frozen=True)
class Case:
    """A problem, its optimum by hand, and what breaks it."""

    build: Callable[..., cp.Problem]
    optimum: float
    breaking: float
    """The number that makes it infeasible."""
    label: str
    """Of the rows that hold the number."""
    least_repair: float
    """By hand: what has to give way then, all rows of weight 1."""
    why_not: str
    cost: float
    """By hand: what that costs."""


CASES = {
    # One thing less; the third alone is worth 7.
    "knapsack": Case(knapsack, 9, 3, "so many things at least", 1, "x[2]=1", 2),
    # One customer unserved; the first for all is 10 + 6.
    "facility location": Case(
        facility_location, 14, 1, "facility {f} has the capacity", 1, "open[1]=0", 2
    ),
    # 9 units from 3 × 2; all at once costs 5 + 6 + 4.
    "lot sizing": Case(
        lot_sizing, 12, 2, "period {t} makes no more than it can", 3, "setup[1]=0;setup[2]=0", 3
    ),
    # One unit of power too few; the second unit alone in the first period: 13 for 11.
    "unit commitment": Case(
        unit_commitment, 44, 10, "demand of period {t} is met", 1, "on[0,0]=0", 2
    ),
    # An hour later; job 1 first on machine 0 means job 0 from 6 on, done on machine 1 at 11.
    "job shop": Case(job_shop, 7, 6, "all is done by the deadline", 1, "first[0]=0", 4),
}
