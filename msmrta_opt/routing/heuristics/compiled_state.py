"""What the compiled steps of ruin and recreate work on: the problem, their state, and how to search."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from ...arrays import Bools, Floats, Ints

TRAVEL, FINISH, COMPLETION = 0, 1, 2
"""By what a place for a requirement is judged; see `Objective.insertion`."""


class Problem(NamedTuple):
    """What stays as it is; g are requirements, by victim and kind."""

    leave: Floats
    """Travel from starts, (r, v)."""
    back: Floats
    """Travel to starts, (r, v)."""
    length: Floats
    """Ways between victims, (r, v, v); or for all robots, (1, v, v)."""
    speed: Floats
    """Length covered in one time unit, (r)."""
    endurance: Floats
    longest_walk: Floats
    first: Ints
    """The first requirement of v, and one more entry, (v + 1)."""
    victim: Ints
    service: Floats
    """Of g."""
    able: Bools
    """Whether r can serve g, (g, r)."""
    n_able: Ints
    near: Ints
    """Victims that need something, the nearest first, (v, neighbours)."""
    needed: Ints
    priority: Floats


class State(NamedTuple):
    """What changes from step to step."""

    route: Ints
    """Victims of r, (r, v)."""
    length: Ints
    who: Ints
    """The robot of g; -1 while it is taken out."""
    at: Ints
    """The place of v on the route of r, or -1, (r, v)."""
    busy: Floats
    travel: Floats
    added: Floats
    """Travel that v adds to the route of r, (r, v), and where, as long as `stamp` is r's version."""
    place: Ints
    stamp: Ints
    version: Ints
    saved_route: Ints
    saved: Ints
    """Length and version of r as they were before the step, (r, 2)."""
    saved_times: Floats
    touched: Ints
    moved: Ints
    """Requirements taken out, (g), and whose they were."""
    moved_from: Ints
    asked: Ints
    """Scratch: the last question that r was a candidate for."""
    candidates: Ints
    done: Floats
    completion: Floats
    best_route: Ints
    best_length: Ints
    best_who: Ints
    cost: Floats
    """Of the routes as they are, and of the best."""
    counts: Ints
    """Versions given so far; robots touched; requirements taken out; questions asked."""
    random: NDArray[np.uint64]


class Settings(NamedTuple):
    """How to search; see `HeuristicsParameters`."""

    insertion: int
    only_last: bool
    of_victims: bool
    average_removed: int
    longest_string: int
    blink: float
    perturbed: float
    max_candidates: int


# The same to the compiler. It keeps code by the source of its function and by these types alone: who
# exchanges two fields of one type changes `compiled_steps`, too, or finds what was compiled before.

_F1, _F2, _F3 = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
_I1, _I2 = types.int64[::1], types.int64[:, ::1]
_INT, _FLOAT, _BOOL = types.int64, types.float64, types.boolean
PROBLEM = types.NamedTuple(
    [_F2, _F2, _F3, _F1, _F1, _F1, _I1, _I1, _F1, types.boolean[:, ::1], _I1, _I2, _I1, _F1],
    Problem,
)
STATE = types.NamedTuple(
    [
        *(_I2, _I1, _I1, _I2, _F1, _F1, _F2, _I2, _I2, _I1, _I2, _I2, _F2, _I1, _I1, _I1, _I1, _I1),
        *(_F1, _F1, _I2, _I1, _I1, _F1, _I1, types.uint64[::1]),
    ],
    State,
)
SETTINGS = types.NamedTuple([_INT, _BOOL, _BOOL, _INT, _INT, _FLOAT, _FLOAT, _INT], Settings)
