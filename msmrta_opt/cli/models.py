"""Commands about formulations and solvers: models, show, new-model, solvers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import Json
from .outputs import named_values
from .subjects import Folders, Model, Options, Parameters, add_folders, numbers, prepared, values_of

if TYPE_CHECKING:
    from ..mission.instance import Instance
    from ..optimise.registry import Formulation, Listing


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (models, show, new_model, solvers):
        app.command()(command)


def models(
    instance: Annotated[
        Path | None, typer.Argument(help="Show sizes on this instance.", metavar="[INSTANCE]")
    ] = None,
    folders: Folders = None,
    stage: Annotated[str | None, typer.Option(help="Only those of this stage.")] = None,
    parameters: Parameters = None,
    options: Options = None,
    json: Json = None,
) -> None:
    """List the formulations, broken files included; on an instance also what each comes to there."""
    from ..mission.suggestions import none_of
    from ..optimise import registry
    from .console import say, table, write_json
    from .outputs import check_outputs

    check_outputs(json, inputs=[instance])
    add_folders(folders)
    mission = None
    if instance is not None:
        from ..mission.instance import Instance

        mission = Instance.read(instance)
    known = {item.formulation.spec.stage for item in registry.listings() if item.formulation}
    if stage is not None and stage not in known:
        raise none_of(stage, sorted(known), "--stage")
    found = list(registry.listings(stage))
    columns = ["name", "stage", "what it is", "parameters"]
    values, given = values_of(parameters), named_values(options)
    sizes = [_size(item, mission, given, values) if mission else () for item in found]
    records = [{**_record(item), **_named(size)} for item, size in zip(found, sizes, strict=True)]
    write_json(json, records)
    rows = [(*_about(item), *map(str, size)) for item, size in zip(found, sizes, strict=True)]
    table(
        "Formulations",
        [*columns, *(("variables", "rows") if mission else ())],
        rows,
    )
    for item in found:
        if item.formulation is None:
            say(f"broken: {item.path}: {item.error}")


def _about(item: Listing) -> tuple[str, str, str, str]:
    if item.formulation is None:
        return item.name, "–", f"broken: {item.error}", ""
    spec = item.formulation.spec
    ranges: dict[str, list[str]] = {}
    for name, p in spec.parameters.items():
        ranges.setdefault(f"[{p.low:g},{p.high:g}]", []).append(name)
    said = "; ".join(f"{', '.join(names)} in {span}" for span, names in ranges.items())
    return item.name, spec.stage, spec.title, said


def _record(item: Listing) -> dict[str, Any]:
    """What is said of a formulation in JSON."""
    known = item.formulation
    return {
        "name": item.name,
        "stage": known and known.spec.stage,
        "title": known and known.spec.title,
        "parameters": _parameters_of(known) if known else {},
        "file": str(item.path),
        "error": item.error or None,
    }


def _parameters_of(formulation: Formulation) -> dict[str, Any]:
    return {
        name: {"low": p.low, "high": p.high, "default": p.default, "meaning": p.meaning}
        for name, p in formulation.spec.parameters.items()
    }


def _named(size: tuple[object, ...]) -> dict[str, object]:
    """The size in JSON: numbers, or why there is none."""
    if not size:
        return {}
    if isinstance(size[0], int):
        return {"variables": size[0], "rows": size[1], "unbuilt": None}
    return {"variables": None, "rows": None, "unbuilt": size[1] or None}


def _size(
    item: Listing, instance: Instance, options: dict[str, Any], values: dict[str, float]
) -> tuple[object, object]:
    from ..mission.errors import MsmrtaError
    from ..optimise.compile import compile_formulation
    from ..stages.data import stage_data
    from ..stages.options import options_type

    if item.formulation is None:
        return "", ""
    spec = item.formulation.spec
    own = {name: value for name, value in values.items() if name in spec.parameters}
    try:
        data = stage_data(instance, spec.stage, options_type(spec.stage).of(**options))
        program = compile_formulation(item.formulation, data).program(**own)
    except MsmrtaError as error:
        return "–", str(error)
    return program.n_columns, program.n_rows


def show(
    model: Model,
    instance: Annotated[
        Path | None, typer.Argument(help="Show the program on this one.", metavar="[INSTANCE]")
    ] = None,
    data: Annotated[
        bool, typer.Option("--data", help="Print what the formulation is given on the instance.")
    ] = False,
    matrix: Annotated[
        Path | None,
        typer.Option(help="Write a picture of the program's matrix here: .png, .svg or .pdf."),
    ] = None,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    json: Json = None,
) -> None:
    """Print a formulation's mathematics; for an instance also its size, its structure and its data."""
    from ..mission.errors import InputError
    from ..optimise import registry
    from .console import say, write_json
    from .outputs import check_outputs, write_picture

    check_outputs(json, figure=matrix, inputs=[instance])
    add_folders(folders)
    formulation = registry.get(model)
    given: Any = None
    facts: dict[str, Any] = {}
    if instance is not None:
        _, given = prepared(model, instance, options, folders)
        facts = _facts(formulation, given, str(instance), numbers(formulation, parameters))
    elif data:
        raise InputError("is of an instance; give one", field="--data")
    elif matrix is not None:
        raise InputError("is of an instance; give one", field="--matrix")
    about = {
        "name": formulation.name,
        "stage": formulation.spec.stage,
        "title": formulation.spec.title,
        "mathematics": formulation.mathematics,
        "parameters": _parameters_of(formulation),
        "assumes": formulation.spec.assumes or None,
        "file": str(formulation.path),
    }
    write_json(json, {**about, **({"program": facts} if facts else {})})
    if matrix is not None:
        from ..optimise.compile import compile_formulation
        from ..studies.analysis.matrix_picture import plot_matrix

        program = compile_formulation(formulation, given).program(
            **numbers(formulation, parameters)
        )
        write_picture(matrix, lambda: plot_matrix(program))
    say(formulation.mathematics)
    say()
    for name, item in formulation.spec.parameters.items():
        say(f"{name}: {item.meaning}, {item.low:g} to {item.high:g}, default {item.default:g}")
    if formulation.spec.assumes:
        say(f"Assumes: {formulation.spec.assumes}")
    say(f"File: {formulation.path}")
    if facts:
        _show_program(facts)
    if data:
        from .data import show_data

        show_data(given)


def _facts(
    formulation: Formulation, data: Any, name: str, parameters: dict[str, Any]
) -> dict[str, Any]:
    """The program of a formulation on an instance, as JSON has it."""
    import numpy as np

    from ..optimise.compile import compile_formulation
    from ..optimise.structure import recognise

    compiled = compile_formulation(formulation, data)
    program = compiled.program(**parameters)
    binary = program.integer & (program.lower >= 0) & (program.upper <= 1)
    n_fixed = int(np.count_nonzero(program.lower == program.upper))
    n_equations = int(np.count_nonzero(program.row_lower == program.row_upper))
    n_entries = program.matrix.nnz
    area = max(program.n_rows * program.n_columns, 1)
    structure = recognise(program)
    return {
        "instance": data.mission.name or name,
        "sense": program.sense,
        "variables": program.n_columns,
        "binary": int(np.count_nonzero(binary)),
        "general_integer": int(np.count_nonzero(program.integer & ~binary)),
        "continuous": int(np.count_nonzero(~program.integer)),
        "fixed": n_fixed,
        "rows": program.n_rows,
        "equations": n_equations,
        "entries": n_entries,
        "density": n_entries / area,
        "structure": structure.description if structure else None,
        "seconds": compiled.seconds,
        "rows_by_label": {block.name: block.size for block in program.rows},
    }


def _show_program(facts: dict[str, Any]) -> None:
    from .console import seconds, table

    rows: list[tuple[str, object]] = [
        ("sense", facts["sense"]),
        ("variables", facts["variables"]),
        ("– binary", facts["binary"]),
        ("– general integer", facts["general_integer"]),
        ("– continuous", facts["continuous"]),
        ("– fixed by their bounds", facts["fixed"]),
        ("rows", facts["rows"]),
        ("– equations", facts["equations"]),
        ("entries", f"{facts['entries']} ({facts['density']:.2%} of the matrix)"),
        ("structure", facts["structure"] or "none recognised"),
        ("built and canonicalised in", seconds(facts["seconds"])),
    ]
    rows += [(f"rows '{label}'", size) for label, size in facts["rows_by_label"].items()]
    table(f"On {facts['instance']}", ["what", "value"], rows)


def new_model(
    name: Annotated[str, typer.Argument(help="The new formulation's name.", metavar="NAME")],
    source: Annotated[
        str | None, typer.Option("--from", help="The one to copy.", metavar="MODEL")
    ] = None,
    blank: Annotated[
        str | None,
        typer.Option(help="Or the stage of which it is the smallest.", metavar="STAGE"),
    ] = None,
    to: Annotated[
        Path | None,
        typer.Option(
            help="The folder to put it in.  [default: the source's own, or here]", metavar="DIR"
        ),
    ] = None,
    folders: Folders = None,
) -> None:
    """Write a new formulation to edit: a copy of another, or the smallest of a stage."""
    from ..mission.errors import InputError
    from ..optimise.new_models import blank_model, copy_model
    from .console import say

    add_folders(folders)
    if (source is None) == (blank is None):
        raise InputError("give either --from MODEL or --blank STAGE", field="new-model")
    if source is not None:
        path, what = copy_model(source, name, to), f"a copy of {source}"
        where = f" --models {to}" if to else ""
    else:
        to = to or Path()
        path = blank_model(blank or "", name, to)
        what, where = f"a small formulation of stage {blank}", f" --models {to}"
    say(f"{path} is {what}: edit it, then `msmrta show {name}{where}`")


def solvers(json: Json = None) -> None:
    """List the solvers: what each can do, its version, or how to install it."""
    from ..optimise.solvers import solvers as all_solvers
    from .console import table, write_json
    from .outputs import check_outputs

    check_outputs(json)
    abilities = ["integer", "lp", "bound", "duals", "time_limit", "gap", "seed", "threads", "start"]
    records = [
        {
            "name": solver.name,
            "title": solver.title,
            "installed": solver.installed,
            "version": solver.version if solver.installed else None,
            "package": f"{solver.package} {solver.package_version}" if solver.installed else None,
            **{ability: ability in solver.abilities for ability in abilities},
            "install": None if solver.installed else solver.install,
        }
        for solver in all_solvers().values()
    ]
    write_json(json, records)
    table(
        "Solvers",
        ["name", "what it is", "version", *abilities, "install"],
        [
            (
                record["name"],
                record["title"],
                record["version"],
                *("yes" if record[ability] else "" for ability in abilities),
                record["install"] or "",
            )
            for record in records
        ],
    )
