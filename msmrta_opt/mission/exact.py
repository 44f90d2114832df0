"""Which fraction a number of a file stands for: one rule for all who count exactly.

Nothing but 0 is 0, and the unit does not matter: a mission in other units, with all its times ten
times as long, has all its fractions ten times as large.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction

_ROUNDING_BITS = 51
"""One operation on floats is off by less than a share of 2 to the minus so many bits."""
_LARGEST_DENOMINATOR = 1_000_000
_DIGITS = 15
"""Decimals of so many digits come back from a float as they were."""


def exact(number: float) -> Fraction:
    """The fraction that `number`, which is finite, is written for.

    That is a simple one within its rounding (3/10 for 0.3, 70/3 for ``7 / 0.3``), up to a power of
    ten; else the decimal that it prints as, if that is short; else `number` itself.
    """
    own = Fraction(number)
    if isinstance(number, int) or (own.denominator == 1 and abs(own) < 2**53):
        return own
    if number < 0:
        return -exact(-number)
    decimal = Decimal(repr(float(number)))
    power = decimal.adjusted()
    top = own.numerator * 10 ** max(-power, 0)
    bottom = own.denominator * 10 ** max(power, 0)
    if simple := _simple(top, bottom):
        return simple * Fraction(10) ** power
    return Fraction(decimal) if len(decimal.as_tuple().digits) <= _DIGITS else own


def _simple(top: int, bottom: int) -> Fraction | None:
    """The fraction of the smallest denominator within rounding of ``top / bottom``, above 0.

    By continued fractions: as many terms as both ends of the interval share, and one more.
    """
    low = (top * (2**_ROUNDING_BITS - 1), bottom << _ROUNDING_BITS)
    high = (top * (2**_ROUNDING_BITS + 1), bottom << _ROUNDING_BITS)
    before, now = (0, 1), (1, 0)
    while True:
        term = -(-low[0] // low[1])
        last = term * high[1] <= high[0]
        term -= not last
        before, now = now, (before[0] + term * now[0], before[1] + term * now[1])
        if now[1] > _LARGEST_DENOMINATOR:
            return None
        if last:
            return Fraction(*now)
        low, high = (
            (high[1], high[0] - term * high[1]),
            (low[1], low[0] - term * low[1]),
        )


def greatest_common_divisor(numbers: Iterable[Fraction]) -> Fraction:
    """The largest fraction of which all `numbers` are multiples; 0 if all are 0."""
    divisor = Fraction(0)
    for number in set(numbers):
        top = math.gcd(
            divisor.numerator * number.denominator, number.numerator * divisor.denominator
        )
        divisor = Fraction(top, divisor.denominator * number.denominator)
    return divisor
