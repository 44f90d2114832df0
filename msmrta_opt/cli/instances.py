"""The command instances: the missions that come with the package."""

from __future__ import annotations

from typing import Any

import typer

from .console import Json


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(instances)


def instances(json: Json = None) -> None:
    """List the instances that come with the package; their names stand for their files anywhere."""
    from ..mission.examples import example, examples
    from ..mission.shipped import shipped_instances
    from .console import table, write_json
    from .outputs import check_outputs

    check_outputs(json)
    records: list[dict[str, Any]] = []
    for name in examples():
        mission = example(name)
        records.append(
            {
                "name": name,
                "robots": mission.n_robots,
                "victims": mission.n_victims,
                "scouts": len(mission.scouts),
                "map": list(mission.map.shape),
                "description": mission.description,
                "file": str(shipped_instances()[name]),
            }
        )
    write_json(json, records)
    table(
        "Instances",
        ["name", "robots", "victims", "scouts", "map (rows × columns)", "description"],
        [
            (
                *(record[name] for name in ("name", "robots", "victims", "scouts")),
                " × ".join(map(str, record["map"])),
                record["description"],
            )
            for record in records
        ],
    )
