"""The folder of a report: replaced whole or not at all, and only if it is a report."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ...mission.errors import InputError

PAGE = "report.html"
FIGURES = "figures"
DATA = "data"
MARK = '<meta name="generator" content="msmrta_opt study report">'
"""What tells a report of ours from any other page."""
PARTS = {"": ".html", FIGURES: ".png", DATA: ".csv"}
"""Folders within a report, and the suffix of all that is there."""


@contextmanager
def replaced_folder(folder: Path) -> Iterator[Path]:
    """A fresh folder that takes the place of `folder` when the block ends without an error.

    Raises
    ------
    InputError
        If `folder` is there and holds anything but a report, or cannot be written.
    """
    # A link stays a link: what it points at is replaced.
    folder = folder.resolve()
    _check_replaceable(folder)
    try:
        fresh = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror})", file=folder) from None
    try:
        for part in (FIGURES, DATA):
            (fresh / part).mkdir()
        yield fresh
        umask = os.umask(0)
        os.umask(umask)
        fresh.chmod(0o777 & ~umask)
        _swap(fresh, folder)
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror or error})", file=folder) from None
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def _check_replaceable(folder: Path) -> None:
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError("a file, where the report's folder is to be; name another", file=folder)
    entries = sorted(folder.rglob("*"))
    if not entries:
        return
    page = folder / PAGE
    if not page.is_file() or MARK not in page.read_text(encoding="utf-8", errors="replace"):
        raise InputError("not a report's folder, so it is left alone; name another", file=folder)
    for entry in entries:
        place = entry.parent.relative_to(folder).as_posix().removeprefix(".")
        own = entry.name in (FIGURES, DATA) if entry.is_dir() else PARTS.get(place) == entry.suffix
        if not own:
            raise InputError(
                "not part of a report, and would be lost; move it elsewhere", file=entry
            )


def _swap(fresh: Path, folder: Path) -> None:
    """Put `fresh` in the place of `folder`; if that fails, the old one is back."""
    old = fresh.with_name(f"{fresh.name}-old")
    had_one = folder.exists()
    if had_one:
        folder.rename(old)
    try:
        fresh.rename(folder)
    except OSError:
        if had_one:
            old.rename(folder)
        raise
    if had_one:
        shutil.rmtree(old)
