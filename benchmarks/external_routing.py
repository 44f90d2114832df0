"""Published routing problems as joint problems of one kind of capability, and how we solve them.

Victims are the customers, robots the salesmen or repairmen, all of speed one from the same start; a
visit takes no time. Lengths are taken as published, even where a detour is shorter than a direct way.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.files import read_text
from msmrta_opt.optimise.solvers import Options
from msmrta_opt.routing.heuristics.ruin_and_recreate import ruin_and_recreate
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.methods import close_in
from msmrta_opt.routing.problem import Routes, RoutingData
from msmrta_opt.routing.stop import MaximumRuntime

Floats = NDArray[np.float64]

UNPROVEN = "not proven"
PROVEN = 1e-6
"""Relative gap up to which a value is proven."""


def read_points(path: Path) -> Floats:
    """Distances, shape ``(n, n)``, rounded down, between points: ``number x y`` a line."""
    try:
        points = np.array([line.split() for line in read_text(path).splitlines() if line], float)
    except ValueError as error:
        raise InputError(f"{error}; give a number and two coordinates a line", file=path) from None
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("give a number and two coordinates a line", file=path)
    apart = points[:, None, 1:] - points[None, :, 1:]
    return np.asarray(np.floor(np.hypot(apart[..., 0], apart[..., 1])))


def read_tsplib(path: Path) -> Floats:
    """Distances, shape ``(n, n)``, of a TSPLIB file, the depot first.

    A matrix (lower rows, upper rows or full) has its first node as the depot. Coordinates are points of
    a plane, GEO ones, too; their distances are rounded to whole numbers, and the depot is that of
    ``DEPOT_SECTION``, else an added point, the mean of all.
    """
    text = read_text(path)
    kind = re.search(r"^EDGE_WEIGHT_TYPE\s*:\s*(\w+)", text, re.MULTILINE)
    if kind is not None and kind[1] in ("EUC_2D", "GEO"):
        return _between_points(text, path)
    return _matrix(text, path)


def _between_points(text: str, path: Path) -> Floats:
    numbers = r"((?:[ \t]*[-+\d.eE]+)+\s)*"
    found = re.search(rf"^NODE_COORD_SECTION\s+({numbers})", text, re.MULTILINE)
    rows = [] if found is None else [line.split() for line in found[1].splitlines() if line.strip()]
    if not rows or any(len(row) != 3 for row in rows):
        raise InputError("give a number and two coordinates a line", file=path)
    points = np.array(rows, float)
    depot = re.search(r"^DEPOT_SECTION\s+(\d+)", text, re.MULTILINE)
    if depot is None:
        points = np.vstack([[0, *points[:, 1:].mean(axis=0)], points])
    else:
        first = np.flatnonzero(points[:, 0] == int(depot[1]))
        if len(first) != 1:
            raise InputError(f"depot {depot[1]} is no node; give one", file=path)
        points = np.vstack([points[first], np.delete(points, first, axis=0)])
    apart = points[:, None, 1:] - points[None, :, 1:]
    return np.asarray(np.rint(np.hypot(apart[..., 0], apart[..., 1])))


def _matrix(text: str, path: Path) -> Floats:
    size = re.search(r"^DIMENSION\s*:\s*(\d+)", text, re.MULTILINE)
    form = re.search(
        r"^EDGE_WEIGHT_FORMAT\s*:\s*(FULL_MATRIX|(LOWER|UPPER)(_DIAG)?_ROW)\b", text, re.MULTILINE
    )
    weights = re.search(r"^EDGE_WEIGHT_SECTION\s+([\d\s.]*)", text, re.MULTILINE)
    if size is None or form is None or weights is None:
        raise InputError("give DIMENSION and edge weights, by rows or in full", file=path)
    lengths = np.zeros((int(size[1]),) * 2)
    corner = 0 if form[3] else 1
    n = len(lengths)
    if form[2] is None:
        rows, columns = np.repeat(np.arange(n), n), np.tile(np.arange(n), n)
    else:
        rows, columns = np.tril_indices(n, -corner)
        if form[2] == "UPPER":
            rows, columns = np.triu_indices(n, corner)
    numbers = weights[1].split()
    if len(numbers) != len(rows):
        raise InputError(f"{len(numbers)} edge weights; give {len(rows)}", file=path)
    lengths[rows, columns] = np.array(numbers, float)
    return lengths if form[2] is None else np.maximum(lengths, lengths.T)


def one_kind(lengths: Floats, n_robots: int, *, return_to_start: bool) -> RoutingData:
    """Visit all nodes but the first, where the robots start; `lengths` of shape ``(n, n)``."""
    n_victims = len(lengths) - 1
    leave = np.tile(lengths[0, 1:], (n_robots, 1))
    return RoutingData(
        leave=leave,
        length=lengths[None, 1:, 1:],
        back=leave if return_to_start else np.zeros_like(leave),
        service=np.zeros((n_victims, 1)),
        able=np.ones((n_robots, n_victims, 1), dtype=bool),
        priority=np.ones(n_victims),
        endurance=np.full(n_robots, np.inf),
        longest_walk=np.full(n_robots, np.inf),
    )


def searched(data: RoutingData, objective: str) -> Routes:
    """Routes by local search, from victims dealt out in turn."""
    n = data.n_robots
    dealt = tuple(tuple((v, (0,)) for v in range(r, data.n_victims, n)) for r in range(n))
    return ruin_and_recreate(data, dealt, objective)


def by_proof(data: RoutingData, objective: str, _: str, options: Options) -> float | str:
    """The value that is proven within the time limit, or says that it is not."""
    limit = math.inf if options.time_limit is None else options.time_limit
    begin = searched(data, objective)
    progress = Progress(data, objective, begin, stop=MaximumRuntime(limit))
    close_in(progress)
    reached, bound = progress.value, progress.bound
    return (
        reached if progress.open() <= PROVEN else f"{reached:.10g} above {bound:.10g}, {UNPROVEN}"
    )
