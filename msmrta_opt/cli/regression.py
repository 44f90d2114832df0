"""What compare does with a baseline: hold against it, report, and write it again."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..studies.analysis.regression import Regression
    from ..studies.record import Record


def check_options(
    against: Path | None, save: Path | None, slower: float | None, *, update: bool
) -> None:
    """Refuse, before any work, what could only be ignored.

    Raises
    ------
    InputError
        If an option goes with a baseline that is not given.
    """
    from ..mission.errors import InputError

    if slower is not None and (against is None or not slower > 0):
        raise InputError(
            f"{slower:g}; give a ratio above 0, together with --against", field="--slower"
        )
    if update and against is None:
        raise InputError("goes with a baseline; give --against FILE", field="--update")
    if update and save is not None:
        raise InputError("writes what --against names; leave out --save", field="--update")


def write_reports(
    records: Sequence[Record],
    found: Regression | None,
    wrong: Sequence[str],
    junit: Path | None,
    markdown: Path | None,
) -> None:
    """Write the reports for other programs where they are asked for."""
    from ..mission.files import write_text
    from ..studies.analysis import regression_files
    from .console import writing

    if junit is not None:
        with writing("", junit):
            write_text(junit, regression_files.junit(records, found, wrong))
    if markdown is not None:
        with writing("", markdown):
            write_text(markdown, regression_files.markdown(records, found, wrong))


def show(found: Regression, against: Path) -> None:
    """Print what changed in red, and what is for information."""
    from .console import console, say

    for line in found.lines:
        console().print(f"changed: {line}", style="red", markup=False)
    for line in found.information:
        say(f"for information: {line}")
    if not found.changes:
        say(f"nothing has changed against {against}")


def update_baseline(found: Regression, against: Path) -> bool:
    """Write the baseline again, on a terminal after a question; whether it was."""
    import typer

    from ..studies.analysis.regression import save_baseline
    from .console import say

    asked = sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()
    if found.changes and asked and not typer.confirm(f"Write this to {against}?"):
        say(f"{against} stays as it is")
        return False
    save_baseline(found.after, against, before=found.before)
    say(f"baseline written to {against}")
    return True
