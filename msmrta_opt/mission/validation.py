"""One clear line out of pydantic's validation errors."""

from __future__ import annotations

from pydantic import ValidationError

from .errors import InputError

_PLAIN = {
    "missing": "is missing",
    "extra_forbidden": "unknown field",
    "json_invalid": "broken JSON",
}


def at(*parts: str | int) -> str:
    """A path into a document: ``at("robots", 2, "speed")`` is ``robots[2].speed``."""
    path = ""
    for part in parts:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    return path


def first_problem(error: ValidationError) -> InputError:
    """The first of pydantic's findings, as our own error: field, value, what would be right."""
    found = error.errors(include_url=False)[0]
    field = at(*(part for part in found["loc"] if isinstance(part, (str, int))))
    cause = found.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        joined = field + "." + cause.field if field and cause.field else field or cause.field
        return InputError(cause.problem, field=joined, file=cause.file)
    message = _PLAIN.get(found["type"], found["msg"][:1].lower() + found["msg"][1:])
    if found["type"] == "json_invalid":
        return InputError(f"broken JSON: {found['ctx']['error']}")
    if found["type"] == "value_error":
        return InputError(str(cause), field=field)
    if found["type"] in _PLAIN:
        return InputError(message, field=field)
    value = repr(found["input"])
    value = value if len(value) <= 60 else value[:59] + "…"
    return InputError(f"{value}: {message}", field=field)
