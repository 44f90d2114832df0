"""Why an entry of a stage's variable must be 0: what a robot lacks, or cannot reach, in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ..optimise.mission_data import MissionData
from ..optimise.program import Program
from .conflict import bound_name

LACKS, UNREACHED = "has nothing that is needed at", "cannot reach"
TAKEN = "finds nothing left to do at"


class Forbidden(NamedTuple):
    """Why a robot does nothing at a victim: ``robot 0 cannot reach victim 3``."""

    robot: str
    why: str
    """`LACKS`, `UNREACHED`, or `TAKEN` by a stage before."""
    victim: str
    kinds: tuple[str, ...] = ()
    """What is needed there, or what the stage before took."""

    @property
    def text(self) -> str:
        """In words, with the kinds."""
        taken = "an earlier stage took " if self.why == TAKEN else ""
        kinds = f" ({taken}{', '.join(self.kinds)})" if self.kinds else ""
        return f"robot {self.robot} {self.why} victim {self.victim}{kinds}"


def forbidden(program: Program, data: object) -> dict[str, Forbidden]:
    """By the bound of a column, ``x[0,1] ≤ 0``, why it is 0, where the mission behind `data` says so."""
    if not isinstance(data, MissionData) or data.around is None:
        return {}
    found = {}
    for block in program.columns:
        letters = data.solution.get(block.name, ())
        if block.name not in data.may_be_one or "r" not in letters:
            continue
        may_be_one = np.asarray(getattr(data, data.may_be_one[block.name]))
        if may_be_one.shape != block.shape:
            continue
        for place in np.argwhere(~may_be_one):
            column = block.start + int(np.ravel_multi_index(tuple(place), block.shape, order="F"))
            why = _why(data, dict(zip(letters, place.tolist(), strict=True)))
            if why is not None and program.upper[column] == 0:
                found[bound_name(program, column, False, True)] = why
    return found


def _why(data: MissionData, place: Mapping[str, int]) -> Forbidden | None:
    """Why a robot does nothing at a victim, or at one of two, if the mission says it."""
    assert data.around is not None
    around, mission = data.around, data.around.mission
    robot = mission.robots[place["r"]]
    for letter in ("v", "j", "i"):
        at = place.get(letter, mission.n_victims)
        if at >= mission.n_victims:  # the start
            continue
        victim = mission.victims[at]
        needed = victim.requirements
        if "k" in place:
            needed = tuple(kind for kind in needed if kind == mission.capabilities[place["k"]])
        if not needed:
            continue
        can = tuple(kind for kind in needed if kind in robot.capabilities)
        if not can:
            return Forbidden(str(robot.id), LACKS, str(victim.id), tuple(needed))
        walk = around.distances.between([around.robots[place["r"]]], [victim.cell])
        if not np.isfinite(walk).all():
            return Forbidden(str(robot.id), UNREACHED, str(victim.id))
        if data.stage == "victim":
            return Forbidden(str(robot.id), TAKEN, str(victim.id), can)
    return None


def in_words(bounds: Iterable[str], why: Mapping[str, Forbidden]) -> tuple[str, ...]:
    """A line for each robot and what stops it, with all its victims; then the bounds that are left."""
    victims: dict[tuple[str, str], list[str]] = {}
    rest = []
    for bound in bounds:
        if bound in why:
            found = why[bound]
            victims.setdefault((found.robot, found.why), []).append(found.victim)
        else:
            rest.append(bound)
    lines = []
    for (robot, what), names in victims.items():
        each = list(dict.fromkeys(names))
        last = f" and {each[-1]}" if len(each) > 1 else each[-1]
        where = f"victim{'s' * (len(each) > 1)} {', '.join(each[:-1])}{last}"
        lines.append(f"robot {robot} {what} {where}")
    return (*lines, *rest)
