"""One clear line out of pydantic's validation errors."""

from __future__ import annotations

import json
from typing import Any

from pydantic import ValidationError

from .errors import InputError

_WHOLE = "give a whole number"
_NUMBER = "give a finite number"
_PAIR = "give two numbers, [row, col]"  # the only lists of fixed length in our documents

_RIGHT = {
    "dict_type": 'give an object, {{"name": value, …}}',
    "extra_forbidden": "there is no such field; correct its name or remove it",
    "finite_number": _NUMBER,
    "float_parsing": _NUMBER,
    "float_type": _NUMBER,
    "greater_than": "give a number above {gt:g}",
    "greater_than_equal": "give {ge:g} or more",
    "int_from_float": _WHOLE,
    "int_parsing": _WHOLE,
    "int_type": _WHOLE,
    "literal_error": "give {expected}",
    "missing": _PAIR,
    "model_type": 'give an object, {{"name": value, …}}',
    "string_type": "give a text in quotes",
    "too_long": _PAIR,
    "too_short": "give a list of {min_length} or more",
    "tuple_type": "give a list, […]",
}
"""What would be right, by pydantic's type of error; filled in from the error's context."""


def at(*parts: str | int) -> str:
    """A path into a document: ``at("robots", 2, "speed")`` is ``robots[2].speed``."""
    path = ""
    for part in parts:
        if isinstance(part, int):
            path += f"[{part}]"
        else:
            # Names come from the document, and must not break the line they are printed on.
            name = part if part.isprintable() else repr(part)
            path += f".{name}" if path else name
    return path


def first_problem(error: ValidationError) -> InputError:
    """The first of pydantic's findings, as our own error: field, value, what would be right."""
    found = error.errors(include_url=False)[0]
    kind, loc, context = found["type"], found["loc"], found.get("ctx", {})
    field = at(*loc)
    cause = context.get("error")
    if kind == "json_invalid":
        return InputError(f"broken JSON: {cause}")
    if isinstance(cause, InputError):
        return _said_of(field, cause)
    if kind == "value_error":
        return InputError(str(cause), field=field)
    if kind == "missing":
        if isinstance(loc[-1], str):
            return InputError("is missing; give it, for it has no default", field=field)
        field = at(*loc[:-1])
    plain = found["msg"][:1].lower() + found["msg"][1:]
    right = _RIGHT[kind].format(**context) if kind in _RIGHT else plain
    return InputError(f"{_shown(found['input'])}; {right}", field=field)


def _said_of(field: str, cause: InputError) -> InputError:
    """`cause`, met while reading `field`."""
    if cause.file:
        # Another file is at fault: lead to it through the field that names it.
        return InputError(str(cause), field=field)
    dot = "." if field and cause.field and not cause.field.startswith("[") else ""
    return InputError(cause.problem, field=field + dot + cause.field)


def _shown(value: Any, limit: int = 60) -> str:
    """`value` as its document has it, on one line of at most `limit` characters."""
    try:
        text = repr(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = repr(value)
    text = text if text.isprintable() else repr(text)[1:-1]
    return text if len(text) <= limit else text[: limit - 1] + "…"
