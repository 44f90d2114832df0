"""What the data of a stage hold, for people: each field with its axes, its unit and its meaning."""

from __future__ import annotations

import ast
import inspect
from dataclasses import dataclass, fields
from textwrap import dedent

from .axes import Derived, StageData


@dataclass(frozen=True)
class Documented:
    """A field of a stage's data.

    Parameters
    ----------
    name : str
        As in ``data.name``.
    letters : tuple of str
        Its axes; empty for a single value.
    unit, meaning : str
        What its numbers count, and what it says, in a sentence.
    """

    name: str
    letters: tuple[str, ...]
    unit: str
    meaning: str


def documented(data: type[StageData]) -> tuple[Documented, ...]:
    """The fields of `data`: what stages give first, then what follows from it when it is asked for."""
    found = []
    said = _meanings(data)
    for item in fields(data):
        if "axes" in item.metadata:
            axes, unit = item.metadata["axes"], item.metadata["unit"]
            found.append(Documented(item.name, axes, unit, said[item.name]))
    given = {item.name for item in fields(data)}
    for kind in data.__mro__:
        for name, value in vars(kind).items():
            if isinstance(value, Derived) and not name.startswith("_") and name not in given:
                meaning = (value.__doc__ or "").strip().partition("\n")[0]
                found.append(Documented(name, value.letters, value.unit, meaning))
    return tuple(found)


def _meanings(data: type[StageData]) -> dict[str, str]:
    """By field the text below it, of the class and of those that it is made of."""
    found: dict[str, str] = {}
    for kind in reversed(data.__mro__):
        if not issubclass(kind, StageData):
            continue
        (body,) = ast.parse(dedent(inspect.getsource(kind))).body
        assert isinstance(body, ast.ClassDef)
        for field, text in zip(body.body, body.body[1:], strict=False):
            if (
                isinstance(field, ast.AnnAssign)
                and isinstance(field.target, ast.Name)
                and isinstance(text, ast.Expr)
                and isinstance(text.value, ast.Constant)
            ):
                found[field.target.id] = " ".join(str(text.value.value).split())
    return found
