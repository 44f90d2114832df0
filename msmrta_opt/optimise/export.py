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
from .formats.files import is_program as is_program
from .formats.files import read_program as read_program
from .formats.files import require_format as require_format
from .formats.files import write_program as write_program
from .formats.written import as_modelled
from .subject import subject


def export(
    what: Any, data: Any = None, path: str | Path | None = None, **parameters: float
) -> None:
    """Write a program as a file, without solving it.

    Parameters
    ----------
    what : str, Formulation, cvxpy.Problem or Program
        A formulation, which takes `data`; any linear (integer) problem of cvxpy; or arrays.
    data
        What the formulation's stage takes, for instance `ClusterData`. Of what takes no data,
        ``export(problem, path)`` will do.
    path : path
        Where to: ``.mps`` (free format) or ``.lp``.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Raises
    ------
    InputError
        If the suffix is unknown, the file cannot be written, or a name or a parameter is wrong.
    ModelError
        If it cannot be built as a linear integer program, or `write_program` refuses it.
    """
    if path is None and isinstance(data, (str, Path)):
        data, path = None, data
    if path is None:
        raise InputError("no file; give one with the suffix .mps or .lp", field="path")
    require_format(path)
    asked = subject(what, data, **parameters)
    name = asked.name if asked.compiled is not None else ""
    write_program(as_modelled(asked.program), path, name=name)
