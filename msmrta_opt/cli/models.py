"""Commands about formulations and solvers: models."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Folders = Annotated[
    list[Path] | None, typer.Option("--models", help="A further folder of formulations.")
]


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (models,):
        app.command()(command)


def models(
    folders: Folders = None,
    stage: Annotated[str | None, typer.Option(help="Only those of this stage.")] = None,
) -> None:
    """List the formulations, broken files included."""
    from ..optimise import registry
    from .console import say, table

    for folder in folders or []:
        registry.add_models(folder)
    found = list(registry.listings(stage))
    rows = [
        (
            item.name,
            item.formulation.spec.stage,
            item.formulation.spec.title,
            ", ".join(
                f"{name} in [{p.low:g}, {p.high:g}]"
                for name, p in item.formulation.spec.parameters.items()
            ),
        )
        for item in found
        if item.formulation is not None
    ]
    table("Formulations", ["name", "stage", "what it is", "parameters"], rows)
    for item in found:
        if item.formulation is None:
            say(f"broken: {item.path}: {item.error}")
