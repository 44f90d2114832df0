"""Every breakpoint of ψ against a sweep over 101 values that builds and solves anew each time.

    python benchmarks/tradeoff.py [--seeds 5]

Eq. 1 one to one, on random missions with 10 robots and 100 victims over map 2. The sweep is what one
would write by hand: cvxpy's own `Problem.solve` by HiGHS at 0, 0.01, … 1. Its values are compared
with those of the pieces.
"""

from __future__ import annotations

import argparse
import statistics
import time
from fractions import Fraction
from pathlib import Path

import cvxpy as cp
import numpy as np

import msmrta_opt as mo
from msmrta_opt.optimise.compile import compile_for
from msmrta_opt.optimise.parametric import Family, envelope
from msmrta_opt.optimise.registry import get

MAP = Path(__file__).parents[1] / "instances" / "maps" / "map2.map"
MODEL = "cluster_one_to_one"


def sweep(data: mo.ClusterData) -> list[float]:
    """Optimal values at 101 values of ψ."""
    values = []
    for psi in np.linspace(0, 1, 101):
        problem = get(MODEL).build(data)
        problem.param_dict["psi"].value = psi
        values.append(float(problem.solve(solver=cp.HIGHS)))
    return values


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    grid = mo.read_map(MAP)
    ratios = []
    for seed in range(parser.parse_args().seeds + 1):
        mission = mo.generate_mission(grid, 10, 100, seed=seed, solvable=False)
        data = mo.stage_data(mission, "cluster")
        began = time.perf_counter()
        pieces = envelope(Family(compile_for(MODEL, data), "psi"))
        exact = time.perf_counter() - began
        began = time.perf_counter()
        values = sweep(data)
        swept = time.perf_counter() - began
        for psi, value in zip(np.linspace(0, 1, 101), values, strict=True):
            difference = abs(value - float(pieces.at(float(psi)).line.value(Fraction(psi))))
            if difference > 1e-6:
                raise SystemExit(f"seed {seed}: the sweep and the pieces differ at ψ = {psi}")
        if seed:  # the first loads what is loaded once
            ratios.append(swept / exact)
            print(
                f"seed {seed}: {len(pieces.pieces)} pieces by {pieces.n_solves} solves in"
                f" {exact * 1e3:.1f} ms; the sweep takes {swept * 1e3:.0f} ms, {ratios[-1]:.0f}×"
            )
    print(f"median {statistics.median(ratios):.0f}×")


if __name__ == "__main__":
    main()
