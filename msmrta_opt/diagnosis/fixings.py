"""Values that someone asks for: ``x[2,1]=1`` in ids, as many as one likes, or a file of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from ..mission.counting import in_full
from ..mission.errors import InputError
from ..mission.files import read_json, read_text
from ..optimise.program import Block, Program

Fixings = dict[int, float]
"""By column, the value that is asked for."""
Asked = str | Path | Mapping[str, float] | Iterable[str]
"""``x[2,1]=1``, several separated by ``;`` or as a list, a mapping from names, or a file: JSON with such
a mapping, or text with one to a line and comments behind ``#``."""


def fixings(program: Program, asked: Asked) -> Fixings:
    """The values of `asked`, by column of `program`.

    Raises
    ------
    InputError
        If there is no such variable, a value is no number, or one variable is asked for two values.
    """
    column = {_plain(program.column_name(j)): j for j in range(program.n_columns)}
    found: Fixings = {}
    for name, value in _pairs(asked):
        place = column.get(_plain(name))
        if place is None:
            raise InputError(f"no variable {name!r}; {_near(name, list(column))}", field="why_not")
        if found.setdefault(place, value) != value:
            raise InputError(
                f"{name} is asked to be {in_full(found[place])} and {in_full(value)}; give one",
                field="why_not",
            )
    if not found:
        raise InputError("nothing is asked for; give for instance x[2,1]=1", field="why_not")
    return found


def fixing_name(program: Program, column: int, value: float) -> str:
    """For instance ``x[2,1] = 1 (asked)``."""
    return f"{program.column_name(column)} = {in_full(value)} (asked)"


def with_rows(program: Program, given: Fixings) -> Program:
    """`program` with a row for each of the values, so that a conflict can name it."""
    from scipy.sparse import csr_array, vstack

    columns, values = np.array(list(given)), np.array(list(given.values()))
    picked = csr_array(
        (np.ones(len(given)), (np.arange(len(given)), columns)), (len(given), program.n_columns)
    )
    names = (fixing_name(program, j, value) for j, value in given.items())
    rows = tuple(Block(name, program.n_rows + i, ()) for i, name in enumerate(names))
    return replace(
        program,
        matrix=csr_array(vstack([program.matrix, picked])),
        row_lower=np.append(program.row_lower, values),
        row_upper=np.append(program.row_upper, values),
        rows=(*program.rows, *rows),
    )


def with_bounds(program: Program, given: Fixings) -> Program:
    """`program` with each of the values as both bounds."""
    lower, upper = program.lower.copy(), program.upper.copy()
    columns = list(given)
    lower[columns] = upper[columns] = list(given.values())
    return replace(program, lower=lower, upper=upper)


def _pairs(asked: Asked) -> list[tuple[str, float]]:
    if isinstance(asked, Mapping):
        return [(str(name), _number(str(name), value)) for name, value in asked.items()]
    if isinstance(asked, str) and not asked.strip():
        raise InputError("''; give NAME=VALUE, or a file of them", field="why_not")
    if isinstance(asked, Path) or (isinstance(asked, str) and "=" not in asked):
        try:
            return _of_file(Path(asked))
        except InputError as error:
            raise error.within(asked) from None
    texts = asked.split(";") if isinstance(asked, str) else asked
    return [_pair(text) for text in texts if text.strip()]


def _of_file(path: Path) -> list[tuple[str, float]]:
    if path.suffix == ".json":
        document = read_json(path)
        if not isinstance(document, dict):
            raise InputError("not a JSON object; give variables with their values")
        return _pairs(document)
    lines = (line.partition("#")[0] for line in read_text(path).splitlines())
    return _pairs([line for line in lines if line.strip()])


def _pair(text: str) -> tuple[str, float]:
    name, equals, value = text.strip().rpartition("=")
    if not equals or not name.strip():
        raise InputError(f"{text.strip()!r}; give for instance x[2,1]=1", field="why_not")
    return name.strip(), _number(name.strip(), value)


def _number(name: str, value: object) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = np.nan
    if isinstance(value, bool) or not np.isfinite(number):
        raise InputError(f"{value!r} for {name}; give a number", field="why_not")
    return number


def _plain(name: str) -> str:
    return re.sub(r"\s+", "", name)


def _near(name: str, known: list[str]) -> str:
    near = get_close_matches(_plain(name), known, n=1)
    if near:
        return f"did you mean {near[0]}?"
    return f"there are {', '.join(known[:3])}{', …' if len(known) > 3 else ''}"
