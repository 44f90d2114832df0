"""Documents read into pydantic's models, with one clear line for each thing that is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from .errors import InputError, all_of, at, each_of, shown
from .files import NotFiniteError, parse_json, read_text, read_toml
from .suggestions import meant

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
    *,
    toml: bool = False,
) -> Model:
    """The `model` in a JSON file, or in a TOML file.

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
    toml : bool
        Whether the file is a TOML file.

    Raises
    ------
    InputError
        Naming the file, the field, the offending value and what would be right; `MistakesError` of
        several mistakes.
    """
    try:
        if toml:  # dates, which JSON has not, are texts to all that follows
            document = read_toml(path)
            if prepare is not None:
                document = prepare(document, context)
            return model.model_validate_json(json.dumps(document, default=str), strict=True)
        text = read_text(path)
        document = parse_json(text)
        if prepare is not None and (prepared := prepare(document, context)) is not document:
            text = json.dumps(prepared)
        return model.model_validate_json(text, strict=True, context=context)
    except ValidationError as error:
        raise problems_of(error, model, toml=toml).within(path) from None
    except NotFiniteError as error:
        raise _with_others(error, model, context, prepare).within(path) from None
    except InputError as error:
        raise error.within(path) from None


def _with_others(
    found: NotFiniteError,
    model: type[BaseModel],
    context: Any,
    prepare: Callable[[Any, Any], Any] | None,
) -> InputError:
    """The numbers that are not finite, and what else is wrong, of each field once."""
    own = {error.field: error for error in found.each}
    try:
        document = prepare(found.document, context) if prepare else found.document
        text = json.dumps(document, default=str)
        model.model_validate_json(text, strict=True, context=context)
        others: list[InputError] = []
    except ValidationError as error:
        others = list(each_of(problems_of(error, model)))
    except (ValueError, OverflowError):  # of a file that it names, for instance
        others = []
    return all_of([*(own.pop(other.field, other) for other in others), *own.values()])


def first_problem(
    error: ValidationError, model: type[BaseModel] | None = None, *, toml: bool = False
) -> InputError:
    """The first of pydantic's findings, as our own error: field, value, what would be right."""
    return _problem(error.errors(include_url=False)[0], model, toml)


def problems_of(
    error: ValidationError, model: type[BaseModel] | None = None, *, toml: bool = False
) -> InputError:
    """All of pydantic's findings, as one error of our own.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.
    model : type, optional
        What was to be read; with it a misspelt field is told what was meant.
    toml : bool
        Whether it was read from TOML; then a table in the place of several is told how they are written.
    """
    every = error.errors(include_url=False)
    if other := [x for x in every if x["loc"] == ("format",) and x["type"] != "missing"]:
        every = other  # of a file of another kind nothing else says anything
    found: list[InputError] = []
    for item in every:
        if item["type"] == "too_short" and any(_is_inside(x["loc"], item["loc"]) for x in every):
            continue  # only since an item is wrong
        problem = _problem(item, model, toml)
        found += each_of(problem)
    return all_of(found)


def _is_inside(inner: tuple[str | int, ...], outer: tuple[str | int, ...]) -> bool:
    return len(inner) > len(outer) and inner[: len(outer)] == outer


def _problem(
    found: Mapping[str, Any], model: type[BaseModel] | None, toml: bool = False
) -> InputError:
    kind, loc, context = found["type"], found["loc"], found.get("ctx", {})
    field = at(*loc)
    cause = context.get("error")
    if isinstance(cause, InputError):
        return all_of([said_of(field, each) for each in each_of(cause)])
    if kind == "value_error":
        return InputError(str(cause), field=field)
    if kind == "missing":
        if isinstance(loc[-1], str):
            return InputError("is missing; give it, for it has no default", field=field)
        field = at(*loc[:-1])
    plain = found["msg"][:1].lower() + found["msg"][1:]
    right = _RIGHT[kind].format(**context) if kind in _RIGHT else plain
    if toml and kind in ("list_type", "tuple_type") and isinstance(found["input"], Mapping):
        right = f"write [[{loc[-1]}]], for there may be several"
    if kind == "extra_forbidden" and model is not None:
        right += meant(loc[-1], _fields_at(model, loc[:-1]))
    return InputError(f"{shown(found['input'])}; {right}", field=field)


def _fields_at(model: Any, loc: Sequence[str | int]) -> Iterable[str]:
    """The names of the fields of the record at a place in a document."""
    for name in loc:
        if isinstance(name, int):
            continue  # a list's items have the type that was found within it
        inside = getattr(model, "model_fields", {}).get(name)
        model = _record_in(inside.annotation) if inside is not None else None
    return getattr(model, "model_fields", {})


def _record_in(annotation: Any) -> Any:
    """The record that an annotation is, or is a list of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    found = (_record_in(part) for part in get_args(annotation))
    return next((record for record in found if record is not None), None)


def said_of(field: str, cause: InputError) -> InputError:
    """`cause`, met while reading `field`."""
    if cause.file:
        # Another file is at fault: lead to it through the field that names it.
        return InputError(str(cause), field=field)
    dot = "." if field and cause.field and not cause.field.startswith("[") else ""
    return InputError(cause.problem, field=field + dot + cause.field)
