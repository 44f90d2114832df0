"""Random small integer programs against brute force: wrong statuses, values, bounds and explanations.

    python benchmarks/fuzz_programs.py [--programs 1000] [--first 0] [--solvers auto highs] [--scaled]

Every solver is asked for each of `random_programs`, and `auto`. What is infeasible is explained: what
is said to conflict must, and without any one member must not. Each program is written as LP or MPS, and
must be the same when it is read back. A well-scaled program must be solved, by every solver that can
take it; of a badly scaled one an optimum may be called *claimed*, but is never wrong. ``--scaled``
tries programs with coefficients from 4e-9 to 4e9 alone. The exit status is 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from random_programs import Trial, Truth, scaled_trial, trial, truth

from msmrta_opt.diagnosis.conflict import Conflict, find_conflict
from msmrta_opt.mission.errors import ModelError, SolverError, UnsupportedError
from msmrta_opt.optimise.export import read_program, write_program
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options

SOLVERS = ("auto", "highs", "scip", "glpk", "cpsat")
LIMIT = 20.0
"""Seconds a solver; what needs more is counted as unsolved."""
BOX = 40
"""How far from 0 points are looked for that an explanation says there are none of."""
POINTS = 5_000
"""About how many of them."""
TOLERANCE = 2e-6
"""Relative to the size of the objective."""
UNSOLVED = ("claimed", "contradicted", "error", "no_solution", "skipped", "feasible")


def wrong_with(asked: Trial, best: Truth, solution: Solution) -> str:
    """What is wrong with a solution, if anything."""
    program, status = asked.program, solution.status
    if status in UNSOLVED and asked.is_well_scaled:
        said = solution.message or solution.check
        return f"{status}, though nothing is badly scaled: {said}"
    if status in ("contradicted", "error", "no_solution", "skipped"):
        return ""
    if status == "infeasible":
        return "" if best.narrow is None else f"infeasible, where {best.narrow!r} is feasible"
    if best.wide is None:
        return f"{status}, where nothing is feasible"
    if status == "unbounded":
        return "" if asked.unbounded else f"unbounded, where the best is {best.wide!r}"
    if asked.unbounded:
        return f"{status}, where it is unbounded"
    slack = TOLERANCE * best.size + 2.0**-50 * abs(program.offset)
    better = (best.wide - slack) if program.sense == "min" else (best.wide + slack)
    assert solution.objective is not None
    values = {"value": solution.objective}
    if solution.bound is not None and status == "optimal":
        values["bound"] = solution.bound
    for what, value in values.items():
        if program.sign * (value - program.offset - better) < 0:
            return f"{what} {value - program.offset!r} beyond the best, {best.wide!r}"
    if solution.bound is not None and best.narrow is not None:
        beyond = solution.bound - program.offset - best.narrow
        if status != "claimed" and program.sign * beyond > slack:
            return f"bound {solution.bound - program.offset!r} excludes {best.narrow!r}"
    if status == "optimal" and best.narrow is not None:
        worse = program.sign * (solution.objective - program.offset - best.narrow)
        if worse > slack:
            return f"{solution.objective - program.offset!r} optimal, where it is {best.narrow!r}"
    return ""


def wrong_with_explanation(asked: Trial, best: Truth, found: Conflict) -> str:
    """What is wrong with an explanation, if anything."""
    if found.status == "unknown":
        return "explain: unknown, though nothing is badly scaled" if asked.is_well_scaled else ""
    if found.status == "feasible":
        return "explain says feasible" if best.wide is None else ""
    if best.narrow is not None:
        return "explain says infeasible"
    members = [*found.rows, *found.bounds]
    if has_point(asked, parts := list(_members(asked.program, members))):
        return f"all these hold together: {', '.join(members)}"
    if found.irreducible:
        for left_out in range(len(parts)):
            rest = parts[:left_out] + parts[left_out + 1 :]
            if not has_point(asked, rest) and is_infeasible(asked, rest, found.integrality):
                return f"{members} is called irreducible, but needs no {_text(parts[left_out])}"
    return ""


Member = tuple[str, int]
"""``row``, ``low`` or ``high``, and the row or the column."""


def _text(member: Member) -> str:
    return f"{member[0]} {member[1]}"


def _members(program: Program, names: list[str]) -> Iterator[Member]:
    rows = {program.row_name(i): i for i in range(program.n_rows)}
    for name in names:
        if name in rows:
            yield "row", rows[name]
            continue
        place = re.search(r"x\[(\d+)\]", name)
        assert place is not None, name
        j = int(place[1])
        if " = " in name or name.count("≤") == 2 or "≥" in name:
            yield "low", j
        if " = " in name or name.count("≤") == 2 or ("≤" in name and "≥" not in name):
            yield "high", j


def _part(asked: Trial, members: list[Member]) -> Program:
    """The program with these members alone."""
    program = asked.program
    has = {kind: [place for of, place in members if of == kind] for kind in ("row", "low", "high")}

    def kept(side: np.ndarray, kind: str, none: float) -> np.ndarray:
        chosen = np.isin(np.arange(len(side)), has[kind])
        return np.where(chosen, side, none)

    return replace(
        program,
        row_lower=kept(program.row_lower, "row", -np.inf),
        row_upper=kept(program.row_upper, "row", np.inf),
        lower=kept(program.lower, "low", -np.inf),
        upper=kept(program.upper, "high", np.inf),
    )


def has_point(asked: Trial, members: list[Member]) -> bool:
    """Whether the members have a point near to 0, by brute force; of few columns alone."""
    part = _part(asked, members)
    used = (abs(part.matrix).T @ (np.isfinite(part.row_lower) | np.isfinite(part.row_upper))) > 0
    low = np.where(np.isfinite(part.lower), part.lower, np.minimum(asked.low, -1) - 1)
    high = np.where(np.isfinite(part.upper), part.upper, np.maximum(asked.high, 1) + 1)
    n = int((used & part.integer).sum())
    reach = min(BOX, int(POINTS ** (1 / max(n, 1)) / 2))
    low = np.where(np.isfinite(part.lower), low, np.minimum(low, -reach))
    high = np.where(np.isfinite(part.upper), high, np.maximum(high, reach))
    low = np.where(used | ~part.integer, low, np.where(np.isfinite(part.lower), low, high))
    high = np.where(used | ~part.integer, high, low)
    if (low > high).any() or np.prod((high - low + 1)[part.integer]) > 8 * POINTS:
        return False
    if not part.integer.all():
        part = replace(
            part,
            lower=np.where(part.integer, part.lower, low),
            upper=np.where(part.integer, part.upper, high),
        )
    trial_part = replace(asked, program=part, low=low, high=high)
    return truth(trial_part).narrow is not None


def is_infeasible(asked: Trial, members: list[Member], integrality: bool) -> bool:
    """Whether SCIP calls them infeasible, where brute force finds no point."""
    part = _part(asked, members)
    part = replace(part, cost=np.zeros(part.n_columns))
    part = part if integrality else part.relaxed()
    return (
        solve_program(part, solver="scip", options=Options(time_limit=LIMIT)).status == "infeasible"
    )


def wrong_with_file(asked: Trial, number: int, folder: Path, counts: Counter[str]) -> str:
    """What is wrong with the program that is read back, if anything."""
    program, path = asked.program, folder / ("program.lp" if number % 2 else "program.mps")
    try:
        write_program(program, path)
    except ModelError as refusal:
        counts["export: refused"] += 1
        return f"{path.suffix}: {refusal}" if asked.is_well_scaled else ""
    back = read_program(path)
    counts["export: written and read"] += 1
    dense = [part.matrix.toarray() for part in (program, back)]
    units = np.ones(program.n_rows)
    if dense[0].shape == dense[1].shape:
        sizes = [np.abs(part).max(axis=1, initial=0.0) for part in dense]
        units = np.where(sizes[0] > 0, sizes[1] / np.where(sizes[0] > 0, sizes[0], 1), 1.0)
    kept = np.isfinite(program.row_lower) | np.isfinite(program.row_upper)
    same = {
        "sense": program.sense == back.sense,
        "offset": program.offset == back.offset,
        "rows": dense[0][kept].shape == dense[1][kept[: len(dense[1])]].shape,
        "powers of two": bool((np.log2(units) == np.round(np.log2(units))).all()),
    }
    if all(same.values()):
        same |= {
            "cost": np.array_equal(program.cost, back.cost),
            "coefficients": np.array_equal(dense[0] * units[:, None], dense[1]),
            "row lower": np.array_equal(program.row_lower * units, back.row_lower),
            "row upper": np.array_equal(program.row_upper * units, back.row_upper),
            "lower": np.array_equal(program.lower, back.lower),
            "upper": np.array_equal(program.upper, back.upper),
            "integer": np.array_equal(program.integer, back.integer),
        }
    other = [what for what, is_same in same.items() if not is_same]
    return f"{path.suffix} read back with other {', '.join(other)}" if other else ""


def examine(
    asked: Trial, number: int, names: tuple[str, ...], folder: Path, counts: Counter[str]
) -> list[str]:
    """All that is wrong with what is said about a program."""
    best = truth(asked)
    kind = "well scaled" if asked.is_well_scaled else "badly scaled"
    counts[f"programs, {kind}"] += 1
    if best.narrow is None or best.wide is None:
        if best.wide is not None:
            counts[f"programs, {kind}: infeasible but for tolerances"] += 1
    elif abs(best.narrow - best.wide) > TOLERANCE * best.size:
        counts[f"programs, {kind}: of several optima within tolerances"] += 1
    found = []
    for name in names:
        try:
            solution = solve_program(asked.program, solver=name, options=Options(time_limit=LIMIT))
        except SolverError as refusal:
            counts[f"{name}, {kind}: refused"] += 1
            unable = isinstance(refusal, UnsupportedError) and name == "cpsat"
            if asked.is_well_scaled and not unable:
                found.append(f"{name} refuses: {refusal}")
            continue
        counts[f"{name}, {kind}: {solution.status}"] += 1
        if said := wrong_with(asked, best, solution):
            found.append(f"{name}: {said}")
    try:
        explanation = find_conflict(asked.program, time_limit=LIMIT)
    except SolverError as refusal:
        counts[f"explain, {kind}: refused"] += 1
        if asked.is_well_scaled:
            found.append(f"explain refuses: {refusal}")
    else:
        counts[f"explain, {kind}: {explanation.status}"] += 1
        if said := wrong_with_explanation(asked, best, explanation):
            found.append(said)
    if said := wrong_with_file(asked, number, folder, counts):
        found.append(said)
    return [f"{number} ({asked.shape}): {line}" for line in found]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--solvers", nargs="+", default=SOLVERS)
    parser.add_argument("--scaled", action="store_true", help="coefficients from 4e-9 to 4e9 alone")
    arguments = parser.parse_args()
    counts: Counter[str] = Counter()
    make = scaled_trial if arguments.scaled else trial
    n_wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.first, arguments.first + arguments.programs):
            for line in examine(
                make(number), number, tuple(arguments.solvers), Path(folder), counts
            ):
                n_wrong += 1
                print(line, flush=True)
    for what, count in sorted(counts.items()):
        print(f"{what}: {count}")
    print(f"{arguments.programs} programs, {n_wrong} wrong")
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
