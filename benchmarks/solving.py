"""What solving costs beyond the solver: against raw highspy, without structure, and when solved again.

    python benchmarks/solving.py [--repetitions 9]

Raw highspy gets the same arrays, ready-made, and solves them as an integer program; cvxpy builds the
same problem and canonicalises it for HiGHS, and solves nothing. Each figure is a median over different
data; ratios are medians of the ratios on the same data.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import cvxpy as cp
import numpy as np

import msmrta_opt as mo
from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.registry import get
from msmrta_opt.optimise.solvers import Options
from msmrta_opt.optimise.solvers.highs import run as raw_highs


def clusters(n_robots: int, n_clusters: int, seed: int) -> mo.ClusterData:
    """Random data of Eq. 1."""
    random = np.random.RandomState(seed)
    w = random.randint(0, 30, (n_robots, n_clusters)).astype(float)
    full = np.minimum(w, random.randint(0, 30, (n_robots, n_clusters))).astype(float)
    return mo.ClusterData(w, full, np.full(n_robots, 2))


def victims(n_robots: int, n_victims: int, seed: int) -> mo.VictimData:
    """Random data of Eq. 2."""
    random = np.random.RandomState(seed)
    can = random.random_sample((n_robots, n_victims)) < 0.5
    busy = random.randint(0, 100, n_robots).astype(float)
    success = (busy[:, None] + random.randint(1, 200, can.shape)) * can
    failure = random.randint(0, 60, can.shape) * can
    return mo.VictimData(
        success.astype(float),
        failure.astype(float),
        can,
        busy,
        np.full(n_robots, n_victims),
        np.full(n_robots, np.inf),
    )


def seconds(call: Callable[[], object]) -> float:
    """Wall time of one call."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def again(model: str, data: object) -> mo.Solution:
    """Solve with another value of the formulation's parameter."""
    values: dict[str, Any] = dict.fromkeys(get(model).spec.parameters, 0.3)
    return mo.solve(model, data, **values)


def cvxpy_canonicalises(model: str, data: object) -> None:
    """Build and canonicalise as cvxpy itself does it for HiGHS, parameters at their defaults."""
    formulation = get(model)
    problem = formulation.build(data)
    for name, parameter in problem.param_dict.items():
        parameter.value = formulation.spec.parameters[name].default
    problem.get_problem_data(cp.HIGHS)


def measure(model: str, data: Callable[[int], object], repetitions: int) -> dict[str, float]:
    """Median milliseconds and ratios of one formulation."""
    rows: dict[str, list[float]] = {}
    for seed in range(repetitions + 1):
        one, other = data(seed), data(seed)
        program = compile_formulation(get(model), data(seed)).program()
        row = {
            "raw highspy": seconds(partial(raw_highs, program, Options())),
            "cvxpy": seconds(partial(cvxpy_canonicalises, model, data(seed))),
            "canonicalise": compile_formulation(get(model), data(seed)).seconds,
            "first solve": seconds(partial(mo.solve, model, one)),
            "solve again": seconds(partial(again, model, one)),
            "no structure": seconds(partial(mo.solve, model, other, structure=False)),
        }
        row["first/raw"] = row["first solve"] / row["raw highspy"]
        row["again/first"] = row["solve again"] / row["first solve"]
        row["no structure/first"] = row["no structure"] / row["first solve"]
        row["first/cvxpy"] = row["first solve"] / row["cvxpy"]
        if seed:  # the first loads what is loaded once
            for name, value in row.items():
                rows.setdefault(name, []).append(value)
    return {name: statistics.median(values) for name, values in rows.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=9)
    repetitions = parser.parse_args().repetitions
    cases: list[tuple[str, str, Callable[[int], object], int]] = [
        ("cluster_one_to_one", "10×10", lambda s: clusters(10, 10, s), repetitions),
        ("cluster_one_to_one", "10×100", lambda s: clusters(10, 100, s), repetitions),
        ("cluster_budgeted", "10×100", lambda s: clusters(10, 100, s), repetitions),
        ("victim_one_to_one", "10×100", lambda s: victims(10, 100, s), repetitions),
        ("victim_covering", "10×100", lambda s: victims(10, 100, s), repetitions),
        ("cluster_one_to_one", "100×1000", lambda s: clusters(100, 1000, s), 2),
    ]
    times = ["raw highspy", "cvxpy", "canonicalise", "first solve", "solve again", "no structure"]
    ratios = ["first/raw", "again/first", "no structure/first", "first/cvxpy"]
    print("Median milliseconds, then medians of ratios")
    print(f"{'formulation':20s}{'size':>10s}" + "".join(f"{name:>20s}" for name in times + ratios))
    for model, size, data, count in cases:
        row = measure(model, data, count)
        cells = [f"{row[name] * 1e3:20.2f}" for name in times]
        cells += [f"{row[name]:20.2f}" for name in ratios]
        print(f"{model:20s}{size:>10s}" + "".join(cells))
    large = [clusters(100, 5000, seed) for seed in range(3)]
    ratio = [
        seconds(partial(mo.solve, "cluster_one_to_one", data))
        / seconds(partial(cvxpy_canonicalises, "cluster_one_to_one", data))
        for data in large
    ]
    print(f"\n100×5000: solved in {statistics.median(ratio):.2f}× cvxpy's canonicalisation time")


if __name__ == "__main__":
    main()
