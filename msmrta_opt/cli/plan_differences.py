"""The command diff-plans: two plans beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import Json
from .missions import Figure


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command("diff-plans")(diff_plans)


PlanFile = Annotated[Path, typer.Argument(help="A plan file, as plan --json writes it.")]


def diff_plans(before: PlanFile, after: PlanFile, json: Json = None, figure: Figure = None) -> None:
    """Show what another plan does otherwise: visits that moved, and metrics beside each other."""
    from ..certify.same_mission import differences
    from ..mission.plan import Plan
    from ..mission.plan_difference import SERVED
    from .console import say, table, write_json
    from .outputs import check_outputs, write_picture

    check_outputs(json, figure=figure, inputs=[before, after])
    first, second = Plan.read(before), Plan.read(after)
    found = first.diff(second)
    others = differences(first, second.instance)
    document = {
        "summary": found.summary,
        "metrics": found.metrics,
        "moved": found.moved,
        "missions_differ": others,
    }
    write_json(json, document, what="difference")
    if figure is not None:
        write_picture(figure, found.plot)
    table(
        f"Metrics of {before} and {after}",
        ["metric", "before", "after", "difference"],
        [tuple(row.values()) for row in found.metrics],
    )
    if moved := found.moved:
        table(
            "Visits that moved (before → after)",
            ["victim", "requirements", "change", *SERVED],
            [
                (
                    *(row[name] for name in ("victim", "requirements", "change")),
                    *(_both(row[f"{name} before"], row[f"{name} after"]) for name in SERVED),
                )
                for row in moved
            ],
        )
    say(f"{found.summary}.")
    for line in others:
        say(f"The plans are for different missions: {line}.")


def _both(before: float | None, after: float | None) -> str:
    from .console import number

    if before == after:
        return number(before)
    return f"{number(before)} → {number(after)}"
