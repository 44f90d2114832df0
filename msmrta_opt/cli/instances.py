"""The command instances: the missions that come with the package."""

from __future__ import annotations

import typer


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(instances)


def instances() -> None:
    """List the instances that come with the package; their names stand for their files anywhere."""
    from ..mission.examples import example, examples
    from .console import table

    rows = []
    for name in examples():
        mission = example(name)
        n_rows, n_cols = mission.map.shape
        counts = mission.n_robots, mission.n_victims, len(mission.scouts)
        rows.append((name, *counts, f"{n_rows} × {n_cols}", mission.description))
    columns = ["name", "robots", "victims", "scouts", "map", "description"]
    table("Instances", columns, rows, wraps="description")
