"""The command check: instances, plans, and the bounds that plans claim."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ..certify.bound import Recheck
    from ..mission.instance import Instance
    from ..mission.plan import Plan

LONGEST_ROOT = 600.0
"""Seconds that the second solver gets for a root relaxation; the exact proof needs no solver."""


def check(
    files: Annotated[list[Path], typer.Argument(help="Instance and plan files.", metavar="FILE…")],
    bound: Annotated[
        bool,
        typer.Option(
            "--bound",
            help="Prove the bounds of exact plans again, from the instance and the stored prices, "
            "exactly; then solve the root relaxation by another solver.",
        ),
    ] = False,
    time_limit: Annotated[
        float | None,
        typer.Option(
            help="With --bound: seconds to solve the explicit model again, where the root "
            "relaxation does not prove all of the bound.  [default: not solved]",
        ),
    ] = None,
    solver: Annotated[
        str | None,
        typer.Option(help="With --bound: who solves again.  [default: glpk or scip; model: highs]"),
    ] = None,
) -> None:
    """Check instances and plans; plans by a checker that shares no code with the planners."""
    from ..certify.plan import problems
    from ..mission.errors import InputError
    from ..mission.instance import Instance

    for name, value in {"--time-limit": time_limit, "--solver": solver}.items():
        if value is not None and not bound:
            raise InputError("is for bounds; give --bound with it", field=name)
    if time_limit is not None and not time_limit >= 0:
        raise InputError(f"{time_limit!r}; give 0 or more", field="--time-limit")
    if solver is not None:
        from ..routing.second_solver import other_solver

        other_solver(solver)
    documents = [_read(file) for file in files]
    missions = [item for item in documents if isinstance(item, Instance)]
    failed = False
    for file, item in zip(files, documents, strict=True):
        if isinstance(item, Instance):
            typer.echo(
                f"{file}: a valid instance ({item.n_robots} robots, "
                f"{item.n_victims} victims, {len(item.scouts)} scouts)"
            )
            continue
        wrong = problems(item)
        for problem in wrong:
            typer.echo(f"{file}: {problem}", err=True)
        if not wrong:
            typer.echo(f"{file}: the plan holds ({item.metrics.n_served} requirements served)")
            if bound:
                wrong = _check_bound(file, item, missions, time_limit, solver)
        failed = failed or bool(wrong)
    if failed:
        raise typer.Exit(1)


def _read(file: Path) -> Instance | Plan:
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from .outputs import document_format

    return (Plan if document_format(file).startswith("msmrta-plan") else Instance).read(file)


def _check_bound(
    file: Path, plan: Plan, missions: list[Instance], time_limit: float | None, solver: str | None
) -> list[str]:
    """What is wrong with the bound of `plan`; what is proved again is said, the rest on one line."""
    from ..certify.bound import recheck
    from ..mission.errors import InputError

    if missions and not any(map(plan.is_for, missions)):
        wrong = ["the plan is for another mission than the instance beside it"]
    else:
        try:
            found = recheck(plan)
        except InputError as error:
            raise error.within(file) from None
        wrong = list(found.problems)
        lines = [*_root(found), *_root_again(found, solver, wrong)] if not wrong else []
        if not wrong:
            lines += _claim(found)
        if not wrong and time_limit is not None and not found.whole:
            lines += _explicitly(plan, found, solver, time_limit, wrong)
        for line in lines:
            typer.echo(f"{file}: {line}")
    if wrong:
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        typer.echo(f"{file}: {wrong[0]}{more}", err=True)
    return wrong


def _root(found: Recheck) -> list[str]:
    if found.proved is None:
        return []
    certificate = found.certificate
    proved, objective = f"{float(found.proved):.9g}", certificate.model
    if certificate.root is not None:
        who, how = certificate.root.solver, f"{certificate.root.n_cuts} cuts"
    elif certificate.pricing is not None:
        who, how = certificate.pricing.solver, f"rounds: {len(certificate.pricing.rounds)}"
    else:
        return [f"a {objective} of {proved} follows from the requirements alone"]
    return [
        f"root bound {proved} on the {objective} proved again, in exact numbers from the prices of "
        f"{who} ({how})"
    ]


def _root_again(found: Recheck, solver: str | None, wrong: list[str]) -> list[str]:
    """The root relaxation by another solver."""
    from ..certify.bound import TOLERANCE
    from ..mission.errors import SolverError
    from ..routing.second_solver import other_solver, root_again

    if found.relaxation is None:
        return []
    try:
        name = other_solver(solver)
    except SolverError as error:
        return [f"root relaxation not solved again: {error}"]
    solution = root_again(found.relaxation, solver=name, time_limit=LONGEST_ROOT)
    who = f"{name} {solution.solver_version}"
    if solution.status == "infeasible":
        wrong.append(f"{who} finds no point of the root relaxation, where the plan is one")
    if solution.status != "optimal" or solution.objective is None:
        return [f"{who} does not solve the root relaxation: {solution.message}"]
    prices = float(found.relaxation.bound())
    if solution.objective < prices - TOLERANCE * max(1.0, abs(prices)):
        wrong.append(
            f"{who} solves the root relaxation to {solution.objective:.9g}, below what its prices "
            f"prove, {prices:.9g}"
        )
    return [
        f"{who} solves the same relaxation to {solution.objective:.9g}; the prices prove {prices:.9g}"
    ]


def _claim(found: Recheck) -> list[str]:
    certificate = found.certificate
    claim = f"the certificate claims {certificate.bound:.9g} by {certificate.proof}"
    if found.whole:
        return [f"{claim}: all of it is proved again"]
    return [
        f"{claim}: what is beyond the root was proved by {certificate.proof}, and is not re-checked"
    ]


def _explicitly(
    plan: Plan, found: Recheck, solver: str | None, time_limit: float, wrong: list[str]
) -> list[str]:
    """The explicit model of the plan's problem, solved again."""
    from ..certify.bound import TOLERANCE
    from ..planners.support.explicit_model import solve_explicitly

    claimed, objective = found.certificate.bound or 0.0, found.certificate.model
    solution = solve_explicitly(plan, objective, solver=solver, time_limit=time_limit)
    who = f"{solution.solver} {solution.solver_version} on {solution.formulation}"
    slack = TOLERANCE * max(1.0, abs(claimed))
    if solution.status == "infeasible":
        wrong.append(f"{who} finds no plan at all, where there is one")
    elif solution.objective is not None and solution.objective < claimed - slack:
        wrong.append(
            f"{who} finds {solution.objective:.9g}, below the bound {claimed:.9g} that is claimed"
        )
    reached = "no bound" if solution.bound is None else f"{solution.bound:.9g}"
    if solution.bound is not None and solution.bound >= claimed - slack:
        return [f"{who} proves {reached}: all of the claim is proved again"]
    return [f"{who} proves {reached} in {time_limit:g} s: the claim is not proved again"]
