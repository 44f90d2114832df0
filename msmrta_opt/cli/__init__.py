"""The command line ``msmrta``.

Exit statuses, of every command:

- 0: done, also where a reader of the output left early, or where Ctrl-C or a limit ended a search with
  the best that it had found.
- 1: a plan, a solution or a comparison that fails its check, or that there is none of.
- 2: bad input, or output that cannot be written; a line on standard error says which, or one for each
  mistake of a file.
- 130, 143: Ctrl-C or SIGTERM came before what was asked for was whole; what there was is written and
  shown. A second one ends the process at once.

Each group of commands is a file; what a command needs is imported when it runs.
"""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from .. import interruption
from .._version import __version__
from ..mission.errors import CheckError, MistakesError, MsmrtaError
from . import (
    compare,
    convergence,
    diagnosis,
    exact,
    generate,
    instances,
    maps,
    missions,
    models,
    plan_differences,
    plan_export,
    plans,
    programs,
    proofs,
    replay,
    runs,
    study,
    tradeoff,
    watch,
    workload,
)
from .console import json_asked, put_off
from .screen import keep_from_libraries, open_closed_descriptors, screens

app = typer.Typer(
    name="msmrta",
    help="An operations researcher's workbench for multi-robot task assignment in search and rescue.",
    add_completion=True,
    context_settings={"max_content_width": 120},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help starts in half the time
)
for group in (
    missions, instances, generate, maps, exact, convergence, plans, plan_differences, plan_export,
    replay, models, workload, programs, diagnosis, watch, proofs, compare, tradeoff, study,
    runs,
):  # fmt: skip
    group.register(app)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"msmrta_opt {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Show the version, and exit.", callback=_version, is_eager=True
        ),
    ] = False,
) -> None:
    """An operations researcher's workbench for multi-robot task assignment in search and rescue."""


def main() -> None:
    """Run the command line and exit."""
    open_closed_descriptors()
    keep_from_libraries()
    status = run(sys.argv[1:])
    interruption.leave(status)
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """Run one command; returns its exit status."""
    with interruption.command(), screens() as (out, _):
        json_asked(None)
        with put_off() as failures:
            status = _run(arguments)
        for problem in dict.fromkeys(map(_worded, failures)):
            status = max(status, _complain(problem, 2))
        out.flush()
        if out.failure is not None:
            status = status or _complain(f"standard output: {out.failure.strerror}", 2)
        return status


def _run(arguments: list[str]) -> int:
    if not arguments:
        _run(["--help"])
        return 2
    try:
        status = app(arguments, prog_name="msmrta", standalone_mode=False)
    except MistakesError as errors:
        return max(_complain(error, 2) for error in errors.each)
    except MsmrtaError as error:
        return _complain(error, 1 if isinstance(error, CheckError) else 2)
    except typer.TyperException as error:
        # Its own printing takes a box of several lines; the message alone says what is wrong.
        message = error.format_message() if hasattr(error, "format_message") else str(error)
        return _complain(message, getattr(error, "exit_code", 2))
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted()
    except OSError as error:
        return _complain(_worded(error), 2)
    if status == 130:  # typer's word for a Ctrl-C, whichever signal it was
        return _interrupted()
    return status if isinstance(status, int) else 0


def _worded(error: Exception) -> str:
    if not isinstance(error, OSError):
        return str(error)
    # A full disk, a name too long: the system's own words.
    named = f"{error.filename}: " if error.filename else ""
    return f"{named}{error.strerror or error}"


def _interrupted() -> int:
    print("interrupted", file=sys.stderr)
    return interruption.exit_status()


def _complain(problem: object, status: int) -> int:
    # Without any arguments the help has been shown, and nothing is left to say.
    if text := " ".join(str(problem).split()):
        print(f"error: {text}", file=sys.stderr)
    return status
