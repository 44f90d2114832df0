"""Commands about missions: plan, planners, check, scout."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..routing.objectives import NAMES
from .check import check
from .console import Json as Json
from .subjects import Folders, Parameters, add_folders, values_of

InstanceFile = Annotated[
    Path,
    typer.Argument(help="An instance file, or the name of a shipped one.", metavar="INSTANCE"),
]
Figure = Annotated[Path | None, typer.Option(help="Write the picture here: .png, .svg or .pdf.")]
Seed = Annotated[int | None, typer.Option(help="Of all random choices.  [default: 0]")]


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (plan, planners, check, scout, schema):
        app.command()(command)


def plan(
    instance: InstanceFile,
    planner: Annotated[str, typer.Option(help="Which planner.")] = "msmrta",
    preset: Annotated[str | None, typer.Option(help="paper or authors.  [default: paper]")] = None,
    psi: Annotated[float | None, typer.Option(help="ψ of Eq. 1, 0 to 1.  [default: 0.95]")] = None,
    beta: Annotated[float | None, typer.Option(help="β of Eq. 2, 0 to 1.  [default: 0.5]")] = None,
    cluster_model: Annotated[str | None, typer.Option(help="Formulation of Eq. 1.")] = None,
    victim_model: Annotated[str | None, typer.Option(help="Formulation of Eq. 2.")] = None,
    seed: Seed = None,
    through_centre: Annotated[
        bool | None,
        typer.Option("--through-centre/--direct", help="Pass the cluster's centre, or not."),
    ] = None,
    solver: Annotated[
        str | None, typer.Option(help="Who solves the formulations.  [default: auto]")
    ] = None,
    parameters: Parameters = None,
    folders: Folders = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="Any other option of the planner, as NAME=VALUE.", metavar="NAME=VALUE"),
    ] = None,
    improve: Annotated[
        float | None,
        typer.Option(help="Then improve the plan by local search.", metavar="SECONDS"),
    ] = None,
    objective: Annotated[
        str | None,
        typer.Option(help=f"What to improve: {NAMES}."),
    ] = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Plan a mission, and print its tables, its metrics and the proofs behind them."""
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..planners import plan as make_plan
    from .outputs import check_outputs, named_values, write_plan
    from .tables import show_plan

    check_outputs(json, figure=figure, inputs=[instance])
    given = {
        "preset": preset,
        "psi": psi,
        "beta": beta,
        "cluster_model": cluster_model,
        "victim_model": victim_model,
        "seed": seed,
        "through_centre": through_centre,
        "improve": improve,
        "objective": objective,
        "solver": solver,
    }
    add_folders(folders)
    options: dict[str, Any] = {name: x for name, x in given.items() if x is not None}
    for name, value in named_values(option).items():
        if name in options or name in ("instance", "planner"):
            raise InputError(f"{name!r} is already given; give it once", field="--option")
        options[name] = value
    for name, number in values_of(parameters).items():
        if name in options:
            raise InputError(f"{name!r} is already given; give it once", field="--param")
        options[name] = number
    made = make_plan(Instance.read(instance), planner=planner, **options)
    write_plan(made, json, figure)
    show_plan(made)


def planners(json: Json = None) -> None:
    """List the planners with their options and defaults."""
    from ..planners import planners as all_planners
    from .console import table, write_json
    from .outputs import check_outputs

    check_outputs(json)
    found = all_planners().values()
    write_json(
        json,
        [{"name": x.name, "title": x.title, "options": dict(x.options)} for x in found],
    )
    rows = [
        (x.name, x.title, ", ".join(f"{name}={_plain(value)}" for name, value in x.options.items()))
        for x in found
    ]
    table("Planners", ["name", "what it is", "options"], rows)


def _plain(value: object) -> str:
    """A default as ``--option`` takes it."""
    import json

    return value if isinstance(value, str) else json.dumps(value)


def scout(
    instance: InstanceFile,
    walk: Annotated[str, typer.Option(help="ant_colony, random or levy.")] = "ant_colony",
    shared_table: Annotated[
        bool,
        typer.Option("--shared-table/--own-tables", help="One table of visits, or one per scout."),
    ] = True,
    steps: Annotated[int | None, typer.Option(help="Step limit.")] = None,
    until: Annotated[str, typer.Option(help="covered_or_found, or covered.")] = "covered_or_found",
    seed: Seed = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Send out an instance's scouts, and print who found whom, and when."""
    from ..mission.instance import Instance
    from ..stages.scouting import scouting
    from .console import say, table, write_json
    from .outputs import check_outputs, scouting_figure, write_picture

    check_outputs(json, figure=figure, inputs=[instance])
    mission = Instance.read(instance)
    report = scouting(
        mission,
        walk=walk,
        shared_table=shared_table,
        seed=seed or 0,
        max_steps=steps,
        stop=until,
    )
    write_json(json, report.model_dump(mode="json"), what="report")
    if figure is not None:
        write_picture(figure, lambda: scouting_figure(mission, report))
    rows = [(find.victim, find.scout, find.step) for find in report.finds]
    table("Victims found", ["victim", "scout", "step"], rows)
    say(
        f"{len(report.finds)} of {mission.n_victims} victims found in {len(report.coverage) - 1} "
        f"steps, {report.coverage[-1]:.1%} of the reachable area seen; ended: {report.ended}."
    )
    if report.not_found:
        say(f"Not found: {', '.join(map(str, report.not_found))}.")


def schema(
    of: Annotated[str, typer.Argument(help="instance or scenario.")] = "instance",
) -> None:
    """Print the JSON Schema of instance files, or of scenario files."""
    import json

    from ..mission import instance, scenario
    from ..mission.errors import InputError

    schemas = {"instance": instance.json_schema, "scenario": scenario.json_schema}
    if of not in schemas:
        raise InputError(f"{of!r}; give one of {', '.join(schemas)}", field="OF")
    print(json.dumps(schemas[of](), indent=1))
