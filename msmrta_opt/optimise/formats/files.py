"""Programs in files, by their suffix: MPS and LP."""

from __future__ import annotations

from pathlib import Path

from ...mission.errors import InputError
from ...mission.files import read_text, write_text
from ..program import Program
from .lp import as_lp
from .mps import as_mps
from .read_lp import read_lp
from .read_mps import read_mps
from .written import written

FORMATS = {".mps": (as_mps, read_mps), ".lp": (as_lp, read_lp)}
"""By suffix, what writes and what reads a file."""


def write_program(program: Program, path: str | Path, *, name: str = "") -> None:
    """Write `program` as ``.mps`` (free format) or ``.lp``, whole or not at all.

    HiGHS, SCIP, GLPK and CBC read the same program in it. `read_program` reads what was written to the
    last digit, but for the factors of scaled rows.

    Parameters
    ----------
    program : Program
        The arrays.
    path : path
        Where to.
    name : str
        The program's name in the file; by default the file's stem.

    Raises
    ------
    InputError
        If the suffix is unknown or the file cannot be written.
    ModelError
        If a number is beyond what solvers take, naming its row and variable.
    """
    as_text, _ = FORMATS[require_format(path)]
    write_text(path, as_text(written(program, name or Path(path).stem)))


def read_program(path: str | Path) -> Program:
    """The program in an ``.mps`` or ``.lp`` file.

    Each variable and each row is a `Block` of its own, of shape ``()``, under its name in the file.

    Raises
    ------
    InputError
        If there is no such file, its suffix is unknown, or it is anything but a linear (integer)
        program that all readers of its format understand alike; naming the line.
    """
    _, read = FORMATS[require_format(path)]
    try:
        return read(read_text(path))
    except InputError as error:
        raise error.within(path) from None


def is_program(path: str | Path) -> bool:
    """Whether `path` has the suffix of a program's file, in letters of any case."""
    return Path(path).suffix.lower() in FORMATS


def require_format(path: str | Path) -> str:
    """The suffix of `path` in small letters, one of `FORMATS`.

    Raises
    ------
    InputError
        If it is another.
    """
    if not is_program(path):
        raise InputError(
            f"unknown format {Path(path).suffix!r}; the suffix is one of {', '.join(FORMATS)}",
            file=path,
        )
    return Path(path).suffix.lower()
