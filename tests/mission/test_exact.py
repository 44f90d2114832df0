"""Which fraction a number stands for: by hand, at every power of ten, and against brute force."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.mission.exact import exact, greatest_common_divisor


@pytest.mark.parametrize(
    ("number", "fraction"),
    [
        (0.3, Fraction(3, 10)),
        (0.1 + 0.2, Fraction(3, 10)),
        (1 / 3, Fraction(1, 3)),
        (7 / 0.3, Fraction(70, 3)),
        (12, Fraction(12)),
        (0, Fraction(0)),
        (-0.0, Fraction(0)),
        (-2.5, Fraction(-5, 2)),
        (0.0001, Fraction(1, 10_000)),
        (1e-9, Fraction(1, 10**9)),
        (123456.789, Fraction(123_456_789, 1000)),
        (0.123456789012345, Fraction(123_456_789_012_345, 10**15)),
        (10**30 + 1, Fraction(10**30 + 1)),
        (1e300, Fraction(10**300)),
        (math.pi, Fraction(math.pi)),
        (5e-324, Fraction(5, 10**324)),
    ],
)
def test_a_number_is_the_fraction_that_it_is_written_for(number: float, fraction: Fraction) -> None:
    assert exact(number) == fraction


@given(
    steps=st.integers(1, 100_000),
    speed=st.sampled_from(["0.2", "0.3", "0.31", "1.3", "0.37", "2.75", "0.7"]),
    power=st.integers(-9, 9),
)
def test_times_of_walking_are_exact_in_every_unit(steps: int, speed: str, power: int) -> None:
    written = float(f"{speed}e{power}")
    assert exact(written) == Fraction(speed) * Fraction(10) ** power
    assert exact(steps / written) == steps / (Fraction(speed) * Fraction(10) ** power)


@given(number=st.floats(1e-300, 1e300))
def test_no_fraction_is_further_from_its_number_than_rounding(number: float) -> None:
    assert abs(exact(number) - Fraction(number)) <= Fraction(number) / 2**50


@given(number=st.floats(1.0, 9.999), limit=st.integers(1, 200))
def test_a_simple_fraction_comes_back_from_its_float(number: float, limit: int) -> None:
    """Every fraction of a small denominator comes back from its float."""
    near = Fraction(round(number * limit), limit)
    assert exact(float(near)) == near


def test_the_greatest_common_divisor_of_times_is_exact() -> None:
    """1/0.3 and 1/0.4 are 10/3 and 5/2, both multiples of 5/6."""
    thirds, halves = Fraction(10, 3), Fraction(5, 2)
    assert greatest_common_divisor([thirds, halves]) == Fraction(5, 6)
    assert greatest_common_divisor([Fraction(0), Fraction(4)]) == 4
    assert greatest_common_divisor([]) == 0
