"""What latency has to serve: requirements, joined where one robot will do them in one visit anyway."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Bools
from ..problem import RoutingData


@dataclass(frozen=True, eq=False)
class Tasks:
    """The requirements by number.

    Those of one victim that only one and the same robot can serve are one task: it serves them
    together, since it visits a victim at most once.
    """

    victim: tuple[int, ...]
    """The victim of each task."""
    kinds: tuple[tuple[int, ...], ...]
    """The kinds of requirement that make up each task."""
    service: tuple[float, ...]
    """Service time of each task."""
    able: Bools
    """Whether robot r can serve task g, ``(n_robots, n_tasks)``."""
    of: tuple[tuple[int, ...], ...]
    """The tasks of each victim."""

    @classmethod
    def from_data(cls, data: RoutingData) -> Tasks:
        """The tasks of the joint problem."""
        victim: list[int] = []
        kinds: list[tuple[int, ...]] = []
        of: list[tuple[int, ...]] = []
        for v in range(data.n_victims):
            together: dict[tuple[int, ...], list[int]] = {}
            for k in np.flatnonzero(data.required[v]).tolist():
                who = np.flatnonzero(data.able[:, v, k]).tolist()
                together.setdefault((who[0],) if len(who) == 1 else (-1, k), []).append(k)
            of.append(tuple(range(len(victim), len(victim) + len(together))))
            victim += [v] * len(together)
            kinds += [tuple(own) for own in together.values()]
        return cls(
            victim=tuple(victim),
            kinds=tuple(kinds),
            service=tuple(
                float(data.service[v, list(k)].sum()) for v, k in zip(victim, kinds, strict=True)
            ),
            able=data.able[:, victim, [k[0] for k in kinds]],
            of=tuple(of),
        )

    def __len__(self) -> int:
        return len(self.victim)

    def split(self, v: int) -> bool:
        """Whether the tasks of victim `v` may be served by different robots."""
        return len(self.of[v]) > 1

    def served(self, v: int, kinds: tuple[int, ...]) -> tuple[int, ...]:
        """The tasks of victim `v` that consist of `kinds`."""
        return tuple(g for g in self.of[v] if set(self.kinds[g]) <= set(kinds))

    def in_one_visit(self, robot: int, v: int) -> int:
        """How many tasks of victim `v` a robot can serve."""
        return sum(bool(self.able[robot, g]) for g in self.of[v])
