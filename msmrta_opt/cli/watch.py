"""The command watch: solve a formulation again whenever its file is saved, and say what changed."""

from __future__ import annotations

import hashlib
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .missions import InstanceFile
from .subjects import Folders, Model, Options, Parameters, numbers, prepared

if TYPE_CHECKING:
    from ..diagnosis.watched import Built, Solved
    from ..optimise.registry import Formulation

POLL_SECONDS = 0.1
"""How often the file is looked at."""


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(watch)


def watch(
    model: Model,
    instance: InstanceFile,
    solver: Annotated[str, typer.Option(help="auto, or a solver's name.")] = "auto",
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    time_limit: Annotated[float | None, typer.Option(help="Seconds for each solve.")] = None,
    json: Annotated[
        Path | None,
        typer.Option("--json", help="Append what changed here, a JSON document to a line."),
    ] = None,
) -> None:
    """Solve a formulation, and again on every save of its file; say what changed. Ctrl-C ends it."""
    from ..diagnosis.watched import built, solved
    from ..interruption import interrupted, interruptible
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, inputs=[instance])
    formulation, data = prepared(model, instance, options, folders)
    values = numbers(formulation, parameters)

    def build(formulation: Formulation) -> Built:
        return built(formulation, data, **values)

    def solve(what: Built) -> Solved:
        return solved(what.program, solver=solver, time_limit=time_limit)

    def show(text: str) -> None:
        say(text)
        sys.stdout.flush()  # where it is piped, too: the next save may be far

    with interruptible():
        watched = Watched(formulation.name, formulation.path, build, solve, show)
        show(f"{formulation.path}: watching; Ctrl-C ends it")
        said: dict[str, Any] | None = watched.first(formulation)
        while True:
            if said is not None:
                _append(json, said)
            if interrupted():
                return
            time.sleep(POLL_SECONDS)
            said = watched.look()


@dataclass
class Watched:
    """A model's file, and what it was when it last could be solved."""

    name: str
    path: Path
    build: Callable[[Formulation], Built]
    solve: Callable[[Built], Solved]
    show: Callable[[str], None]
    _last: tuple[Built, Solved] | None = None
    _seen: tuple[int, int] | None = None
    _digest: bytes = b""
    _pending: tuple[int, int] | None = (0, 0)
    _saves: int = field(default=0)

    def first(self, formulation: Formulation) -> dict[str, Any]:
        """Show what it is at the beginning, and give it as a document."""
        from ..mission.errors import MsmrtaError

        self._seen, self._digest = self._stamp(), self._content()
        try:
            return self._told(formulation)
        except MsmrtaError as error:
            return self._broken(error)

    def look(self) -> dict[str, Any] | None:
        """Show what a save since the last look has changed; ``None`` if there was none.

        A file that has just been written, or is gone, is left until it is so at two looks: an editor
        may be at it still.
        """
        from ..mission.errors import MsmrtaError
        from ..optimise import registry

        stamp = self._stamp()
        if stamp == self._seen:
            return None
        if stamp != self._pending:
            self._pending = stamp
            return None
        self._seen = stamp
        content = self._content()
        if content == self._digest:
            return None
        self._digest = content
        self._saves += 1
        if stamp is None:
            return self._broken(f"{self.path}: the file is gone")
        try:
            formulation = registry.reload_model(self.name)
            return self._told(formulation, f"{self.path.name}, save {self._saves}:")
        except MsmrtaError as error:
            return self._broken(error)

    def _told(self, formulation: Formulation, head: str = "") -> dict[str, Any]:
        """Show the program as soon as there is one, and its solution when there is one."""
        from ..diagnosis.watched import program_changes, solution_changes

        last, now = self._last, self.build(formulation)
        lines = program_changes(last[0], now) if last else now.lines
        self.show("\n".join([*([head] if head else []), *_indented(lines)]))
        found = self.solve(now)
        more = solution_changes(last[1], found) if last else found.lines
        self._last = now, found
        if more or not lines:
            self.show("\n".join(_indented(more or ["nothing has changed"])))
        result = {"save": self._saves, "lines": [*lines, *more], "status": found.solution.status}
        if found.solution.found:
            result |= {"objective": found.solution.objective, "bound": found.solution.bound}
        return {**result, "gets": {who: list(names) for who, names in found.gets.items()}}

    def _broken(self, error: object) -> dict[str, Any]:
        line = f"broken: {' '.join(str(error).split())}"
        self.show(line)
        return {"save": self._saves, "broken": line}

    def _stamp(self) -> tuple[int, int] | None:
        try:
            found = self.path.stat()
        except OSError:
            return None
        return found.st_mtime_ns, found.st_size

    def _content(self) -> bytes:
        try:
            return hashlib.sha256(self.path.read_bytes()).digest()
        except OSError:
            return b""


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"  {line}" for line in lines]


def _append(path: Path | None, document: dict[str, Any]) -> None:
    import json

    if path is not None:
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(document, ensure_ascii=False) + "\n")
