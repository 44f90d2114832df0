"""A witness that two formulations differ: a smallest generated mission on which their optima do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...diagnosis.difference import Difference, diff
from ...interruption import interrupted, interruptible
from ...mission.errors import InputError, ModelError, MsmrtaError
from ...mission.generate import KINDS, generate_mission
from ...mission.instance import Instance
from ...mission.layouts import rubble
from ...optimise.registry import Formulation
from ...optimise.subject import own_parameters
from ...stages.data import stage_data
from ...stages.options import StagedOptions

SEEDS = 4
"""Missions of one size."""
SIDE = 6
"""Cells along a side of the map."""
SECONDS = 10.0
"""For each comparison."""


@dataclass(frozen=True)
class Witness:
    """What a search for a mission on which two formulations differ has come to."""

    mission: Instance | None
    """The first on which their optima differ, ``None`` if none does."""
    difference: Difference | None
    tried: int
    """Missions that were compared."""
    failed: int = 0
    """Missions that could not be compared: without such victims, or not solved in time."""
    reason: str = ""
    """Of the first of them."""

    @property
    def text(self) -> str:
        """The result in words."""
        if self.mission is None or self.difference is None:
            if not self.failed:
                return f"No witness: the optima agree on {self.tried} generated missions."
            return (
                f"No witness: the optima agree on {self.tried} generated missions; {self.failed} more"
                f" could not be compared: {self.reason}"
            )
        return (
            f"A witness, the {self.tried}. mission tried: {self.mission.n_robots} robots and"
            f" {self.mission.n_victims} victims ({self.mission.name}).\n{self.difference.text}"
        )


def sizes() -> Iterator[tuple[int, int]]:
    """Numbers of robots and victims, the smallest missions first."""
    total = 2
    while True:
        yield from ((robots, total - robots) for robots in range(1, total))
        total += 1


def witness(
    a: Formulation,
    b: Formulation,
    *,
    tries: int = 200,
    options: StagedOptions | None = None,
    **parameters: float,
) -> Witness:
    """Look for a smallest generated mission on which the optima of `a` and `b` differ.

    Parameters
    ----------
    a, b : Formulation
        Of one stage.
    tries : int
        Missions to try, from one robot and one victim on.
    options : StagedOptions, optional
        Of the stages before.
    **parameters : float
        The formulations' parameters; each takes those that it has.

    Raises
    ------
    InputError
        If they are of different stages, `tries` is not positive, or a parameter is wrong.
    ModelError
        If one cannot be built on one of the missions.
    """
    if a.spec.stage != b.spec.stage:
        raise InputError(
            f"{a.name} is of stage {a.spec.stage!r}, {b.name} of {b.spec.stage!r}; give two of one"
        )
    if tries < 1:
        raise InputError(f"{tries}; give 1 or more", field="tries")
    own_parameters((a, b), parameters)
    tried = failed = 0
    first: MsmrtaError | None = None
    unsettled = "a solve came to no optimum"
    with interruptible():
        for robots, victims in sizes():
            for seed in range(SEEDS):
                if tried + failed >= tries or interrupted():
                    return Witness(None, None, tried, failed, str(first or unsettled))
                mission = _mission(robots, victims, seed)
                try:
                    data = stage_data(mission, a.spec.stage, options)
                    found = diff(a, b, data, time_limit=SECONDS, **parameters)
                except ModelError:
                    raise
                except MsmrtaError as error:
                    failed += 1
                    first = first or error
                    continue
                if found.optima_differ is None:
                    failed += 1
                    continue
                tried += 1
                if found.optima_differ:
                    return Witness(mission, found, tried, failed)
    raise AssertionError  # sizes do not end


def _mission(robots: int, victims: int, seed: int) -> Instance:
    """On open ground for even seeds, else on ground of which a quarter is blocked."""
    grid = rubble(SIDE, SIDE, seed=seed, density=0.25 * (seed % 2))
    kinds = min(len(KINDS), 3 * robots)
    return generate_mission(
        grid, robots, victims, seed=seed, kinds=kinds, per_victim=(1, min(2, kinds))
    )
