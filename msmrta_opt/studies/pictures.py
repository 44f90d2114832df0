"""Pictures of comparisons: the performance profile."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from .compare import Row

LINES = ("-", "--", "-.", ":")
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""


def performance_profile(rows: Sequence[Row], ax: Axes | None = None) -> Axes:
    """Share of programs that each solver solves within a factor of the best solver's time.

    A program is one formulation on one instance with one seed; only those that some solver solved
    to optimality count. Source: Dolan and Moré (2002).
    """
    ax = ax or Figure(figsize=(7.5, 4.8), layout="constrained").subplots()
    ratios, n_programs = _ratios(rows)
    worst = max((max(values, default=1.0) for values in ratios.values()), default=1.0) * 1.3
    for i, (solver, values) in enumerate(ratios.items()):
        steps = np.sort(values)
        x = np.concatenate([[1.0], np.repeat(steps, 2), [worst]])
        share = np.arange(len(steps) + 1) / max(n_programs, 1)
        y = np.concatenate([[0.0], np.repeat(share, 2)[1:-1], [share[-1]]])
        ax.plot(
            x,
            100 * y,
            color=COLOURS[i % len(COLOURS)],
            linestyle=LINES[i // len(COLOURS) % len(LINES)],
            linewidth=2,
            label=f"{solver} ({len(steps)} of {n_programs})",
        )
    ax.set_xscale("log")
    ax.set_xlim(1.0, worst)
    factors = FuncFormatter(lambda factor, _: f"{factor:g}×")
    ax.xaxis.set_major_formatter(factors)
    ax.xaxis.set_minor_formatter(factors if worst < 10 else NullFormatter())
    ax.set_ylim(-2, 102)
    ax.set_xlabel("time, as a multiple of the best solver's on the same program")
    ax.set_ylabel("programs solved to optimality (%)")
    ax.set_title(f"Performance profile over {n_programs} programs")
    ax.grid(alpha=0.3)
    if ratios:
        ax.legend(title="solver (programs solved)", loc="lower right")
    return ax


def _ratios(rows: Sequence[Row]) -> tuple[dict[str, list[float]], int]:
    """Per solver the ratios of the programs that it solved, and the number of programs."""
    times: dict[tuple[str, str, int | None], dict[str, float]] = {}
    ratios: dict[str, list[float]] = {}
    for row in rows:
        if row.status == "skipped":
            continue
        ratios.setdefault(row.solver, [])
        if row.status == "optimal" and row.total_seconds is not None:
            program = (row.instance, row.model, row.seed)
            times.setdefault(program, {})[row.solver] = row.total_seconds
    for solved in times.values():
        best = min(solved.values())
        for solver, seconds in solved.items():
            ratios[solver].append(seconds / best)
    return ratios, len(times)
