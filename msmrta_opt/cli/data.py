"""What a formulation is given on an instance, as tables: all fields, and arrays that fit a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .console import say, table

if TYPE_CHECKING:
    from ..optimise.axes import StageData
    from ..optimise.documentation import Documented

WIDEST = 20
"""Columns of an array up to which its numbers are printed."""


def show_data(data: StageData) -> None:
    """Print every field of `data`: name, axes, unit, range and meaning; then the arrays themselves."""
    from ..optimise.documentation import documented

    fields = documented(type(data))
    values = {item.name: getattr(data, item.name) for item in fields}
    table(
        f"{type(data).__name__}: what build(data) is given",
        ["data.", "axes", "unit", "from", "to", "meaning"],
        [
            (
                item.name,
                ", ".join(item.letters),
                item.unit,
                *_range(values[item.name]),
                item.meaning,
            )
            for item in fields
        ],
    )
    for item in fields:
        _show_array(data, item, values[item.name])


def _range(value: Any) -> tuple[str, str]:
    if isinstance(value, np.ndarray) and value.size:
        return _text(value.min()), _text(value.max())
    if isinstance(value, (int, float)):
        return _text(value), _text(value)
    return "", ""


def _show_array(data: StageData, item: Documented, value: Any) -> None:
    if not isinstance(value, np.ndarray) or not 1 <= value.ndim <= 2:
        return
    *rows, columns = item.letters
    if value.shape[-1] > WIDEST:
        say(f"data.{item.name}: {value.shape[-1]} columns, not shown; see it in Python\n")
        return
    nouns = " × ".join(data.axes[letter].noun for letter in item.letters)
    unit = f" ({item.unit})" if item.unit else ""
    names = data.along(rows[0]) if rows else ("",)
    table(
        f"data.{item.name}, {nouns}{unit}",
        [
            data.axes[rows[0]].noun if rows else data.axes[columns].noun,
            *map(str, data.along(columns)),
        ],
        [
            (str(name), *map(_text, line))
            for name, line in zip(names, np.atleast_2d(value), strict=True)
        ],
    )


def _text(number: Any) -> str:
    if isinstance(number, (bool, np.bool_)):
        return str(int(number))
    return f"{number:.6g}"
