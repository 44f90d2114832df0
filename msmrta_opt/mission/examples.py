"""The missions that come with the package, read by name."""

from __future__ import annotations

from .instance import Instance
from .shipped import shipped_instances
from .suggestions import none_of


def examples() -> list[str]:
    """The names that `example` takes."""
    return list(shipped_instances())


def example(name: str = "paper") -> Instance:
    """A mission that comes with the package.

    Parameters
    ----------
    name : str
        One of `examples`, for instance ``paper`` or ``suite/rooms``.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    shipped = shipped_instances()
    if name not in shipped:
        raise none_of(name, shipped, "example")
    return Instance.read(shipped[name])
