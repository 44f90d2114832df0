"""The command compare-plans: planners beside a proven bound, and what staging costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..routing.objectives import DEFAULT, NAMES, objective_of
from .console import Json
from .missions import Figure, Seed
from .outputs import named_values
from .subjects import Folders, Parameters, add_folders, values_of

if TYPE_CHECKING:
    from ..studies.analysis.staging import Candidate, Loss


StagedOptions = Annotated[
    list[str] | None,
    typer.Option("--option", help="An option of the staged planner.", metavar="NAME=VALUE"),
]


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command("compare-plans")(compare_plans)


def compare_plans(
    instances: Annotated[
        list[Path], typer.Argument(metavar="INSTANCE…", help="Instances, by file or name.")
    ],
    objective: Annotated[str, typer.Option(help=f"One of {NAMES}.")] = DEFAULT,
    seconds: Annotated[float, typer.Option(help="For the exact planner, on each.")] = 30.0,
    cluster_model: Annotated[str | None, typer.Option(help="Formulation of Eq. 1.")] = None,
    victim_model: Annotated[str | None, typer.Option(help="Formulation of Eq. 2.")] = None,
    parameters: Parameters = None,
    options: StagedOptions = None,
    folders: Folders = None,
    seed: Seed = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Compare planners on instances, each beside a proven bound, and what the staged method loses."""
    from ..interruption import interrupted, interruptible
    from ..mission.errors import InputError
    from ..planners import check_options
    from ..planners import plan as make_plan
    from ..studies.analysis.staging import candidates, price_of_staging
    from ..studies.missions import read_instances
    from .console import write_json
    from .outputs import check_outputs, write_picture

    objective_of(objective)
    if not seconds >= 0:
        raise InputError(f"{seconds!r}; give 0 or more", field="--seconds")
    check_outputs(json, figure=figure, inputs=instances)
    add_folders(folders)
    staged = named_values(options) | values_of(parameters)
    given = {"cluster_model": cluster_model, "victim_model": victim_model}
    staged |= {name: value for name, value in given.items() if value is not None}
    check_options("msmrta", staged)
    chosen, compared, losses_of = seed or 0, {}, {}
    with interruptible():
        for mission in read_instances(instances):
            compared[mission.name] = candidates(
                mission, objective, seconds=seconds, seed=chosen, staged=staged
            )
            if interrupted():
                break
            made = make_plan(mission, seed=chosen, **staged)
            losses = price_of_staging(made, objective, seconds=seconds / 4, seed=chosen)
            losses_of[mission.name] = losses
            if interrupted():
                break
        # Files first: whatever becomes of the screen, what was found is kept.
        write_json(json, _document(objective, compared, losses_of), what="comparison")
        if figure is not None and any(losses_of.values()):
            from ..studies.analysis.staging_picture import staging_losses

            write_picture(figure, lambda: staging_losses(losses_of, objective))
        for name, plans in compared.items():
            _show(name, objective, plans, losses_of.get(name, []))
        if interrupted():
            raise KeyboardInterrupt


def _document(
    objective: str,
    compared: Mapping[str, Sequence[Candidate]],
    losses_of: Mapping[str, Sequence[Loss]],
) -> dict[str, Any]:
    from ..mission.metrics import metrics_of

    metrics = metrics_of("plans")
    return {
        "objective": objective,
        "plans": [
            {
                "instance": name,
                "plan": item.name,
                "value": item.value,
                "bound": item.bound,
                "gap": item.gap,
                **{metric.name: metric.of(item.metrics) for metric in metrics},
            }
            for name, items in compared.items()
            for item in items
        ],
        "stages": [
            {
                "instance": name,
                "freed": item.stage,
                "before": item.before,
                "after": item.after,
                "loss": item.loss,
                "bound": item.bound,
            }
            for name, items in losses_of.items()
            for item in items
        ],
    }


def _show(name: str, objective: str, plans: Sequence[Candidate], losses: Sequence[Loss]) -> None:
    from ..mission.metrics import metrics_of
    from .console import table

    metrics = [metric for metric in metrics_of("plans") if metric.name != objective]
    table(
        f"{name}: plans by {objective}",
        ["plan", objective, "to its bound", "open", *(metric.heading for metric in metrics)],
        [
            (
                item.name,
                item.value,
                f"{item.value / item.bound:.3f}×" if item.bound else "–",
                f"{item.gap:.2%}",
                *(metric.of(item.metrics) for metric in metrics),
            )
            for item in plans
        ],
    )
    if losses:
        table(
            f"{name}: what each stage of the staged plan costs, freed from the last on",
            ["freed", "before", "after", "loss", "bound of after"],
            [(x.stage, x.before, x.after, x.loss, x.bound) for x in losses],
        )
