"""The command line ``msmrta``.

Bad input gets one line on standard error and exit status 2; an answer that fails its check, or that
does not exist, gets exit status 1; Ctrl-C gets 130. Each group of commands is a file; what a command
needs is imported when it runs.
"""

from __future__ import annotations

import os
import sys

import typer

from ..mission.errors import CheckError, MsmrtaError
from . import compare, exact, generate, missions, models, plans, programs, study, tradeoff

app = typer.Typer(
    name="msmrta",
    help="An operations researcher's workbench for multi-robot task assignment in search and rescue.",
    add_completion=False,
    context_settings={"max_content_width": 120},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help starts in half the time
)
for group in (missions, generate, exact, plans, models, programs, compare, tradeoff, study):
    group.register(app)


def main() -> None:
    """Run the command line and exit."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command; returns its exit status."""
    if not arguments:
        run(["--help"])
        return 2
    try:
        status = app(arguments, prog_name="msmrta", standalone_mode=False)
        sys.stdout.flush()
    except MsmrtaError as error:
        return _complain(error, 1 if isinstance(error, CheckError) else 2)
    except typer.TyperException as error:
        # Its own printing takes a box of several lines; the message alone says what is wrong.
        message = error.format_message() if hasattr(error, "format_message") else str(error)
        return _complain(message, getattr(error, "exit_code", 2))
    except (KeyboardInterrupt, typer.Abort):
        print("interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader, such as `head`, has gone; nothing is left to say, also not at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        # A full disk, a name too long: the system's own words, which name the file.
        return _complain(error, 2)
    return status if isinstance(status, int) else 0


def _complain(problem: object, status: int) -> int:
    # Without any arguments the help has been shown, and nothing is left to say.
    if text := " ".join(str(problem).split()):
        print(f"error: {text}", file=sys.stderr)
    return status
