"""Breakpoints, ties and non-dominated points, against all assignments in exact fractions."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples

from msmrta_opt.mission.errors import ModelError, SolverError
from msmrta_opt.optimise.compile import compile_for
from msmrta_opt.optimise.data import ClusterData, VictimData
from msmrta_opt.optimise.frontier import frontier, optima
from msmrta_opt.optimise.parametric import Envelope, Family, envelope
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve, solve_program

Pair = tuple[Fraction, Fraction]


def fraction_pairs(first: np.ndarray, second: np.ndarray) -> Iterator[Pair]:
    """Both objectives of every one-to-one assignment of largest size, exactly."""
    n, k = first.shape
    size = min(n, k)
    for rows in itertools.permutations(range(n), size):
        for columns in itertools.combinations(range(k), size):
            pairs = list(zip(rows, columns, strict=True))
            yield (
                sum((Fraction(float(first[p])) for p in pairs), Fraction(0)),
                sum((Fraction(float(second[p])) for p in pairs), Fraction(0)),
            )


@dataclass
class Case:
    """A family with its oracle: both objectives of every answer, and 1 to maximise, else -1."""

    family: Family
    points: list[Pair]
    sign: int

    def best(self, t: Fraction) -> Fraction:
        values = ((1 - t) * a + t * b for a, b in self.points)
        return max(values) if self.sign > 0 else min(values)


@st.composite
def cases(draw: st.DrawFn, largest: int = 3) -> Case:
    n, k = draw(st.integers(1, largest)), draw(st.integers(1, largest))
    numbers = st.integers(0, 9).map(lambda i: i / draw(st.sampled_from([1, 4])))
    first, second = (
        np.array(draw(st.lists(numbers, min_size=n * k, max_size=n * k))).reshape(n, k)
        for _ in range(2)
    )
    points = list(fraction_pairs(first, second))
    if draw(st.booleans()):
        data = ClusterData(first, second, np.full(n, 2))
        return Case(Family(compile_for("cluster_one_to_one", data), "psi"), points, 1)
    everyone = np.ones((n, k), dtype=bool)
    none = np.zeros(n)
    times = VictimData(first, second, everyone, none, np.full(n, k), np.full(n, np.inf))
    return Case(Family(compile_for("victim_one_to_one", times), "beta"), points, -1)


def assert_envelope(found: Envelope, case: Case) -> None:
    assert found.exact
    assert found.pieces[0].low == 0
    assert found.pieces[-1].high == 1
    for one, other in itertools.pairwise(found.pieces):
        assert one.low < one.high == other.low
        assert not one.line.same_line(other.line)
    for piece in found.pieces:
        for t in (piece.low, (2 * piece.low + piece.high) / 3, piece.high):
            assert piece.line.value(t) == case.best(t)


@given(case=cases())
@settings(max_examples=examples(150))
def test_the_pieces_are_those_of_all_assignments(case: Case) -> None:
    assert_envelope(envelope(case.family), case)


@given(case=cases())
@settings(max_examples=examples(60))
def test_the_frontier_is_every_point_that_no_other_beats(case: Case) -> None:
    found = frontier(case.family, envelope(case.family))
    assert found.complete
    signed = {(case.sign * a, case.sign * b) for a, b in case.points}
    best = {p for p in signed if not any(q != p and q[0] >= p[0] and q[1] >= p[1] for q in signed)}
    points = [(case.sign * x.line.at_zero, case.sign * x.line.at_one) for x in found.points]
    assert set(points) == best
    assert len(points) == len(best)
    for point, (a, b) in zip(found.points, points, strict=True):
        # Supported: no point of the convex hull beats it at every weight.
        weights = [Fraction(i, 720) for i in range(721)] + envelope(case.family).breakpoints
        touched = any(
            (1 - t) * a + t * b == max((1 - t) * c + t * d for c, d in signed) for t in weights
        )
        if touched:
            assert point.supported


def test_a_frontier_that_is_interrupted_keeps_the_points_it_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two robots, two clusters: (8, 1) and (2, 7) beat neither each other nor are beaten."""
    first, second = np.array([[5.0, 1.0], [1.0, 3.0]]), np.array([[0.0, 3.0], [4.0, 1.0]])
    data = ClusterData(first, second, np.full(2, 2))
    family = Family(compile_for("cluster_one_to_one", data), "psi")
    pieces = envelope(family)
    whole = frontier(family, pieces)
    assert (whole.complete, len(whole.points)) == (True, 2)
    solves = count()

    def interrupted_later(*arguments: Any, **options: Any) -> Solution:
        if next(solves) < 2:  # one for each objective of the first point
            return solve_program(*arguments, **options)
        monkeypatch.setattr("msmrta_opt.optimise.frontier.interrupted", lambda: True)
        raise SolverError("no_solution: interrupted")

    monkeypatch.setattr("msmrta_opt.optimise.frontier.solve_program", interrupted_later)
    found = frontier(family, pieces)
    assert not found.complete
    assert [x.line.at_zero for x in found.points] == [x.line.at_zero for x in whole.points[:1]]


@given(case=cases(largest=2), numerator=st.integers(0, 6))
@settings(max_examples=examples(40))
def test_every_tie_is_found(case: Case, numerator: int) -> None:
    t = Fraction(numerator, 6)
    found, all_of_them = optima(case.family, t, maximum=50)
    best = case.best(t)
    assert all_of_them
    assert len(found) == sum((1 - t) * a + t * b == best for a, b in case.points)
    assert all(line.value(t) == best for line in found)


def test_no_value_on_a_fine_grid_contradicts_the_pieces_of_a_large_case() -> None:
    random = np.random.RandomState(7)
    w, full = (random.randint(0, 40, (8, 30)).astype(float) for _ in range(2))
    data = ClusterData(w, full, np.full(8, 2))
    found = envelope(Family(compile_for("cluster_one_to_one", data), "psi"))
    assert len(found.pieces) > 5
    grid = np.linspace(0, 1, 10_001)
    lines = np.array([[float(p.line.at_zero), float(p.line.slope)] for p in found.pieces])
    values = lines[:, :1] + lines[:, 1:] * grid
    highs = np.array([float(piece.high) for piece in found.pieces])
    chosen = values[np.searchsorted(highs, grid).clip(max=len(highs) - 1), np.arange(len(grid))]
    # The envelope of a maximisation is convex: each line that is optimal somewhere lies below it.
    np.testing.assert_allclose(chosen, values.max(axis=0), rtol=0, atol=1e-9)
    for psi in grid[::500]:
        one = solve("cluster_one_to_one", data, psi=float(psi), structure=False)
        assert one.objective == pytest.approx(float(found.at(float(psi)).line.value(Fraction(psi))))


def test_data_that_are_not_rational_are_solved_to_a_tolerance() -> None:
    random = np.random.RandomState(3)
    first, second = random.random_sample((4, 4)), random.random_sample((4, 4))
    data = ClusterData(first, second, np.full(4, 2))
    found = envelope(Family(compile_for("cluster_one_to_one", data), "psi"))
    assert not found.exact
    points = list(fraction_pairs(first, second))
    for t in (Fraction(i, 50) for i in range(51)):
        best = max((1 - t) * a + t * b for a, b in points)
        assert float(found.at(t).line.value(t)) == pytest.approx(float(best), rel=1e-9)


def test_a_parameter_that_enters_the_rows_is_refused() -> None:
    ones = np.ones((2, 2))
    data = VictimData(2 * ones, ones, ones > 0, np.zeros(2), np.ones(2, int), np.full(2, np.inf))
    with pytest.raises(ModelError, match="victim_balanced: beta enters the rows"):
        Family(compile_for("victim_balanced", data), "beta")
    with pytest.raises(ModelError, match="no parameter 'psi'"):
        Family(compile_for("victim_covering", data), "psi")
