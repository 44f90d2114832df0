"""The matrix of a formulation on data, and what it proves, without solving it."""

from __future__ import annotations

from typing import Any

from .program import Program
from .registry import Formulation
from .solve import compile_for
from .structure import Structure, recognise


def program(formulation: str | Formulation, data: Any, **parameters: float) -> Program:
    """The linear integer program that `formulation` is on `data`.

    Parameters
    ----------
    formulation : str or Formulation
        Its name in the registry, or itself.
    data
        What its stage takes, for instance `ClusterData`.
    **parameters : float
        The formulation's parameters, for instance ``psi``; the others keep their defaults.

    Returns
    -------
    Program
        Its ``matrix`` has shape ``(n_rows, n_columns)``.

    Raises
    ------
    InputError
        If a name or a parameter is wrong.
    ModelError
        If the formulation cannot be built as a linear integer program.
    """
    return compile_for(formulation, data).program(**parameters)


def structure(formulation: str | Formulation, data: Any, **parameters: float) -> Structure | None:
    """What the matrix of `formulation` on `data` proves, or ``None`` if nothing is recognised.

    Takes and raises what `program` does. What is proven is that every vertex of the linear
    relaxation is integral, so that an assignment algorithm or the relaxation solves the program.
    """
    return recognise(program(formulation, data, **parameters))
