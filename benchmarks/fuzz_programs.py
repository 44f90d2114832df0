"""Random small integer programs against brute force: wrong statuses, values, bounds and explanations.

    python benchmarks/fuzz_programs.py [--programs 1000] [--first 0] [--solvers auto highs scip]

The shapes are those of which solvers are known to go wrong: whole and decimal data, scales from 1e-9 to
1e9 of rows, costs, and all coefficients, big-Ms, constants, ties, equations.
Every solver is asked, and `auto`; what is infeasible is explained, and what is said to conflict must.
The exit status is 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections import Counter
from fractions import Fraction

import numpy as np
from scipy.sparse import csr_array

from msmrta_opt.mission.errors import SolverError
from msmrta_opt.optimise.explain import explain_program
from msmrta_opt.optimise.program import Block, Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options

SHAPES = ("whole", "decimal", "scaled rows", "scaled costs", "badly scaled", "big M", "equations")
ROUNDING = Fraction(1, 10**11)
"""Relative: within it a row is neither kept nor missed for certain, and a program is left out."""


def program(number: int) -> Program:
    """The program of that number."""
    random = np.random.default_rng(number)
    shape = SHAPES[number % len(SHAPES)]
    n, m = int(random.integers(1, 6)), int(random.integers(1, 5))
    matrix = random.integers(-9, 10, (m, n)).astype(float) * (random.random((m, n)) < 0.8)
    cost = random.integers(-9, 10, n).astype(float)
    lower = random.integers(-2, 1, n).astype(float)
    upper = lower + random.integers(0, 4, n).astype(float)
    inside = np.array(
        [random.integers(low, high + 1) for low, high in zip(lower, upper, strict=True)]
    )
    if shape == "decimal":
        matrix, cost = matrix / 10, cost / 10
    if shape == "badly scaled":
        matrix = matrix * 10.0 ** random.integers(-9, 10, (m, n))
        cost = cost * 10.0 ** random.integers(-9, 10, n)
    if shape == "big M" and n > 1:
        matrix[0], lower[-1], upper[-1] = 0, 0, 1
        matrix[0, 0], matrix[0, -1] = 1, -(10.0 ** random.integers(1, 10))
        inside = np.clip(inside, lower, upper)
    side = matrix @ inside + (random.integers(-1, 2, m) if random.random() < 0.5 else 0)
    if shape == "big M":
        side[0] = 0
    kinds = random.choice(["<", "=" if shape == "equations" else "<", ">"], m)
    low = np.where(kinds == "<", -np.inf, side)
    high = np.where(kinds == ">", np.inf, side)
    if shape == "scaled rows":
        unit = 10.0 ** random.integers(-9, 10, m)
        matrix, low, high = matrix * unit[:, None], low * unit, high * unit
    if shape == "scaled costs":
        cost = cost * 10.0 ** float(random.integers(-9, 10))
    return Program(
        sense="max" if number % 2 else "min",
        cost=cost,
        offset=float(random.choice([0, 0, 5, -1e6, 1e9])),
        matrix=csr_array(matrix),
        row_lower=low,
        row_upper=high,
        lower=lower,
        upper=upper,
        integer=np.ones(n, dtype=bool),
        columns=(Block("x", 0, (n,)),),
        rows=(Block("row {i}", 0, (m,)),),
    )


def brute_force(asked: Program) -> Fraction | str | None:
    """The best value without the constant, in fractions; ``doubtful`` where rounding decides."""
    best: Fraction | None = None
    rows = [[Fraction(float(a)) for a in row] for row in asked.matrix.toarray()]
    costs = [Fraction(float(c)) for c in asked.cost]
    ranges = [range(int(a), int(b) + 1) for a, b in zip(asked.lower, asked.upper, strict=True)]
    for point in itertools.product(*ranges):
        holds = True
        for row, low, high in zip(rows, asked.row_lower, asked.row_upper, strict=True):
            activity = sum((a * x for a, x in zip(row, point, strict=True)), Fraction(0))
            for side, sign in ((low, -1), (high, 1)):
                if not np.isfinite(side):
                    continue
                beyond = sign * (activity - Fraction(float(side)))
                terms = sum(abs(a * x) for a, x in zip(row, point, strict=True))
                if 0 < beyond <= ROUNDING * max(terms, abs(Fraction(float(side)))):
                    return "doubtful"
                holds &= beyond <= 0
        if holds:
            value = sum((c * x for c, x in zip(costs, point, strict=True)), Fraction(0))
            better = best is None or (value < best if asked.sense == "min" else value > best)
            best = value if better else best
    return best


def wrong(asked: Program, best: Fraction | None, solution: Solution) -> str:
    """What is wrong with a solution, if anything."""
    if solution.status in ("contradicted", "error", "no_solution", "claimed"):
        return ""
    if best is None:
        return "" if solution.status == "infeasible" else f"{solution.status} is infeasible"
    if solution.status != "optimal" or solution.objective is None or solution.bound is None:
        return f"{solution.status} where the best is {float(best):g}"
    costs = [abs(Fraction(float(c))) for c in asked.cost]
    size = max(abs(best), *costs) or Fraction(1)
    slack = size / 10**6 + Fraction(abs(asked.offset)) / 2**50
    for what, value in (("value", solution.objective), ("bound", solution.bound)):
        if abs(Fraction(value) - Fraction(asked.offset) - best) > slack:
            return f"{what} {value - asked.offset!r} where the best is {float(best)!r}"
    return ""


def examine(number: int, names: list[str], counts: Counter[str]) -> list[str]:
    """All that is wrong with what is said about the program of that number."""
    asked = program(number)
    best = brute_force(asked)
    if isinstance(best, str):
        counts["left out"] += 1
        return []
    found = []
    for name in names:
        try:
            solution = solve_program(asked, solver=name, options=Options(time_limit=20))
        except SolverError as error:
            counts[f"{name}: refused"] += 1
            if name == "auto":
                found.append(f"{number}: auto refuses: {error}")
            continue
        counts[f"{name}: {solution.status}"] += 1
        if said := wrong(asked, best, solution):
            found.append(f"{number} ({SHAPES[number % len(SHAPES)]}): {name}: {said}")
    try:
        status = explain_program(asked, time_limit=20).status
    except SolverError:
        counts["explain: refused"] += 1
        return found
    counts[f"explain: {status}"] += 1
    if status != "unknown" and (status == "infeasible") != (best is None):
        found.append(f"{number}: explain says {status}")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--solvers", nargs="+", default=["auto", "highs", "scip", "glpk", "cpsat"])
    arguments = parser.parse_args()
    counts: Counter[str] = Counter()
    n_wrong = 0
    for number in range(arguments.first, arguments.first + arguments.programs):
        for line in examine(number, arguments.solvers, counts):
            n_wrong += 1
            print(line, flush=True)
    for what, count in sorted(counts.items()):
        print(f"{what}: {count}")
    print(f"{arguments.programs} programs, {n_wrong} wrong")
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
