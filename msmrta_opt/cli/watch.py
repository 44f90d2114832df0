"""The command watch: solve a formulation again whenever its file is saved, and say what changed."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .missions import InstanceFile
from .models import Folders, Model, Options, Parameters, numbers, prepared

if TYPE_CHECKING:
    from ..diagnosis.watched import State

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
    from ..diagnosis.watched import state
    from ..interruption import interrupted, interruptible
    from ..optimise.registry import Formulation
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, inputs=[instance])
    formulation, data = prepared(model, instance, options, folders)
    values = numbers(formulation, parameters)

    def solve(formulation: Formulation) -> State:
        return state(formulation, data, solver=solver, time_limit=time_limit, **values)

    with interruptible():
        watched = Watched(formulation.name, formulation.path, solve)
        say(f"{formulation.path}: watching; Ctrl-C ends it")
        said: Said | None = watched.first(formulation)
        while True:
            if said is not None:
                say(said.text)
                _append(json, said.document)
            if interrupted():
                return
            time.sleep(POLL_SECONDS)
            said = watched.look()


@dataclass(frozen=True)
class Said:
    """What there is to say of one save."""

    text: str
    document: dict[str, Any]


@dataclass
class Watched:
    """A model's file, and what it was when it last could be solved."""

    name: str
    path: Path
    solve: Callable[[Any], Any]
    _last: Any = None
    _seen: tuple[int, int] | None = None
    _digest: bytes = b""
    _pending: tuple[int, int] | None = (0, 0)
    _saves: int = field(default=0)

    def first(self, formulation: Any) -> Said:
        """What it is at the beginning."""
        from ..mission.errors import MsmrtaError

        self._seen, self._digest = self._stamp(), self._content()
        try:
            self._last = self.solve(formulation)
        except MsmrtaError as error:
            return self._broken(error)
        return Said(self._last.text, self._document(lines=self._last.text.splitlines()))

    def look(self) -> Said | None:
        """What a save since the last look has changed; ``None`` if there was none.

        A file that has just been written, or is gone, is left until it is so at two looks: an editor
        may be at it still.
        """
        from ..diagnosis.watched import edit
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
            now = self.solve(registry.reload_model(self.name))
        except MsmrtaError as error:
            return self._broken(error)
        head = f"{self.path.name}, save {self._saves}:"
        if self._last is None:
            text, lines = now.text, now.text.splitlines()
        else:
            found = edit(self._last, now)
            text, lines = found.text, list(found.lines)
        self._last = now
        return Said(f"{head}\n{text}", self._document(lines=lines))

    def _document(self, **what: Any) -> dict[str, Any]:
        found = self._last and self._last.solution
        result = {"save": self._saves, **what}
        if found:
            result |= {"status": found.status, "objective": found.objective, "bound": found.bound}
            result["gets"] = {who: list(names) for who, names in self._last.gets.items()}
        return result

    def _broken(self, error: object) -> Said:
        line = f"broken: {' '.join(str(error).split())}"
        return Said(line, {"save": self._saves, "broken": line})

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


def _append(path: Path | None, document: dict[str, Any]) -> None:
    import json

    if path is not None:
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(document, ensure_ascii=False) + "\n")
