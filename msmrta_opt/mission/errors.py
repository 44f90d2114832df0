"""The package's few error types.

Whoever catches `MsmrtaError` catches everything this package raises on purpose; each message is one
line that names the file, the field and the offending value, and says what would be right.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from typing import Any

MAX_MISTAKES = 10
"""Of one file that are told at once."""


class MsmrtaError(Exception):
    """Base of all errors that this package raises on purpose.

    What a file or a name brings into the message that no screen shows is written as its escape.
    """

    def __init__(self, message: str = "") -> None:
        shows = (x if x.isprintable() or x == "\n" else repr(x)[1:-1] for x in message)
        super().__init__("".join(shows))


class InputError(MsmrtaError, ValueError):
    """Something the user supplied is wrong: a file, a field, an option.

    Parameters
    ----------
    problem : str
        What is wrong and what would be right, on one line.
    field : str, optional
        The field, as a path into the document, for instance ``robots[2].speed``.
    file : path, optional
        The file at fault.
    """

    def __init__(
        self, problem: str, *, field: str = "", file: str | PathLike[str] | None = None
    ) -> None:
        self.problem = problem
        self.field = field
        self.file = None if file is None else str(file)
        super().__init__(": ".join(part for part in (self.file or "", field, problem) if part))

    def within(self, file: str | PathLike[str]) -> InputError:
        """The same error, said of `file` (unless it names one already)."""
        return self if self.file else InputError(self.problem, field=self.field, file=file)


class NoPlanError(InputError):
    """There is no plan that keeps to the robots' limits, or none was found in time.

    Parameters
    ----------
    problem, field
        As for `InputError`.
    proven : bool
        Whether it is known that there is none.
    """

    def __init__(self, problem: str, *, field: str = "", proven: bool = False) -> None:
        super().__init__(problem, field=field)
        self.proven = proven


class MistakesError(InputError):
    """Several mistakes in one file; as text the first, and how many more there are.

    Parameters
    ----------
    each : sequence of InputError
        Two or more.
    """

    def __init__(self, each: Sequence[InputError]) -> None:
        self.each = tuple(each)
        first, n_more = self.each[0], len(self.each) - 1
        more = f" (and {n_more} more {'mistake' if n_more == 1 else 'mistakes'})"
        super().__init__(first.problem + more, field=first.field, file=first.file)

    def __reduce__(self) -> tuple[type[MistakesError], tuple[Sequence[InputError]]]:
        return MistakesError, (self.each,)

    def within(self, file: str | PathLike[str]) -> MistakesError:
        """The same errors, each said of `file` (unless it names one already)."""
        return MistakesError([error.within(file) for error in self.each])


def all_of(errors: Sequence[InputError]) -> InputError:
    """The first of `errors`, up to `MAX_MISTAKES`, as one."""
    return errors[0] if len(errors) == 1 else MistakesError(errors[:MAX_MISTAKES])


def each_of(error: InputError) -> tuple[InputError, ...]:
    """The mistakes that `error` tells, one or more."""
    return error.each if isinstance(error, MistakesError) else (error,)


class ModelError(MsmrtaError):
    """A formulation cannot be loaded, built or written as a linear integer program."""


class SolverError(MsmrtaError):
    """A solver is missing, was asked for something it cannot do, or failed."""


class UnsupportedError(SolverError):
    """A solver was asked for an option, or given a program, that it cannot do."""


class CheckError(MsmrtaError):
    """A solution or a plan failed its independent check, so it is not shown as a result."""


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


def shown(value: Any, limit: int = 60) -> str:
    """`value` as its document has it, on one line of at most `limit` characters."""
    try:
        text = repr(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = repr(value)
    text = text if text.isprintable() else repr(text)[1:-1]
    return text if len(text) <= limit else text[: limit - 1] + "…"
