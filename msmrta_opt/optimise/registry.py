"""The registry of formulations: every file of the models folders, found by name.

Only this module loads models. A file that does not import stays listed with its error; asking for it
raises that error. Folders of one's own come from `add_models` or the environment variable
``MSMRTA_MODELS`` (several, separated as in ``PATH``).
"""

from __future__ import annotations

import ast
import dis
import hashlib
import importlib
import inspect
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from .. import formulations
from ..mission.errors import InputError, ModelError, MsmrtaError
from ..mission.suggestions import meant
from .formulation import Spec

if TYPE_CHECKING:
    import cvxpy as cp

ENVIRONMENT = "MSMRTA_MODELS"
_read: WeakKeyDictionary[ModuleType, Formulation] = WeakKeyDictionary()
"""The formulations of the modules that are loaded."""


@dataclass(frozen=True)
class Formulation:
    """One formulation, as its file states it.

    ``build`` takes the data of ``spec.stage`` and returns a `cvxpy.Problem`.
    """

    name: str
    path: Path
    spec: Spec
    mathematics: str
    build: Callable[[Any], cp.Problem] = field(compare=False)
    digest: str = ""
    """Of the file's contents as they were loaded."""

    @cached_property
    def reads_data(self) -> bool:
        """Whether ``build`` looks at what it is given.

        If not, it states a program of its own: it can be solved, explained, compared and exported as
        it is, and is under no contract of a stage, whose plans it cannot serve.
        """
        code = getattr(self.build, "__code__", None)
        if code is None or code.co_argcount == 0:
            return True
        name = code.co_varnames[0]
        used = (step.argval for step in dis.get_instructions(code) if step.opcode in dis.haslocal)
        return name in code.co_cellvars or any(
            name in (item if isinstance(item, tuple) else (item,)) for item in used
        )

    def takes(self, **values: float) -> dict[str, Any]:
        """Those of `values` that are parameters of this formulation."""
        return {name: value for name, value in values.items() if name in self.spec.parameters}


@dataclass(frozen=True)
class Listing:
    """A file of a models folder: its formulation, or the error that it raised."""

    name: str
    path: Path
    formulation: Formulation | None = None
    error: str = ""
    details: str = field(default="", repr=False)


def folders() -> list[Path]:
    """The models folders, the shipped one first."""
    paths = list(formulations.__path__)
    for entry in os.environ.get(ENVIRONMENT, "").split(os.pathsep):
        if entry and str(Path(entry).resolve()) not in paths:
            add_models(entry)
    return [Path(path) for path in formulations.__path__]


def is_shipped(formulation: Formulation) -> bool:
    """Whether its file is one of the package's own."""
    return str(formulation.path.parent) == formulations.__path__[0]


def add_models(folder: str | Path) -> None:
    """Also find the formulations of `folder`.

    Raises
    ------
    InputError
        If there is no such folder.
    """
    path = Path(folder).resolve()
    if not path.is_dir():
        raise InputError("no such folder of models", file=folder)
    if str(path) not in formulations.__path__:
        formulations.__path__.append(str(path))
        importlib.invalidate_caches()


def remove_models(folder: str | Path) -> None:
    """No longer find the formulations of `folder`, which may be gone by now; undoes `add_models`.

    Raises
    ------
    InputError
        If `folder` is the shipped one, or was never added.
    """
    path = str(Path(folder).resolve())
    if path not in formulations.__path__[1:]:
        added = ", ".join(formulations.__path__[1:]) or "none"
        raise InputError(f"not an added folder of models; there are {added}", file=folder)
    formulations.__path__.remove(path)
    reload_models()


def reload_models() -> list[Listing]:
    """Read all formulations again, so that edited files take effect; returns what there is now."""
    prefix = formulations.__name__ + "."
    for module in [name for name in sys.modules if name.startswith(prefix)]:
        del sys.modules[module]
    importlib.invalidate_caches()
    return list(listings())


def reload_model(name: str) -> Formulation:
    """The formulation called `name`, its file read again; the others stay as they are.

    Raises
    ------
    InputError, ModelError
        As `get`.
    """
    sys.modules.pop(f"{formulations.__name__}.{name}", None)
    return get(name)


def _files() -> Iterator[tuple[Path, str]]:
    """Every model file, with an objection if an earlier folder has taken its name."""
    seen: dict[str, Path] = {}
    for folder in folders():
        for path in sorted(folder.glob("*.py")):
            if path.stem.startswith("_"):
                continue
            first = seen.setdefault(path.stem, path)
            if not path.is_file():
                yield path, "not a regular file"
            else:
                yield (
                    path,
                    "" if first == path else f"the name is taken by {first}; rename this file",
                )


def listings(stage: str | None = None) -> Iterator[Listing]:
    """Every formulation found, broken files included, in the order of folders and names."""
    for path, objection in _files():
        if not objection and _is_unrelated(path):
            continue
        listing = Listing(path.stem, path, error=objection) if objection else _load(path)
        formulation = listing.formulation
        if stage is None or formulation is None or formulation.spec.stage == stage:
            yield listing


def models(stage: str | None = None) -> list[Listing]:
    """Every formulation found, or every one of a stage, broken files included."""
    return list(listings(stage))


def get(name: str, *, stage: str | None = None) -> Formulation:
    """The formulation called `name`.

    Raises
    ------
    InputError
        If there is none of that name, or it is for another stage than `stage`.
    ModelError
        If its file does not import.
    """
    listing = _load(path_of(name, stage=stage))
    if listing.formulation is None:
        raise ModelError(f"{listing.path}: {listing.error}")
    if stage is not None and listing.formulation.spec.stage != stage:
        raise InputError(
            f"{name!r} is a {listing.formulation.spec.stage} formulation, not a {stage} one",
            field="model",
        )
    return listing.formulation


def for_plans(name: str, stage: str) -> Formulation:
    """The formulation called `name`, whose solutions a plan's `stage` can read.

    Raises
    ------
    InputError, ModelError
        As `get`, and if it reads nothing of the stage's data.
    """
    found = get(name, stage=stage)
    if not found.reads_data:
        raise ModelError(
            f"{name}: build(data) reads nothing of its data, so no plan can follow from it; "
            f"`msmrta solve` takes it as a program of its own"
        )
    return found


def find(name: str) -> Path | None:
    """The file of the formulation called `name`, which is not read; ``None`` if there is none."""
    places = [folder / f"{name}.py" for folder in folders()]
    found = next((place for place in places if place.is_file()), None)
    return None if name.startswith("_") else found


def path_of(name: str, *, stage: str | None = None) -> Path:
    """The file of the formulation called `name`, which is not read.

    Raises
    ------
    InputError
        If there is none of that name; those of `stage` are named then.
    """
    path = find(name)
    if path is None:
        usable = [item.name for item in listings(stage) if item.formulation]
        raise InputError(
            f"no formulation {name!r}{meant(name, usable)}; there are {', '.join(usable)}",
            field="model",
        )
    return path


def _is_unrelated(path: Path) -> bool:
    """Whether the file binds neither of a formulation's names; it is not run to find out."""
    if path.parent == Path(formulations.__path__[0]) or _loaded(path):
        return False
    try:
        body = ast.parse(path.read_bytes()).body
    except (SyntaxError, ValueError, OSError):
        return False  # what is wrong with it is said where it is loaded
    names = {name for statement in body for name in _bound(statement)}
    return not names & {"SPEC", "build", "*"}


def _bound(statement: ast.stmt) -> Iterator[str]:
    """The names that a statement of a module binds there."""
    if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
        yield statement.name
    elif isinstance(statement, (ast.Import, ast.ImportFrom)):
        yield from (alias.asname or alias.name for alias in statement.names)
    else:
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id
            elif isinstance(node, (ast.FunctionDef, ast.alias)):
                yield getattr(node, "asname", None) or node.name


def _module(path: Path) -> str:
    return f"{formulations.__name__}.{path.stem}"


def _loaded(path: Path) -> ModuleType | None:
    """The module of this very file, if it has been imported; a name may have been another folder's."""
    module = sys.modules.get(_module(path))
    return module if module is not None and module.__file__ == str(path) else None


def _import(path: Path) -> ModuleType:
    """Import a model file without leaving bytecode, which hides edits made within a second."""
    name = _module(path)
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    if _loaded(path) is None:
        sys.modules.pop(name, None)
        importlib.invalidate_caches()  # the file may be younger than the folder's listing
    try:
        return importlib.import_module(name)
    finally:
        sys.dont_write_bytecode = before


def _load(path: Path) -> Listing:
    if _is_unrelated(path):
        return Listing(
            path.stem, path, error="not a formulation: it has no SPEC and no build(data)"
        )
    try:
        module = _import(path)
        spec, build = module.SPEC, module.build
        if not isinstance(spec, Spec) or not callable(build):
            raise TypeError("SPEC is not a Spec(…), or build is not a function")
    except (Exception, SystemExit) as error:
        # A model file is the user's own code: whatever it raises is news about that file.
        return Listing(
            path.stem,
            path,
            error=_one_line(error, path),
            details="".join(traceback.format_exception(error)),
        )
    read = _read.get(module)
    if read is None or (read.path, read.spec, read.build) != (path, spec, build):
        mathematics = inspect.cleandoc(module.__doc__ or "")
        read = Formulation(path.stem, path, spec, mathematics, build, digest_of(path))
        _read[module] = read
    return Listing(path.stem, path, formulation=read)


def digest_of(path: Path) -> str:
    """A digest of the contents of a formulation's file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _one_line(error: BaseException, path: Path) -> str:
    if isinstance(error, SyntaxError) and error.lineno is not None:
        return f"line {error.lineno}: SyntaxError: {error.msg}"
    said = (str(error).splitlines() or [""])[0]
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == str(path)
    ]
    if lines and isinstance(error, MsmrtaError):
        return f"line {lines[-1]}: {said}"
    if lines:
        return f"line {lines[-1]}: {type(error).__name__}: {said}"
    if isinstance(error, AttributeError):
        return f"{said}; a model file has a SPEC and a function build(data)"
    return f"{type(error).__name__}: {said}"
