"""Options of the staged planner, checked, and its two presets.

``paper`` reads the paper's text; ``authors`` follows the authors' program where the two differ.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, fields, replace
from numbers import Integral, Real
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..mission.errors import InputError, ModelError
from ..mission.suggestions import meant, none_of
from ..optimise import registry

Weights = Literal["text", "authors"]
Members = Literal["all", "partial"]
Performance = Literal["pair", "robot"]
Award = Literal["sealed", "sequential"]
CHOICES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "weights": get_args(Weights),
        "members": get_args(Members),
        "performance": get_args(Performance),
        "award": get_args(Award),
    }
)
"""The values of options that are words."""


@dataclass(frozen=True)
class StagedOptions:
    """How the staged planner plans; each field is an option of `plan` and of the command line."""

    psi: float = 0.95
    """ψ of Eq. 1, importance of full over partial satisfaction, 0 to 1."""
    beta: float = 0.5
    """β of Eq. 2, importance of failure time over success time, 0 to 1."""
    clustering_model: str | None = None
    """Formulation that groups the victims; without one, K-means does."""
    cluster_model: str = "cluster_one_to_one"
    """Formulation of Eq. 1."""
    victim_model: str = "victim_one_to_one"
    """Formulation of Eq. 2."""
    seed: int = 0
    """Of scouting and K-means."""
    weights: Weights = "text"
    """What w of Eq. 1 counts of what r can serve in c: all of it (``text``), or only that of
    victims that r satisfies partially (``authors``)."""
    members: Members = "all"
    """Which members of its cluster a robot serves: all that it can, or only those that it
    satisfies partially (``partial``)."""
    performance: Performance = "pair"
    """Times of Eq. 2 per robot and victim (``pair``), or per robot alone (``robot``)."""
    award: Award = "sealed"
    """Auction with all bids in before any award (``sealed``), or with the winner's queue, and so
    its next bid, updated after each award (``sequential``)."""
    through_centre: bool = True
    """Whether a robot passes its cluster's centre."""
    pinned_clusters: bool = True
    """Whether the instance's own clusters are used where it has them."""
    budget: int = 2
    """Maximum number of clusters, or victims, of a robot, in formulations that limit them."""
    endurance: float | None = None
    """Maximum time that a robot may be busy, in formulations of Eq. 2 that limit it."""
    solver: str = "auto"
    """Who solves the formulations of the stages: ``auto``, or a solver's name."""
    apart: str = ""
    """Ids of robots, with commas between, that take no neighbouring clusters, in formulations of Eq. 1
    that keep them apart."""
    walk: str = "ant_colony"
    """How scouts walk."""
    shared_table: bool = True
    """Whether scouts share one table of visits."""
    params: tuple[tuple[str, float], ...] = ()
    """Values of parameters of the formulations' own, by name; `of` takes them like options."""

    def __post_init__(self) -> None:
        for name in ("psi", "beta"):
            self._check(name, Real, float, 0, 1, "a number from 0 to 1")
        self._check("budget", Integral, int, 1, np.inf, "a whole number, 1 or more")
        self._check("seed", Integral, int, 0, 2**32 - 1, "a whole number, 0 to 2**32 - 1")
        if self.endurance is not None:
            self._check("endurance", Real, float, 0, sys.float_info.max, "time units, 0 or more")
        object.__setattr__(self, "apart", str(self.apart))
        if not all(text.strip().isdecimal() for text in self.apart.split(",") if self.apart):
            raise InputError(f"{self.apart!r}; give ids of robots, such as 0,2", field="apart")
        for name in ("through_centre", "pinned_clusters", "shared_table"):
            if not isinstance(getattr(self, name), (bool, np.bool_)):
                raise InputError(f"{getattr(self, name)!r}; give true or false", field=name)
        for name, choices in CHOICES.items():
            if getattr(self, name) not in choices:
                value = getattr(self, name)
                near = meant(value, choices)
                raise InputError(f"{value!r}{near}; give one of {', '.join(choices)}", field=name)

    def _check(
        self, name: str, kind: type, plain: type, minimum: float, maximum: float, right: str
    ) -> None:
        """Refuse what is not a number in its range; numpy's numbers become Python's."""
        value = getattr(self, name)
        is_number = isinstance(value, kind) and not isinstance(value, (bool, np.bool_))
        if not (is_number and minimum <= value <= maximum):
            raise InputError(f"{value!r}; give {right}", field=name)
        object.__setattr__(self, name, plain(value))

    @classmethod
    def of(cls, preset: str = "paper", **changes: Any) -> StagedOptions:
        """A preset with some options changed.

        Raises
        ------
        InputError
            If the preset or an option is unknown, or a value is out of range.
        """
        if preset not in PRESETS:
            raise none_of(preset, PRESETS, "preset")
        known = [item.name for item in fields(cls) if item.name != "params"]
        own = {name: value for name, value in changes.items() if name in known}
        options = cls(**{**PRESETS[preset], **own})
        more = {name: value for name, value in changes.items() if name not in known}
        if not more:
            return options
        there = options.parameters
        for name in more:
            if name not in there:
                every = ", ".join([*known, *(x for x in there if x not in known)])
                raise InputError(
                    f"no such option{meant(name, [*known, *there])}; there are {every}", field=name
                )
        return replace(options, params=tuple(sorted(more.items())))

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters of the formulations, by name; none of a file that does not load."""
        found: dict[str, None] = {}
        for name in self.formulations:
            with suppress(ModelError):
                found |= dict.fromkeys(registry.get(name).spec.parameters)
        return tuple(found)

    def values_for(self, formulation: registry.Formulation) -> dict[str, Any]:
        """The values of the parameters of `formulation`: those given, or options of the same name."""
        known, names = formulation.spec.parameters, {item.name for item in fields(self)}
        given = {name: getattr(self, name) for name in known if name in names}
        return given | {name: value for name, value in self.params if name in known}

    def named_robots(self, ids: Sequence[int]) -> NDArray[np.bool_]:
        """Whether ``apart`` names each of the robots `ids`, shape ``(n_robots,)``.

        Raises
        ------
        InputError
            If it names another.
        """
        named = [int(text) for text in self.apart.split(",") if text]
        if unknown := [robot for robot in named if robot not in ids]:
            there = ", ".join(map(str, ids))
            raise InputError(f"no robot {unknown[0]}; there are {there}", field="apart")
        return np.isin(ids, named)

    @property
    def formulations(self) -> tuple[str, ...]:
        """The names of those that plans with these options depend on."""
        names = (self.clustering_model, self.cluster_model, self.victim_model)
        return tuple(name for name in names if name is not None)

    def as_dict(self) -> dict[str, Any]:
        """All options by name, the formulations' own parameters among them."""
        options = asdict(self)
        params = options.pop("params")
        return {**options, **dict(params)}


@dataclass(frozen=True)
class RoutingOptions(StagedOptions):
    """The same with limits on whole routes: of the joint problem, which the exact planner solves, too.

    There ``endurance`` is one of them.
    """

    longest_walk: float | None = None
    """Maximum number of cells that a robot may walk."""
    return_to_start: bool = False
    """Whether robots walk back to their starts after their last visits."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.longest_walk is not None:
            self._check("longest_walk", Real, float, 0, sys.float_info.max, "cells, 0 or more")
        if not isinstance(self.return_to_start, (bool, np.bool_)):
            raise InputError(
                f"{self.return_to_start!r}; give true or false", field="return_to_start"
            )

    def as_dict(self) -> dict[str, Any]:
        """All options by name, but for limits that are not set: so they say what they always said."""
        own = ("longest_walk", "return_to_start")
        return {name: x for name, x in super().as_dict().items() if x or name not in own}


def options_type(stage: str) -> type[StagedOptions]:
    """The options of the data of `stage`."""
    return RoutingOptions if stage == "routing" else StagedOptions


PRESETS: dict[str, dict[str, Any]] = {
    "paper": {},
    "authors": {"weights": "authors", "members": "partial", "performance": "robot"},
}
