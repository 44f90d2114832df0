"""Published values of public instances: our readers, formulations and solvers must come to the same.

    python benchmarks/external.py DIR [--solver NAME]… [--time-limit SECONDS]

DIR holds the files as their authors publish them, and in ``expected.json`` the published values:

- ``assign/NAME.txt``: OR-Library, linear assignment (Beasley 1990), by Eq. 1 and by Eq. 2 one to one;
- ``gap/NAME``: OR-Library, generalised assignment, its minimum and its maximum;
- ``pmed/NAME.txt``: OR-Library, p-median (Beasley 1985);
- ``movingai/maps/NAME.map`` and ``movingai/scen/NAME.scen``: shortest 4-connected walks;
- ``mps/NAME.mps``: linear and integer programs, some infeasible or unbounded;
- ``trp_latency/NAME.txt``: one repairman from the first point, minimum sum of arrival times;
- ``mtsp_minmax/NAME``: TSPLIB, several salesmen from a depot and back, their longest tour
  at its minimum.

Each program is solved by each solver named (``auto`` without any). The exit status is 1 if a value
differs, is not proven, or a solver could solve nothing at all; 2 if a file or an option is wrong.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from external_routing import UNPROVEN, by_proof, one_kind, read_points, read_tsplib
from numpy.typing import NDArray
from scipy.sparse.csgraph import csgraph_from_dense, dijkstra

from msmrta_opt.cli.console import say, table
from msmrta_opt.mission.errors import InputError, SolverError
from msmrta_opt.mission.files import read_json, read_text
from msmrta_opt.mission.grid import DistanceTable, GridMap
from msmrta_opt.mission.maps import Query, read_map, read_scenario
from msmrta_opt.optimise.data import ClusterData, ClusteringData, VictimData
from msmrta_opt.optimise.export import read_program
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import AUTO, solve, solve_program
from msmrta_opt.optimise.solvers import Options, get

Floats = NDArray[np.float64]
Value = float | str
"""A number, or a status such as ``infeasible``."""

TOLERANCE = 1e-6
"""Relative difference up to which two values are the same."""


@dataclass(frozen=True)
class Case:
    """A published value, and how we come to ours: by a solver, unless it needs none."""

    instance: str
    model: str
    expected: Value
    run: Callable[[str, Options], Value]
    needs_solver: bool = True


@dataclass(frozen=True)
class Outcome:
    """What came of a case: our value, or why there is none."""

    case: Case
    solver: str
    value: Value | None
    seconds: float
    verdict: str


# Readers, one per format


def read_assignment(path: Path) -> Floats:
    """Costs, shape ``(n, n)``: n, then the costs row by row."""
    (n,), rest = _sizes_and_rest(path, 1)
    (costs,) = _tables(path, rest, (n, n))
    return costs


def read_generalised(path: Path) -> tuple[Floats, Floats, Floats]:
    """Costs and weights, shape ``(n_agents, n_items)``, and capacities, shape ``(n_agents,)``."""
    (m, n), rest = _sizes_and_rest(path, 2)
    costs, weights, capacities = _tables(path, rest, (m, n), (m, n), (m,))
    return costs, weights, capacities


def read_p_median(path: Path) -> tuple[Floats, int]:
    """Distances, shape ``(n, n)``, and p: n, the number of edges and p; then edges ``i j cost``.

    Distances are those of shortest paths. Of several costs for an edge the last one counts.
    """
    (n, n_edges, p), rest = _sizes_and_rest(path, 3)
    (edges,) = _tables(path, rest, (n_edges, 3))
    lengths = np.full((n, n), np.inf)
    for i, j, cost in edges:
        if not (1 <= i <= n and 1 <= j <= n):
            raise InputError(f"an edge from {i:g} to {j:g}; nodes are 1 to {n}", file=path)
        lengths[int(i) - 1, int(j) - 1] = lengths[int(j) - 1, int(i) - 1] = cost
    distances: Floats = dijkstra(csgraph_from_dense(lengths, null_value=np.inf))
    return distances, p


def _sizes_and_rest(path: Path, n_sizes: int) -> tuple[list[int], Floats]:
    words = read_text(path).split()
    try:
        sizes, rest = [int(word) for word in words[:n_sizes]], np.array(words[n_sizes:], float)
    except ValueError as error:
        raise InputError(f"{error}; give numbers alone", file=path) from None
    if len(sizes) < n_sizes:
        raise InputError(f"{len(sizes)} numbers; {n_sizes} sizes come first", file=path)
    return sizes, rest


def _tables(path: Path, numbers: Floats, *shapes: tuple[int, ...]) -> list[Floats]:
    sizes = [int(np.prod(shape)) for shape in shapes]
    if len(numbers) != sum(sizes):
        raise InputError(
            f"{len(numbers)} numbers after the sizes, which ask for {sum(sizes)}", file=path
        )
    pieces = np.split(numbers, np.cumsum(sizes)[:-1])
    return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]


# Cases, one function per group of ``expected.json``


def assign(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """Linear assignment: Eq. 2 with the costs as success times, Eq. 1 with them as negative scores."""
    for name, expected in values["values"].items():
        costs = read_assignment(folder / f"{name}.txt")
        nothing = np.zeros_like(costs)
        times = _victim_data(costs, nothing, np.full(len(costs), np.inf))
        yield _case(name, "victim_one_to_one", times, expected, beta=0)
        scores = ClusterData(-costs, nothing, np.ones(len(costs), dtype=np.int64))
        yield _case(name, "cluster_one_to_one", scores, expected, sign=-1, psi=0)


def gap(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """Generalised assignment: weights as success times within endurance, costs as failure times."""
    for name, expected in values["values"].items():
        costs, weights, capacities = read_generalised(folder / name)
        for sense, sign in (("min", 1), ("max", -1)):
            data = _victim_data(weights, sign * costs, capacities)
            title = f"{name} {sense}"
            yield _case(title, "victim_generalized", data, expected[sense], sign=sign, beta=1)


def pmed(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """The p-median problem."""
    for name, expected in values["values"].items():
        distances, p = read_p_median(folder / f"{name}.txt")
        can_reach, one_each = np.isfinite(distances), np.ones(len(distances))
        data = ClusteringData(np.where(can_reach, distances, 0.0), can_reach, one_each, p)
        yield _case(name, "clustering_pmedian", data, expected["optimum"])


def movingai(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """Sum and maximum of the shortest walks of a scenario's first rows, both ways we have them."""
    for key, expected in values.items():
        found = re.fullmatch(r"(\S+) / (\S+\.scen), first (\d+) rows", key)
        if found is None:
            raise InputError(f"{key!r}; give 'MAP / FILE.scen, first N rows'", field="movingai")
        grid = read_map(folder / "maps" / f"{found[1]}.map")
        queries = read_scenario(folder / "scen" / found[2])[: int(found[3])]
        for model, lengths in (("distance fields", field_lengths), ("A* walks", walk_lengths)):
            for what, of, published in (
                ("sum", sum, "sum_of_4connected_shortest_paths"),
                ("longest", max, "max"),
            ):
                run = partial(_of_lengths, of, lengths, grid, queries)
                yield Case(f"{found[2]} {what}", model, expected[published], run, False)


def mps(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """Programs that are not ours: what is read, and what it is worth."""
    for name, expected in values.items():
        program = read_program(folder / f"{name}.mps")
        size = "{rows} × {cols}, {integers} integer".format(**expected)
        yield Case(name, "reader", size, partial(_size, program), False)
        value = expected["highspy_value"]
        status = expected["highspy_status"].lower()
        run = partial(_solve_program, program)
        yield Case(name, "as it stands", status if value is None else value, run)


def trp_latency(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """The travelling repairman: latency of one robot on an open route."""
    for name, expected in values.items():
        if name != "convention":
            data = one_kind(read_points(folder / f"{name}.txt"), 1, return_to_start=False)
            run = partial(by_proof, data, "latency")
            yield Case(name, "latency, column generation", expected, run, False)


def mtsp_minmax(folder: Path, values: dict[str, Any]) -> Iterator[Case]:
    """Several salesmen: makespan of robots that return."""
    for item in values["values"]:
        n_robots, expected = item["m"], item["minmax"]
        lengths = read_tsplib(folder / item["instance"])
        data = one_kind(lengths, n_robots, return_to_start=True)
        title, run = f"{item['instance']}, {n_robots} tours", partial(by_proof, data, "makespan")
        yield Case(title, "makespan, branch and cut", expected, run, False)


GROUPS: dict[str, Callable[[Path, dict[str, Any]], Iterator[Case]]] = {
    group.__name__: group for group in (assign, gap, pmed, movingai, mps, trp_latency, mtsp_minmax)
}


def _victim_data(success: Floats, failure: Floats, endurance: Floats) -> VictimData:
    n_robots, n_victims = success.shape
    return VictimData(
        success=success,
        failure=failure,
        can_serve=np.ones(success.shape, dtype=bool),
        busy=np.zeros(n_robots),
        budget=np.full(n_robots, n_victims),
        endurance=endurance,
    )


def _case(
    instance: str, model: str, data: object, expected: float, *, sign: int = 1, **parameters: Any
) -> Case:
    """The formulation `model` on `data`; `sign` is -1 where its value is the opposite."""
    return Case(instance, model, expected, partial(_solve, model, data, sign, parameters))


def _solve(
    model: str,
    data: object,
    sign: int,
    parameters: dict[str, Any],
    solver: str,
    options: Options,
) -> Value:
    limit = options.time_limit
    value = said(solve(model, data, solver=solver, time_limit=limit, **parameters))
    return value if isinstance(value, str) else sign * value


def _solve_program(program: Program, solver: str, options: Options) -> Value:
    return said(solve_program(program, solver=solver, options=options))


def _size(program: Program, *_: object) -> Value:
    return f"{program.n_rows} × {program.n_columns}, {program.integer.sum()} integer"


def _of_lengths(
    of: Callable[[list[float]], float],
    lengths: Callable[[GridMap, list[Query]], list[float]],
    grid: GridMap,
    queries: list[Query],
    *_: object,
) -> Value:
    return of(lengths(grid, queries))


def field_lengths(grid: GridMap, queries: list[Query]) -> list[float]:
    """Length of each query's shortest walk, by breadth-first fields."""
    distances = DistanceTable(grid, [query.start for query in queries])
    return [distances(query.start, query.goal) for query in queries]


def walk_lengths(grid: GridMap, queries: list[Query]) -> list[float]:
    """The same by the cells of A* walks."""
    return [len(grid.walk(query.start, query.goal)) - 1.0 for query in queries]


def said(solution: Solution) -> Value:
    """The proven value, or what there is instead of one."""
    if solution.status == "skipped":
        raise SolverError(solution.message)
    if solution.status == "optimal" and solution.objective is not None:
        return solution.objective
    if solution.status in ("infeasible", "unbounded"):
        return solution.status
    return f"{solution.status}, {UNPROVEN}"


# Running and showing


def outcome(case: Case, solver: str, options: Options) -> Outcome:
    """Solve `case` by `solver`, and compare."""
    began = time.perf_counter()
    try:
        value = case.run(solver, options)
    except SolverError as error:
        return Outcome(case, solver, None, time.perf_counter() - began, f"skipped: {error}")
    seconds = time.perf_counter() - began
    if isinstance(value, str) and value.endswith(UNPROVEN):
        return Outcome(case, solver, value, seconds, "stopped")
    verdict = "agrees" if _same(value, case.expected) else "DISAGREES"
    return Outcome(case, solver, value, seconds, verdict)


def _same(value: Value, expected: Value) -> bool:
    if isinstance(value, str) or isinstance(expected, str):
        return value == expected
    return abs(value - expected) <= TOLERANCE * max(1.0, abs(expected))


def cases(folder: Path) -> Iterator[Case]:
    """The cases of `folder`, as its ``expected.json`` lists them.

    Raises
    ------
    InputError
        If a file is missing or broken, or nothing is listed that is known here.
    """
    path = folder / "expected.json"
    try:
        expected = read_json(path)
    except json.JSONDecodeError as error:
        raise InputError(f"broken JSON: {error}", file=path) from None
    known = [name for name in GROUPS if name in expected]
    if not known:
        raise InputError(f"none of {', '.join(GROUPS)} is in it", file=path)
    for name in known:
        yield from GROUPS[name](folder / name, expected[name])


def outcomes(folder: Path, solvers: Sequence[str], options: Options) -> Iterator[Outcome]:
    """All cases by all solvers; what needs no solver once."""
    for case in cases(folder):
        for solver in solvers if case.needs_solver else [""]:
            yield outcome(case, solver, options)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, and return its exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--solver", action="append", metavar="NAME")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS")
    given = parser.parse_args(arguments)
    solvers = list(dict.fromkeys(given.solver or [AUTO]))
    try:
        for name in solvers:
            if name != AUTO and not get(name).installed:
                raise InputError(f"{name} is not installed; {get(name).install}", field="solver")
        found = list(outcomes(given.folder, solvers, Options(time_limit=given.time_limit)))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    show(found)
    tried = {name: [item for item in found if item.solver == name] for name in solvers}
    useless = [name for name, own in tried.items() if own and all(a.value is None for a in own)]
    for name in useless:
        say(f"{name} could solve nothing here.")
    # What needs no solver has nobody else to blame for having no value.
    failed = [item for item in found if item.value is None and not item.case.needs_solver]
    wrong = failed + [item for item in found if item.verdict in ("DISAGREES", "stopped")]
    return 1 if wrong or useless else 0


def show(found: Sequence[Outcome]) -> None:
    """Print the table, and how many values agree."""
    table(
        "Published values, solved again",
        ["instance", "model", "solver", "value", "expected", "seconds", "verdict"],
        [
            (
                item.case.instance,
                item.case.model,
                item.solver or "–",
                _shown(item.value),
                _shown(item.case.expected),
                f"{item.seconds:.3f}",
                item.verdict,
            )
            for item in found
        ],
    )
    agree = sum(item.verdict == "agrees" for item in found)
    skipped = sum(item.value is None for item in found)
    say(f"{agree} of {len(found)} agree, {skipped} skipped.")


def _shown(value: Value | None) -> str:
    if value is None:
        return "–"
    return value if isinstance(value, str) else f"{value:.10g}"


if __name__ == "__main__":
    sys.exit(main())
