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

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from types import MappingProxyType

import numpy as np

from ..arrays import own_arrays

Id = int | str
"""What people call a robot, a victim, a kind, a cluster or a place."""
Ids = tuple[Id, ...]


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


def over(*letters: str, infinite: bool = False) -> dict[str, object]:
    """Metadata of a field whose array has the axes `letters`; ``inf`` in it may mean no limit."""
    return {"axes": letters, "infinite": infinite}


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
        if unknown := set(self.ids) - set(length):
            raise ValueError(f"ids of {_listed(unknown)}; there are axes {_listed(length)}")
        ids = {x: tuple(self.ids.get(x, range(n))) for x, n in length.items()}
        for letter, given in ids.items():
            if len(set(given)) != len(given) or len(given) != length[letter]:
                raise ValueError(f"ids of {letter}: {given}; give {length[letter]} different ones")
        object.__setattr__(self, "ids", ids)

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
            if "axes" in item.metadata
        ]

    def along(self, letter: str) -> Ids:
        """The ids along the axis `letter`, its own last place included."""
        axis = self.axes[letter]
        return (*self.ids[axis.of or letter], *([axis.last] if axis.last else []))


def _listed(letters: Iterable[str]) -> str:
    return ", ".join(sorted(letters))
