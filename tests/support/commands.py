"""Every command of the command line, with its arguments and options."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import typer

from msmrta_opt.cli import app


def commands() -> Mapping[str, frozenset[str]]:
    """By name, for instance ``study run``, what each takes: options as typed, arguments by name."""
    return {
        " ".join(path): frozenset(text for item in command.params for text in item.opts)
        for path, command in _walk(typer.main.get_command(app), ())
    }


def _walk(command: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    inside = getattr(command, "commands", {})
    for name, item in inside.items():
        yield from _walk(item, (*path, name))
    if not inside:
        yield path, command
