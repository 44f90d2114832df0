"""The command workload: how a plan shares out the work."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import Json
from .missions import Figure


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(workload)


def workload(
    plan: Annotated[Path, typer.Argument(help="A plan file, as plan --json writes it.")],
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Show each robot's time of service and of travel."""
    from ..mission.plan import Plan
    from ..mission.plan_tables import robots
    from .console import table, write_json
    from .outputs import check_outputs, write_picture

    check_outputs(json, figure=figure, inputs=[plan])
    made = Plan.read(plan)
    rows = robots(made)
    write_json(json, rows, what="workload")
    if figure is not None:
        from ..plots import plot_workload

        write_picture(figure, lambda: plot_workload(made))
    table(f"Workload of {plan}", list(rows[0]), [tuple(row.values()) for row in rows])
