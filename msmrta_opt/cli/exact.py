"""The command exact: the joint problem, with a proven bound."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..routing.objectives import DEFAULT, NAMES
from .missions import Figure, InstanceFile, Json, Seed


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(exact)


def exact(
    instance: InstanceFile,
    objective: Annotated[str, typer.Option(help=f"What to minimise: {NAMES}.")] = DEFAULT,
    time_limit: Annotated[
        float, typer.Option(help="Seconds of wall time; with --proof as many for the proof.")
    ] = 60.0,
    gap: Annotated[float, typer.Option(help="Relative gap to stop at, 0 to 1.")] = 0.0,
    endurance: Annotated[
        float | None, typer.Option(help="Maximum time units that a robot may be busy.")
    ] = None,
    longest_walk: Annotated[
        float | None, typer.Option(help="Maximum cells that a robot may walk.")
    ] = None,
    return_to_start: Annotated[
        bool, typer.Option("--return/--open", help="Whether robots walk back to their starts.")
    ] = False,
    parameters: Annotated[
        Path | None, typer.Option(help="A TOML file of tuning parameters.", metavar="FILE")
    ] = None,
    proof: Annotated[
        Path | None,
        typer.Option(
            help="Also prove that no plan is better, to the last branch, in this file: FILE.vipr, for "
            "latency FILE.json.",
            metavar="FILE",
        ),
    ] = None,
    seed: Seed = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Plan a mission as well as the time allows, and prove how good the plan is.

    The plan that --json writes carries its limits and what proves the root bound, so that
    `msmrta check --bound` can prove it again; what --proof writes proves all of the bound, and
    `msmrta check PLAN --proof FILE` checks it. The plan then says so, and which file it is.
    """
    import time

    from ..mission.instance import Instance
    from ..planners import plan as make_plan
    from ..planners.support.plan_proof import prove_plan, require_suffix, with_proof
    from ..routing.callbacks import Callbacks, SearchState
    from ..routing.parameters import Parameters
    from .console import STANDARD_OUTPUT, writing
    from .outputs import check_outputs, write_plan
    from .proofs import say_proof
    from .tables import show_certificates, show_plan

    if proof is not None:
        require_suffix(objective, proof)
    check_outputs(json, proof, figure=figure, inputs=[instance, parameters])
    tuned = None if parameters is None else Parameters.read(parameters)
    began = time.monotonic()

    class Report(Callbacks):
        def incumbent_found(self, state: SearchState) -> None:
            self.phase_began(state, "better routes")

        def bound_raised(self, state: SearchState, proof: str) -> None:
            self.phase_began(state, proof)

        def phase_began(self, state: SearchState, phase: str) -> None:
            typer.echo(
                f"{time.monotonic() - began:7.1f} s   best {state.value:10.6g}"
                f"   bound {state.bound:10.6g}   gap {state.gap:7.2%}   {phase}",
                err=True,
            )

    made = make_plan(
        Instance.read(instance),
        planner="exact",
        objective=objective,
        time_limit=time_limit,
        gap=gap,
        endurance=endurance,
        longest_walk=longest_walk,
        return_to_start=return_to_start,
        seed=seed or 0,
        parameters=tuned,
        callbacks=Report(),
    )
    only_once = json == STANDARD_OUTPUT and proof is not None
    write_plan(made, None if only_once else json, figure)
    show_plan(made, certificates=proof is None)
    if proof is not None:
        try:
            found = prove_plan(made, path=proof, time_limit=time_limit)
            made = with_proof(made, found)
        finally:  # as proved as it is by then
            show_certificates(made)
        if only_once:
            write_plan(made, json, None)
        elif json is not None:
            with writing("", json):
                made.save(json)
        say_proof(str(proof), found)
