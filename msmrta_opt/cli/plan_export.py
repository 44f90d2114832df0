"""The command export-plan: a plan for robots and other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command("export-plan")(export_plan)


def export_plan(
    plan: Annotated[Path, typer.Argument(help="A plan file, as plan --json writes it.")],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="The file: .yaml, .csv or .geojson.", metavar="FILE"),
    ],
    frame_id: Annotated[str, typer.Option(help="Of the poses, as ROS calls it.")] = "map",
) -> None:
    """Write what robots drive: Nav2 waypoints, a table of poses, or GeoJSON.

    Waypoints are a .yaml file for each robot that has a visit, FILE-0.yaml for robot 0, as Nav2's panel
    in RViz loads them. A plan that does not hold is not written.
    """
    from ..certify.plan import problems
    from ..mission.errors import CheckError
    from ..mission.files import write_text
    from ..mission.plan import Plan
    from ..mission.plan_export import plan_texts
    from .outputs import check_outputs

    made = Plan.read(plan)
    if wrong := problems(made):
        raise CheckError(f"{plan}: {wrong[0]}")
    texts = plan_texts(made, output, frame_id=frame_id)
    check_outputs(*texts, inputs=[plan])
    for file, text in texts.items():
        write_text(file, text)
        typer.echo(f"plan written to {file}")
    if not texts:
        typer.echo("no robot has a visit; nothing is written")
