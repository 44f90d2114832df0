"""Documents read into pydantic's models, with one clear line for what is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from .errors import InputError, at, shown
from .files import parse_json, read_text

Model = TypeVar("Model", bound=BaseModel)

_WHOLE = "give a whole number"
_NUMBER = "give a finite number"
_PAIR = "give two numbers, [row, col]"  # the only lists of fixed length in our documents

_RIGHT = {
    "bool_parsing": "give true or false",
    "bool_type": "give true or false",
    "dataclass_type": 'give an object, {{"name": value, …}}',
    "dict_type": 'give an object, {{"name": value, …}}',
    "enum": "give {expected}",
    "extra_forbidden": "there is no such field; correct its name or remove it",
    "finite_number": _NUMBER,
    "float_parsing": _NUMBER,
    "float_type": _NUMBER,
    "greater_than": "give a number above {gt:g}",
    "greater_than_equal": "give {ge:g} or more",
    "int_from_float": _WHOLE,
    "int_parsing": _WHOLE,
    "int_type": _WHOLE,
    "less_than": "give a number below {lt:g}",
    "less_than_equal": "give {le:g} or less",
    "literal_error": "give {expected}",
    "missing": _PAIR,
    "model_type": 'give an object, {{"name": value, …}}',
    "string_type": "give a text in quotes",
    "too_long": _PAIR,
    "too_short": "give a list of {min_length} or more",
    "tuple_type": "give a list, […]",
    "unexpected_keyword_argument": "there is no such field; correct its name or remove it",
}
"""What would be right, by pydantic's type of error; filled in from the error's context."""


def read_model(
    model: type[Model],
    path: str | Path,
    context: Any = None,
    prepare: Callable[[Any, Any], Any] | None = None,
) -> Model:
    """The `model` in a JSON file.

    Parameters
    ----------
    model : type
        What to read.
    path : str or path
        The file.
    context : optional
        Handed to the validators.
    prepare : callable, optional
        Given the document and the context, returns the document to validate in its place.

    Raises
    ------
    InputError
        Naming the file, the field, the offending value and what would be right.
    """
    try:
        text = read_text(path)
        document = parse_json(text)
        if prepare is not None and (prepared := prepare(document, context)) is not document:
            text = json.dumps(prepared)
        return model.model_validate_json(text, strict=True, context=context)
    except ValidationError as error:
        raise first_problem(error).within(path) from None
    except InputError as error:
        raise error.within(path) from None


def first_problem(error: ValidationError) -> InputError:
    """The first of pydantic's findings, as our own error: field, value, what would be right."""
    found = error.errors(include_url=False)[0]
    kind, loc, context = found["type"], found["loc"], found.get("ctx", {})
    field = at(*loc)
    cause = context.get("error")
    if isinstance(cause, InputError):
        return said_of(field, cause)
    if kind == "value_error":
        return InputError(str(cause), field=field)
    if kind == "missing":
        if isinstance(loc[-1], str):
            return InputError("is missing; give it, for it has no default", field=field)
        field = at(*loc[:-1])
    plain = found["msg"][:1].lower() + found["msg"][1:]
    right = _RIGHT[kind].format(**context) if kind in _RIGHT else plain
    return InputError(f"{shown(found['input'])}; {right}", field=field)


def said_of(field: str, cause: InputError) -> InputError:
    """`cause`, met while reading `field`."""
    if cause.file:
        # Another file is at fault: lead to it through the field that names it.
        return InputError(str(cause), field=field)
    dot = "." if field and cause.field and not cause.field.startswith("[") else ""
    return InputError(cause.problem, field=field + dot + cause.field)
