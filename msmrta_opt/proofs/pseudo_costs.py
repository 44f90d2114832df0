"""Pseudo-costs: what branching on a column has gained so far, and promises (Benichou et al. 1971)."""

from __future__ import annotations

from dataclasses import dataclass, field

RELIABLE = 4
"""Trials after which a column's pseudo-costs are believed."""


@dataclass
class PseudoCosts:
    """How much the bound rose per unit of a column's distance, by direction, and how often that was."""

    sums: dict[tuple[int, bool], float] = field(default_factory=dict)
    counts: dict[tuple[int, bool], int] = field(default_factory=dict)
    _all: dict[bool, tuple[float, int]] = field(default_factory=dict)

    def learn(self, column: int, up: bool, gain: float, distance: float) -> None:
        """Note a trial."""
        key, rate = (column, up), gain / max(distance, 1e-6)
        self.sums[key] = self.sums.get(key, 0.0) + rate
        self.counts[key] = self.counts.get(key, 0) + 1
        total, trials = self._all.get(up, (0.0, 0))
        self._all[up] = total + rate, trials + 1

    def reliable(self, column: int) -> bool:
        """Whether both directions were tried often enough."""
        return all(self.counts.get((column, up), 0) >= RELIABLE for up in (False, True))

    def score(self, column: int, fraction: float) -> float:
        """What branching on the column promises."""
        gains = []
        for up, distance in ((False, fraction), (True, 1 - fraction)):
            tried = self.counts.get((column, up), 0)
            if tried:
                average = self.sums[column, up] / tried
            else:
                total, trials = self._all.get(up, (1.0, 1))
                average = total / trials
            gains.append(average * distance)
        return product(*gains)


def product(down: float, up: float) -> float:
    """The score of two gains."""
    return max(down, 1e-9) * max(up, 1e-9)
