"""The command exact: the joint problem, with a proven bound."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, cast

import typer

from .missions import Figure, InstanceFile, Json, Seed

if TYPE_CHECKING:
    from ..routing.problem import Objective, Routes


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(exact)


def exact(
    instance: InstanceFile,
    objective: Annotated[str, typer.Option(help="total_time, makespan or latency.")] = "total_time",
    time_limit: Annotated[float, typer.Option(help="Seconds of wall time.")] = 60.0,
    gap: Annotated[float, typer.Option(help="Relative gap to stop at, 0 to 1.")] = 0.0,
    endurance: Annotated[
        float | None, typer.Option(help="Most time units that a robot may be busy.")
    ] = None,
    longest_walk: Annotated[
        float | None, typer.Option(help="Most cells that a robot may walk.")
    ] = None,
    return_to_start: Annotated[
        bool, typer.Option("--return/--open", help="Whether robots walk back to their starts.")
    ] = False,
    seed: Seed = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Plan a mission as well as the time allows, and prove how good the plan is.

    The plan that --json writes carries its limits and what proves the root bound, so that
    `msmrta check --bound` can prove it again.
    """
    import time

    from ..mission.instance import Instance
    from ..planners import plan as make_plan
    from .outputs import check_outputs, write_plan
    from .tables import show_plan

    check_outputs(json, figure=figure, inputs=[instance])
    began = time.monotonic()

    def report(routes: Routes, value: float, bound: float, what: str) -> None:
        del routes
        opening = max(value - bound, 0.0) / value if value else 0.0
        typer.echo(
            f"{time.monotonic() - began:7.1f} s   best {value:10.6g}   bound {bound:10.6g}"
            f"   gap {opening:7.2%}   {what}",
            err=True,
        )

    made = make_plan(
        Instance.read(instance),
        planner="exact",
        objective=cast("Objective", objective),
        time_limit=time_limit,
        gap=gap,
        endurance=endurance,
        longest_walk=longest_walk,
        return_to_start=return_to_start,
        seed=seed or 0,
        report=report,
    )
    show_plan(made)
    write_plan(made, json, figure)
