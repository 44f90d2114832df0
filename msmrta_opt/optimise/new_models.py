"""New formulations to edit: a copy of another, or the smallest of a stage."""

from __future__ import annotations

from keyword import iskeyword
from pathlib import Path

from ..mission.errors import InputError
from ..mission.files import read_text, write_text
from ..mission.suggestions import meant
from .blank import BLANK
from .registry import add_models, find, get


def copy_model(source: str, name: str, to: str | Path | None = None) -> Path:
    """Copy the file of a formulation under a new name, to edit.

    Parameters
    ----------
    source : str
        The formulation to copy.
    name : str
        The new one's.
    to : path, optional
        The folder to put it in, which is made known as by `add_models`; by default the source's own.

    Returns
    -------
    Path
        The new file.

    Raises
    ------
    InputError
        If `name` is not a Python name or is taken, there is no such formulation or folder, or the
        copy would be among the installed formulations.
    """
    _require_new(name, to)
    original = get(source)
    if to is None and "_shipped" in original.path.parts:
        raise InputError(
            "the installed formulations are not to be edited; give a folder to copy to"
        )
    path = (original.path.parent if to is None else Path(to)) / f"{name}.py"
    write_text(path, read_text(original.path))
    return path


def blank_model(stage: str, name: str, to: str | Path = ".") -> Path:
    """Write the smallest formulation of a stage under a new name, to edit; it runs as it is.

    Parameters
    ----------
    stage : str
        One of `blank.BLANK`.
    name : str
        The new one's.
    to : path
        The folder to put it in, which is made known as by `add_models`.

    Returns
    -------
    Path
        The new file.

    Raises
    ------
    InputError
        If there is no small formulation of that stage, or as `copy_model`.
    """
    if stage not in BLANK:
        raise InputError(
            f"no blank formulation of {stage!r}{meant(stage, BLANK)}; there are {', '.join(BLANK)}",
            field="stage",
        )
    _require_new(name, to)
    path = Path(to) / f"{name}.py"
    write_text(path, BLANK[stage])
    return path


def _require_new(name: str, to: str | Path | None) -> None:
    """Refuse a name that is none or is taken, and make the folder known."""
    if not name.isidentifier() or iskeyword(name) or name.startswith("_"):
        raise InputError(f"{name!r}; give a Python name such as cluster_mine", field="name")
    if to is not None:
        add_models(to)
    if taken := find(name):
        raise InputError(f"{name!r} is already the name of {taken}", field="name")
