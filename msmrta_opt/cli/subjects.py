"""What a command is about: a formulation on an instance with its parameters, or a program in a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .outputs import named_values

if TYPE_CHECKING:
    from ..optimise.registry import Formulation

Folders = Annotated[
    list[Path] | None,
    typer.Option("--models", help="A further folder of formulations.", metavar="DIR"),
]
Model = Annotated[str, typer.Argument(help="A formulation.", metavar="MODEL")]
Subject = Annotated[
    str, typer.Argument(help="A formulation, or a file: .mps or .lp.", metavar="MODEL")
]
Mission = Annotated[
    Path | None,
    typer.Argument(
        help="An instance file, or the name of a shipped one; none for a file.",
        metavar="[INSTANCE]",
    ),
]
Parameters = Annotated[
    list[str] | None,
    typer.Option("--param", help="A parameter of the formulation.", metavar="NAME=VALUE"),
]
Options = Annotated[
    list[str] | None,
    typer.Option("--option", help="An option of the stages before.", metavar="NAME=VALUE"),
]


def add_folders(folders: list[Path] | None) -> None:
    """Make the formulations of `folders` known."""
    from ..optimise import registry

    for folder in folders or []:
        registry.add_models(folder)


def prepared(
    model: str, instance: Path, options: list[str] | None, folders: list[Path] | None = None
) -> tuple[Formulation, Any]:
    """The formulation and its data, for an instance file."""
    from ..mission.instance import Instance
    from ..optimise import registry
    from ..stages.data import stage_data
    from ..stages.options import options_type

    add_folders(folders)
    formulation = registry.get(model)
    stage = formulation.spec.stage
    given = options_type(stage).of(**named_values(options))
    return formulation, stage_data(Instance.read(instance), stage, given)


def asked(
    model: str,
    instance: Path | None,
    parameters: list[str] | None,
    options: list[str] | None,
    folders: list[Path] | None,
) -> tuple[str | Formulation, Any, dict[str, Any]]:
    """A formulation, its data and its parameters; or a file alone."""
    from ..mission.errors import InputError
    from ..optimise import registry
    from ..optimise.export import is_program

    if is_program(model):
        for given, what in ((instance, "INSTANCE"), (parameters, "--param"), (options, "--option")):
            if given:
                raise InputError("a file stands by itself; leave it out", field=what)
        return model, None, {}
    add_folders(folders)
    registry.path_of(model)
    if instance is None:
        raise InputError(f"{model!r} is a formulation; give an instance, too", field="INSTANCE")
    formulation, data = prepared(model, instance, options)
    return formulation, data, numbers(formulation, parameters)


def numbers(formulation: Formulation, texts: list[str] | None) -> dict[str, Any]:
    """The parameters of `formulation`, those of `texts` and defaults for the rest."""
    from ..optimise.compile import parameter_values

    return parameter_values(formulation, values_of(texts))


def values_of(texts: list[str] | None) -> dict[str, float]:
    """The parameters written as ``NAME=NUMBER``.

    Raises
    ------
    InputError
        If one has no name or no number, or is given twice.
    """
    from ..mission.errors import InputError

    given: dict[str, float] = {}
    for text in texts or []:
        name, _, value = text.partition("=")
        if name in given:
            raise InputError(f"{name!r} is given twice; give it once", field="--param")
        try:
            given[name] = float(value)
        except ValueError:
            raise InputError(f"{text!r}; give NAME=NUMBER", field="--param") from None
    return given
