"""The command compare-plans: planners beside a proven bound, and what staging costs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..routing.objectives import DEFAULT, NAMES, objective_of
from .missions import Figure, Seed


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command("compare-plans")(compare_plans)


def compare_plans(
    instances: Annotated[list[Path], typer.Argument(metavar="INSTANCE…", help="Instance files.")],
    objective: Annotated[str, typer.Option(help=f"One of {NAMES}.")] = DEFAULT,
    seconds: Annotated[float, typer.Option(help="For the exact planner, on each.")] = 30.0,
    seed: Seed = None,
    figure: Figure = None,
) -> None:
    """Compare planners on instances, each beside a proven bound, and price the staged method."""
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..mission.metrics import metrics_of
    from ..planners import plan as make_plan
    from ..studies.analysis.staging import candidates, price_of_staging
    from .console import table
    from .outputs import check_outputs

    objective_of(objective)
    if not seconds >= 0:
        raise InputError(f"{seconds!r}; give 0 or more", field="--seconds")
    check_outputs(figure=figure, inputs=instances)
    metrics, priced = metrics_of("plans"), {}
    for mission in [Instance.read(path) for path in instances]:
        rows = [
            (
                item.name,
                item.value,
                f"{item.value / item.bound:.3f}×" if item.bound else "–",
                f"{item.gap:.2%}",
                *(metric.of(item.metrics) for metric in metrics),
            )
            for item in candidates(mission, objective, seconds=seconds, seed=seed or 0)
        ]
        columns = ["plan", objective, "to its bound", "open", *(m.heading for m in metrics)]
        table(f"{mission.name}: plans by {objective}", columns, rows)
        staged = make_plan(mission, seed=seed or 0)
        losses = price_of_staging(staged, objective, seconds=seconds / 4, seed=seed or 0)
        table(
            f"{mission.name}: what each stage of the staged plan costs, freed from the last on",
            ["freed", "before", "after", "loss", "bound of after"],
            [(x.stage, x.before, x.after, x.loss, x.bound) for x in losses],
        )
        priced[mission.name] = losses
    if figure is not None:
        from matplotlib.figure import Figure as Drawing

        from ..plots import save_figure
        from ..studies.analysis.staging_picture import staging_losses

        drawing = Drawing(figsize=(9, 1.8 + 0.6 * len(priced)), layout="constrained")
        staging_losses(priced, objective, ax=drawing.subplots())
        save_figure(drawing, figure)
        typer.echo(f"picture written to {figure}")
