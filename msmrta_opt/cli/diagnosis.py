"""Commands that say what a program does, and why: explain, diff."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import Json, write_json
from .subjects import Folders, Mission, Options, Parameters, Subject, asked, values_of

if TYPE_CHECKING:
    pass


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (explain, diff):
        app.command()(command)


def explain(
    model: Subject,
    instance: Mission = None,
    why_not: Annotated[
        list[str] | None,
        typer.Option(
            help="A value that you would rather have, or a file of them.",
            metavar="NAME=VALUE|FILE",
        ),
    ] = None,
    weight: Annotated[
        list[str] | None,
        typer.Option(
            help="Of a repair: cost of relaxing rows by 1, or bounds of a variable; inf for never.",
            metavar="LABEL=NUMBER",
        ),
    ] = None,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    time_limit: Annotated[float | None, typer.Option(help="Seconds.  [default: none]")] = None,
    json: Json = None,
) -> None:
    """Say why a program has no solution and what would repair it, or why its solution is this one."""
    from ..diagnosis.explain import explain as find
    from ..interruption import interrupted
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, inputs=[instance])
    what, data, values = asked(model, instance, parameters, options, folders)
    found = find(
        what,
        data,
        why_not=_values(why_not),
        weights=_weights(weight),
        time_limit=time_limit,
        **values,
    )
    write_json(json, found.as_dict(), what="explanation")
    say(found.text)
    if found.status == "unknown":
        if interrupted():
            raise KeyboardInterrupt
        raise typer.Exit(1)


def diff(
    model_a: Annotated[str, typer.Argument(help="A formulation, or a file.", metavar="MODEL_A")],
    model_b: Annotated[str, typer.Argument(help="Another.", metavar="MODEL_B")],
    instance: Mission = None,
    search: Annotated[
        bool,
        typer.Option(
            "--search", help="Look for a smallest generated mission that tells them apart."
        ),
    ] = False,
    tries: Annotated[int, typer.Option(help="With --search: missions to try.", min=1)] = 200,
    witness_file: Annotated[
        Path | None,
        typer.Option(
            "--witness", help="With --search: write that mission here.", metavar="FILE.json"
        ),
    ] = None,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    time_limit: Annotated[float | None, typer.Option(help="Seconds.  [default: none]")] = None,
    json: Json = None,
) -> None:
    """Compare two programs by variables and rows, and try each one's optimum in the other."""
    from ..diagnosis.difference import diff as find
    from ..interruption import interrupted
    from ..mission.errors import InputError
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, witness_file, inputs=[instance])
    if witness_file is not None and not search:
        raise InputError("goes with --search", field="--witness")
    documents: dict[str, Any] = {}
    texts: list[str] = []
    if instance is not None or not search:
        first, data, _ = asked(model_a, instance, None, options, folders)
        second, _, _ = asked(model_b, instance, None, options, folders)
        found = find(first, second, data, time_limit=time_limit, **values_of(parameters))
        documents["difference"] = found.as_dict()
        texts.append(found.text)
    if search:
        documents["search"], text = _search(
            model_a, model_b, tries, witness_file, parameters, options, folders
        )
        texts.append(text)
    write_json(json, documents, what="difference")
    say("\n".join(texts))
    if interrupted():
        raise KeyboardInterrupt


def _search(
    model_a: str,
    model_b: str,
    tries: int,
    file: Path | None,
    parameters: list[str] | None,
    options: list[str] | None,
    folders: list[Path] | None,
) -> tuple[dict[str, Any], str]:
    """The search as a document and in words; a witness is written to `file`."""
    from ..optimise import registry
    from ..stages.options import options_type
    from ..studies.analysis.witness import witness
    from .outputs import named_values
    from .subjects import add_folders

    add_folders(folders)
    first, second = registry.get(model_a), registry.get(model_b)
    given = options_type(first.spec.stage).of(**named_values(options))
    found = witness(first, second, tries=tries, options=given, **values_of(parameters))
    text = found.text
    if found.mission is not None and file is not None:
        found.mission.save(file)
        text += f"\nThe mission is written to {file}."
    document = {
        "tried": found.tried,
        "failed": found.failed,
        "mission": None if found.mission is None else found.mission.name,
        "difference": None if found.difference is None else found.difference.as_dict(),
    }
    return document, text


def _values(texts: list[str] | None) -> str | list[str] | None:
    """What was asked for: a file, or values."""
    from ..mission.errors import InputError

    if texts and any("=" not in text for text in texts):
        if len(texts) > 1:
            raise InputError("give one file, or values alone", field="--why-not")
        return texts[0]
    return [part for text in texts for part in text.split(";")] if texts else None


def _weights(texts: list[str] | None) -> dict[str, float]:
    from ..mission.errors import InputError

    found = {}
    for text in texts or []:
        label, _, number = text.rpartition("=")
        try:
            found[label] = float(number)
        except ValueError:
            label = ""
        if not label:
            raise InputError(f"{text!r}; give LABEL=NUMBER", field="--weight")
    return found
