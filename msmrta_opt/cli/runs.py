"""The command run: a plan executed in a world that does not hold still."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .console import Json
from .missions import Figure, Seed

if TYPE_CHECKING:
    from ..mission.run import Run


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(run)


def run(
    plan: Annotated[Path, typer.Argument(help="A plan file.", metavar="PLAN")],
    scenario: Annotated[
        Path | None,
        typer.Option(help="What may happen, a TOML file.  [default: nothing]", metavar="FILE"),
    ] = None,
    policy: Annotated[
        str, typer.Option(help="What to do when something happens: one of msmrta policies.")
    ] = "keep",
    seed: Seed = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="An option of the policy.", metavar="NAME=VALUE"),
    ] = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Execute a plan, and print what happened, and what came of it beside what was planned."""
    from ..execution.execute import execute
    from ..mission.errors import InputError
    from ..mission.plan import Plan
    from ..mission.scenario import Scenario
    from .console import STANDARD_OUTPUT, say, write_json
    from .outputs import check_outputs, named_values

    check_outputs(json, figure=figure, inputs=[plan, scenario])
    made = Plan.read(plan)
    given = Scenario() if scenario is None else Scenario.read(scenario)
    try:
        given.check_for(made.instance)
    except InputError as error:
        raise error.within(scenario or "") from None
    happened = execute(made, given, policy, seed or 0, **named_values(option))
    if json == STANDARD_OUTPUT:
        write_json(json, happened.document())
    elif json is not None:
        happened.save(json)
        say(f"run written to {json}")
    if figure is not None:
        from ..plots import save_figure

        save_figure(happened.plot(), figure)
        say(f"picture written to {figure}")
    _show(happened)


def _show(run: Run) -> None:
    from ..mission.metrics import METRICS
    from ..mission.run_metrics import RUN_METRICS
    from .console import say, table

    told = [event for event in run.events if event.what != "served"]
    if told:
        table("Events", ["time", "what"], [(event.time, str(event)) for event in told])
    planned: dict[int, float] = {}
    for route in run.plan.routes:
        for visit in route.visits:
            if visit.served:
                planned[visit.victim] = max(planned.get(visit.victim, 0.0), visit.departure)
    done = run.metrics.completion
    needs = {victim.id: len(victim.requirements) for victim in run.victims}
    served = {v: sum(s.done and s.victim == v for s in run.services) for v in needs}
    table(
        "Victims: when the last of their requirements was done",
        ["victim", "planned", "done", "served", "of"],
        [(v, planned.get(v), done.get(v), served[v], needs[v]) for v in needs],
    )
    table(
        f"Metrics (policy {run.policy}, seed {run.seed})",
        ["metric", "planned", "done", "unit"],
        [
            (
                entry.label,
                entry.scaled(METRICS[name].of(run.plan.metrics)) if name in METRICS else None,
                entry.scaled(entry.of(run.metrics)),
                entry.unit,
            )
            for name, entry in RUN_METRICS.items()
        ],
    )
    say(f"Deciding took {run.deciding_seconds:.3f} s.")
