"""Programs as files for any other solver, and back: MPS and LP.

Names are the modeller's, as far as both formats allow: ``x[0,2]`` is written ``x(0,2)``, and the row
``cluster 2 has at most one robot`` as ``cluster_2_has_at_most_one_robot``. Numbers are written with all
their digits, and read and written alike under any locale. What a file does not hold: rows without
sides, and the factors of rows that had to be scaled (see `formats.written`).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..mission.errors import InputError
from ..mission.files import read_text, write_text
from .compile import compile_for
from .formats.lp import as_lp
from .formats.mps import as_mps
from .formats.read_lp import read_lp
from .formats.read_mps import read_mps
from .formats.written import as_modelled, written
from .program import Program
from .registry import Formulation

FORMATS = {".mps": (as_mps, read_mps), ".lp": (as_lp, read_lp)}
"""By suffix, what writes and what reads a file."""


def export(
    formulation: str | Formulation, data: Any, path: str | Path, **parameters: float
) -> None:
    """Write `formulation` on `data` as a file, without solving it.

    Parameters
    ----------
    formulation : str or Formulation
        Its name in the registry, or itself.
    data
        What its stage takes, for instance `ClusterData`.
    path : path
        Where to: ``.mps`` (free format) or ``.lp``.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Raises
    ------
    InputError
        If the suffix is unknown, the file cannot be written, or a name or a parameter is wrong.
    ModelError
        If the formulation cannot be built as a linear integer program, or `write_program` refuses it.
    """
    require_format(path)
    compiled = compile_for(formulation, data)
    program = as_modelled(compiled.program(**parameters))
    write_program(program, path, name=compiled.formulation.name)


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


def require_format(path: str | Path) -> str:
    """The suffix of `path`, one of `FORMATS`.

    Raises
    ------
    InputError
        If it is another.
    """
    suffix = Path(path).suffix
    if suffix not in FORMATS:
        raise InputError(
            f"unknown format {suffix!r}; the suffix is one of {', '.join(FORMATS)}", file=path
        )
    return suffix
