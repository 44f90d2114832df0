"""Axes: what the dimensions of a stage's arrays run over, and the ids of what stands there.

A stage's data is a frozen dataclass that declares its axes, in the order in which all of its arrays and
the variables of its formulations have them::

    @dataclass(frozen=True, eq=False)
    class ClusterData(StageData):
        stage = "cluster"
        axes = MappingProxyType({"r": Axis("robot"), "c": Axis("cluster")})
        solution = MappingProxyType({"x": ("r", "c")})

        w: Floats = field(metadata=over("r", "c"))

From that follow the check of its shapes, and the names of all that a formulation has on it
(`compile.labels`). Ids are given where a stage builds the data; data made by hand has positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from ..arrays import own_arrays

Id = int | str
"""What people call a robot, a victim, a kind, a cluster or a place."""
Ids = tuple[Id, ...]
T = TypeVar("T")


@dataclass(frozen=True)
class Axis:
    """A dimension by what it runs over.

    Parameters
    ----------
    noun : str
        What stands at each of its places, for instance ``robot``.
    of : str, optional
        The axis whose things these are, too: places and victims, posts and clusters.
    last : str, optional
        Name of one more place after those of `of`, for instance ``start``.
    """

    noun: str
    of: str = ""
    last: str = ""


def over(*letters: str, unit: str = "", infinite: bool = False) -> dict[str, object]:
    """Metadata of a field: the axes of its array, its unit, and whether ``inf`` may mean no limit."""
    return {"axes": letters, "unit": unit, "infinite": infinite}


class Derived(cached_property[T]):
    """A property of the data, worked out when first asked for: its axes and its unit; see `derived`."""

    def __init__(self, func: Callable[[Any], T], letters: tuple[str, ...], unit: str) -> None:
        super().__init__(func)
        self.letters, self.unit = letters, unit


def derived(*letters: str, unit: str = "") -> Callable[[Callable[[Any], T]], Derived[T]]:
    """What follows from a stage's data, over the axes `letters`, and costs nothing until it is used."""
    return lambda func: Derived(func, letters, unit)


@dataclass(frozen=True, eq=False)
class StageData:
    """What a stage hands to its formulations, in arrays: the base of every stage's data class.

    Raises
    ------
    ValueError
        If an array has another shape than its axes, a value is not finite where it should be, or the
        ids of an axis are not as many different ones as it is long.
    """

    stage = ""
    """The stage's name, as in `Spec.stage`."""
    axes = MappingProxyType[str, Axis]({})
    """The axes by letter, in the order in which arrays and variables have them."""
    solution = MappingProxyType[str, tuple[str, ...]]({})
    """The variables that the stage reads, each entry 0 or 1, with their axes."""
    may_be_one = MappingProxyType[str, str]({})
    """By such a variable the field, over the same axes, without which an entry must be 0."""

    ids: Mapping[str, Sequence[Id]] = field(default_factory=dict, kw_only=True, repr=False)
    """By the letter of an axis, the ids along it; positions where none are given."""

    def __post_init__(self) -> None:
        own_arrays(self)
        length = self._lengths()
        for name, letters, infinite in self._arrays():
            array = getattr(self, name)
            right = tuple(length[base] + more for base, more in map(self._base, letters))
            if array.shape != right:
                raise ValueError(f"{name} has shape {array.shape}; give {right}")
            if array.dtype.kind == "f" and not infinite and not np.isfinite(array).all():
                raise ValueError(f"{name} holds values that are not finite")
        more = self._more_ids()
        given_ids = {**more, **self.ids}
        length |= {x: len(ids) for x, ids in more.items() if x not in length}
        if unknown := set(self.ids) - set(length):
            raise ValueError(f"ids of {_listed(unknown)}; there are axes {_listed(length)}")
        ids = {x: tuple(given_ids.get(x, range(n))) for x, n in length.items()}
        for letter, given in ids.items():
            if len(set(given)) != len(given) or len(given) != length[letter]:
                raise ValueError(f"ids of {letter}: {given}; give {length[letter]} different ones")
        object.__setattr__(self, "ids", ids)

    def _more_ids(self) -> dict[str, Ids]:
        """The ids along axes that no array need have."""
        return {}

    def _lengths(self) -> dict[str, int]:
        """How long the axes are, by the majority of the arrays that have them."""
        found: dict[str, list[int]] = {}
        for name, letters, _ in self._arrays():
            shape = getattr(self, name).shape
            if len(shape) != len(letters):
                raise ValueError(f"{name} has shape {shape}; give axes {', '.join(letters)}")
            for (base, more), n in zip(map(self._base, letters), shape, strict=True):
                found.setdefault(base, []).append(n - more)
        return {base: max(lengths, key=lengths.count) for base, lengths in found.items()}

    @classmethod
    def _base(cls, letter: str) -> tuple[str, int]:
        """The axis whose things are on the axis `letter`, and how many places this has more."""
        axis = cls.axes[letter]
        return axis.of or letter, int(bool(axis.last))

    @classmethod
    @cache
    def _arrays(cls) -> list[tuple[str, tuple[str, ...], bool]]:
        """The arrays: field, axes, and whether values may be infinite."""
        return [
            (item.name, item.metadata["axes"], item.metadata["infinite"])
            for item in fields(cls)
            if item.metadata.get("axes")
        ]

    @property
    def letters(self) -> tuple[str, ...]:
        """The axes whose length this data knows, in their order."""
        return tuple(x for x, axis in self.axes.items() if (axis.of or x) in self.ids)

    def along(self, letter: str) -> Ids:
        """The ids along the axis `letter`, its own last place included."""
        axis = self.axes[letter]
        return (*self.ids[axis.of or letter], *([axis.last] if axis.last else []))


def _listed(letters: Iterable[str]) -> str:
    return ", ".join(sorted(letters))
