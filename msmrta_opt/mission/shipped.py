"""The missions and maps that come with the package, by name: the checkout's, or a wheel's copies."""

from __future__ import annotations

import contextlib
from pathlib import Path

from .errors import InputError
from .suggestions import meant

_PACKAGE = Path(__file__).resolve().parents[1]
_CHECKOUT = _PACKAGE.parent
SUFFIX = ".json"
"""Of instances, plans and runs."""


def shipped_folder() -> Path:
    """The folder ``instances``."""
    home = _CHECKOUT if (_CHECKOUT / "pyproject.toml").is_file() else _PACKAGE / "_shipped"
    return home / "instances"


def shipped_instances() -> dict[str, Path]:
    """The instance files by name, such as ``paper`` or ``suite/rooms``, small sets first."""
    folder = shipped_folder()
    found = [*sorted(folder.glob("*.json")), *sorted(folder.glob("suite/*.json"))]
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in found}


def find_instance(name_or_file: str | Path) -> Path:
    """The file to read: one of that name if there is, else the shipped instance of that name.

    Raises
    ------
    InputError
        If there is neither.
    """
    path = Path(name_or_file)
    try:
        is_there = str(path) == "-" or (path.exists() and not path.is_dir())
    except (OSError, ValueError):  # no file can have this name: it is said when it is read
        return path
    if is_there:
        return path
    shipped = shipped_instances()
    if path.as_posix() in shipped:
        return shipped[path.as_posix()]
    if path.is_dir():
        return path
    if path.suffix:
        raise InputError(f"no such file{_beside(path)}", file=path)
    raise InputError(
        f"no such file, nor a shipped instance{meant(path.as_posix(), shipped)}", file=path
    )


def _beside(path: Path) -> str:
    """The file in the same folder that was meant."""
    with contextlib.suppress(OSError):
        # Alike suffixes make no names alike; what cannot be read is not what was meant.
        beside = (file for file in sorted(path.parent.iterdir()) if file.suffix == SUFFIX)
        names = {file.stem: file.name for file in beside}
        return meant(path.stem, names, names)
    return ""
