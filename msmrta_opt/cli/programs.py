"""Commands about integer programs: solve, export."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import Json
from .outputs import named_values
from .subjects import Folders, Mission, Options, Parameters, Subject, asked

if TYPE_CHECKING:
    from ..arrays import Floats
    from ..optimise.registry import Formulation
    from ..optimise.solution import Solution


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (solve, export):
        app.command()(command)


def solve(
    model: Subject,
    instance: Mission = None,
    solver: Annotated[str, typer.Option(help="auto, or a solver's name.")] = "auto",
    structure: Annotated[
        bool,
        typer.Option("--structure/--no-structure", help="Whether auto may use what is proven."),
    ] = True,
    time_limit: Annotated[float | None, typer.Option(help="Seconds.  [default: none]")] = None,
    gap: Annotated[float | None, typer.Option(help="Relative gap to stop at.")] = None,
    seed: Annotated[int | None, typer.Option(help="Of the solver's random choices.")] = None,
    threads: Annotated[int | None, typer.Option(help="Of the solver.  [default: 1]")] = None,
    start: Annotated[
        str | None,
        typer.Option(
            help="For the stage routing: a plan to start from, by its file or its planner; "
            "staged is msmrta.",
            metavar="PLAN.json|PLANNER",
        ),
    ] = None,
    verbose: Annotated[bool, typer.Option("--verbose", help="Show the solver's log.")] = False,
    proof: Annotated[
        Path | None,
        typer.Option(
            help="Prove what the solver says, and write the certificate here.", metavar="FILE.vipr"
        ),
    ] = None,
    proof_time: Annotated[float, typer.Option(help="Seconds to look for the proof.", min=0)] = 600,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    json: Json = None,
    figure: Annotated[
        Path | None,
        typer.Option(help="Write values, choice and duals as a picture: .png, .svg or .pdf."),
    ] = None,
) -> None:
    """Solve a formulation on an instance, or the program of a file; print solution and certificate."""
    from ..optimise.solve import solve as solve_it
    from .console import write_json
    from .outputs import check_outputs
    from .proofs import proved, require_suffix

    require_suffix(proof)
    check_outputs(proof, json, figure=figure, inputs=[instance or Path(model)])
    what, data, values = asked(model, instance, parameters, options, folders)
    point = None if start is None else _start(start, what, data, instance, options)
    solution = solve_it(
        what,
        data,
        solver=solver,
        structure=structure,
        time_limit=time_limit,
        gap=gap,
        seed=seed,
        threads=threads,
        start=point,
        verbose=verbose,
        **values,
    )
    write_json(json, solution.document(), what="solution")
    if figure is not None and solution.found:
        _draw(solution, what, data, values, figure)
    _show_solution(solution, is_own=not isinstance(what, str) and not what.reads_data)
    is_contradicted = False
    if proof is not None:
        found = proved(solution, what, data, proof, proof_time, values)
        is_contradicted = bool(found.contradiction)
    if not solution.found or is_contradicted:
        raise typer.Exit(1)


def _draw(
    solution: Solution,
    what: str | Formulation,
    data: Any,
    values: dict[str, Any],
    path: Path,
) -> None:
    from ..optimise.subject import subject
    from ..studies.analysis.solution_picture import plot_solution
    from .outputs import write_picture

    program = subject(what, data, **values).program
    write_picture(path, lambda: plot_solution(program, solution))


def _start(
    text: str,
    formulation: str | Formulation,
    data: Any,
    instance: Path | None,
    options: list[str] | None,
) -> dict[str, Floats]:
    """The plan of a file, or of a planner, as a point to start from."""
    from ..certify.plan import problems
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from ..planners import plan as make_plan
    from ..planners import planners
    from ..planners.support.mip_start import mip_start

    if isinstance(formulation, str) or instance is None:
        raise InputError("a plan is no start for a file; leave it out", field="--start")
    if formulation.spec.stage != "routing":
        raise InputError(
            f"a plan is no start for a formulation of stage {formulation.spec.stage!r}; "
            "give one of 'routing'",
            field="--start",
        )
    mission = Instance.read(instance)
    if text in planners() or text == "staged":
        seed = named_values(options).get("seed", 0)
        made = make_plan(mission, planner="msmrta" if text == "staged" else text, seed=seed)
    else:
        made = Plan.read(text)
        if wrong := problems(made):
            raise InputError(f"the plan does not hold: {wrong[0]}", file=text)
        if not made.is_for(mission):
            raise InputError(f"the plan is for another mission than {instance}", file=text)
    return mip_start(made, data, formulation)


def _show_solution(solution: Solution, *, is_own: bool) -> None:
    from .console import number, seconds, table

    rows: list[tuple[str, object]] = [
        ("status", solution.status),
        ("objective", f"{number(solution.objective, 9)} ({solution.sense})"),
        ("bound", number(solution.bound, 9)),
        ("gap", number(solution.gap)),
        ("proof", solution.proof or "–"),
        ("independent check", solution.check or "–"),
        ("solver", f"{solution.solver} {solution.solver_version}"),
        ("canonicalised in", seconds(solution.canonicalise_seconds)),
        ("solved in", seconds(solution.solve_seconds)),
        ("nodes", solution.nodes),
        ("variables, rows", f"{solution.n_variables}, {solution.n_rows}"),
    ]
    if solution.parameters:
        told = ", ".join(f"{k} = {v:g}" for k, v in solution.parameters.items())
        rows.append(("parameters", told))
    if is_own:
        rows.append(("data", "it reads nothing of the mission: a program of its own"))
    if solution.reason:
        rows.append(("the solver says", solution.reason))
    table(solution.formulation, ["what", "value"], rows)
    if solution.found:
        table("Variables that are not zero", ["variable", "value"], solution.nonzero())


def export(
    model: Subject,
    output: Annotated[Path, typer.Option("--output", "-o", help="The file: .mps or .lp.")],
    instance: Mission = None,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
) -> None:
    """Write a formulation on an instance, or the program of a file, for any solver, unsolved."""
    from ..optimise.export import export as write
    from ..optimise.export import require_format
    from .outputs import check_outputs

    check_outputs(output, inputs=[instance or Path(model)])
    require_format(output)
    what, data, values = asked(model, instance, parameters, options, folders)
    write(what, data, output, **values)
    typer.echo(f"{model} written to {output}")
