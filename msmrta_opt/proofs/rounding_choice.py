"""How to round an equation: from which ends its terms are measured, and by what it is divided.

By the heuristic of Marchand and Wolsey (2001): δ is the size of a coefficient whose term is between its
bounds, or a half, a quarter or an eighth of the best of these; then terms are measured from their other
ends, one after another, as long as the cut is violated more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Bools, Floats

HALVINGS = 3
INSIDE = 1e-6
"""Distance from its bounds beyond which a value is between them."""


@dataclass(frozen=True)
class Equation:
    """Σ a t + (the rest) = side in integer terms t, of which values at a point are known.

    `rest` is the sum of the negative coefficients of continuous terms times their values, and
    `rest_square` the sum of their squares.
    """

    a: Floats
    t: Floats
    room: Floats
    """The largest values of the terms."""
    side: float
    rest: float
    rest_square: float

    def best_rounding(self) -> tuple[Bools, float, float] | None:
        """Which terms to measure from their other end, δ, and the violation over the length."""
        inside = (self.t > INSIDE) & (self.t < self.room - INSIDE)
        sizes = np.unique(np.round(np.abs(self.a[inside]), 9))[::-1]
        sizes = sizes[sizes > 1e-7][:8]
        if not len(sizes):
            return None
        flipped: Bools = np.zeros(len(self.a), dtype=bool)
        maximum, delta = max((self._efficacy(flipped, float(d)), float(d)) for d in sizes)
        for k in range(1, HALVINGS + 1):
            efficacy = self._efficacy(flipped, delta / 2**k)
            if efficacy > maximum:
                maximum, delta = efficacy, delta / 2**k
        flexible = np.flatnonzero(inside & np.isfinite(self.room))
        for i in flexible[np.argsort(np.abs(self.t - self.room / 2)[flexible], kind="stable")][:20]:
            flipped[i] ^= True
            efficacy = self._efficacy(flipped, delta)
            if efficacy > maximum:
                maximum = efficacy
            else:
                flipped[i] ^= True
        return flipped, delta, maximum

    def rounding(self, flipped: Bools, delta: float) -> tuple[float, float, Floats]:
        """The side over δ, its fraction, and the coefficients of the terms in the cut."""
        a = np.where(flipped, -self.a, self.a) / delta
        side = (self.side - float(self.a[flipped] @ self.room[flipped])) / delta
        fraction = side - math.floor(side)
        if not 0.005 < fraction < 0.995:
            return 0.0, 1.0, np.zeros(len(a))
        below = np.floor(a)
        return side, fraction, below + np.maximum(0.0, a - below - fraction) / (1 - fraction)

    def _efficacy(self, flipped: Bools, delta: float) -> float:
        side, fraction, g = self.rounding(flipped, delta)
        if fraction == 1.0:
            return -1.0
        t = np.where(flipped, self.room - self.t, self.t)
        scale = 1 / (delta * (1 - fraction))
        length = math.sqrt(float(g @ g) + self.rest_square * scale**2)
        return (float(g @ t) + self.rest * scale - math.floor(side)) / max(length, 1e-9)
