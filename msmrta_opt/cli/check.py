"""The command check: instances, plans, and the bounds that plans claim."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..mission.counting import counted
from .console import Json
from .proofs import SUFFIX, check_proofs
from .subjects import Folders, Options, Parameters, add_folders

if TYPE_CHECKING:
    from ..certify.certificates import Recheck
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from ..mission.run import Run
    from ..optimise.solution import Solution

ROOT_SECONDS = 600.0
"""That the second solver gets for a root relaxation; the exact proof needs no solver."""
WRONG, ONLY_CLAIMED = 1, 3
"""Exit statuses; bad input has 2."""


@dataclass
class _Verdict:
    """What a check of a file comes to."""

    wrong: list[str] = field(default_factory=list)
    said: list[str] = field(default_factory=list)
    only_claimed: list[str] = field(default_factory=list)
    """Bounds that were not proved again."""
    warnings: list[str] = field(default_factory=list)


def check(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Instance, plan and run files; or proofs (FILE.vipr); or a proof and the program that "
            "it must be of: a formulation and an instance, or a file.",
            metavar="FILE…",
        ),
    ],
    bound: Annotated[
        bool,
        typer.Option(
            "--bound",
            help="Prove the bounds of exact plans again, from the instance and the stored dual "
            "values, exactly; then solve the root relaxation by another solver.",
        ),
    ] = False,
    proof: Annotated[
        Path | None,
        typer.Option(
            help="Of one plan: the proof that `exact --proof` wrote, to the last branch.",
            metavar="FILE",
        ),
    ] = None,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="With --bound: a bound that is only claimed is wrong."),
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
    parameters: Parameters = None,
    options: Options = None,
    json: Json = None,
    folders: Folders = None,
) -> None:
    """Check instances, plans and runs; by checkers that share no code with what made them.

    A plan beside an instance must be for it, and every objective that a certificate claims is worked out
    again; all that is wrong is told. Of an instance, requirements that no robot can serve are a warning.
    The exit status is 0 if all holds and, with --bound or --proof, all
    bounds are proved again; 1 if anything is wrong; 2 for bad input; 3 if all holds, but a bound is
    only claimed.
    """
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from .console import write_json
    from .outputs import check_outputs

    add_folders(folders)
    if any(file.suffix == SUFFIX for file in files):
        if proof is not None:
            raise InputError("is for a plan; give proofs of programs as files", field="--proof")
        if json is not None:
            raise InputError("is for instances and plans, not for proofs", field="--json")
        check_proofs(files, options, parameters)
        return
    for name, value in {"--strict": strict, "--time-limit": time_limit, "--solver": solver}.items():
        if value not in (None, False) and not bound:
            raise InputError("is for bounds; give --bound with it", field=name)
    if time_limit is not None and not time_limit >= 0:
        raise InputError(f"{time_limit!r}; give 0 or more", field="--time-limit")
    if solver is not None:
        from ..routing.second_solver import other_solver

        other_solver(solver)
    check_outputs(json, inputs=[*files, proof])
    documents = [_read(file) for file in files]
    if proof is not None and sum(isinstance(item, Plan) for item in documents) != 1:
        raise InputError("is of one plan; give one plan with it", field="--proof")
    missions = [item for item in documents if isinstance(item, Instance)]
    wrong = only_claimed = False
    records = []
    for file, item in zip(files, documents, strict=True):
        if isinstance(item, Instance):
            verdict = _instance(item)
            _tell(file, verdict)
            records.append(_record(file, "instance", verdict))
            continue
        if not isinstance(item, Plan):
            verdict = _run(item, missions)
            _tell(file, verdict)
            records.append(_record(file, "run", verdict))
            wrong |= bool(verdict.wrong)
            continue
        verdict = _plan(item, missions, claims=not bound, proving=proof is not None)
        if bound and not verdict.wrong:
            try:
                _bounds(item, verdict, solver, time_limit)
            except InputError as error:
                raise error.within(file) from None
        if proof is not None and not verdict.wrong:
            _proof(item, proof, verdict)
        if strict:
            verdict.wrong += verdict.only_claimed
        _tell(file, verdict)
        records.append(_record(file, "plan", verdict))
        wrong |= bool(verdict.wrong)
        only_claimed |= bool(verdict.only_claimed)
    write_json(json, records)
    if wrong or only_claimed:
        raise typer.Exit(WRONG if wrong else ONLY_CLAIMED)


def _read(file: Path) -> Instance | Plan | Run:
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from ..mission.run import Run
    from ..mission.shipped import find_instance
    from .outputs import document_format

    path = find_instance(file)
    written = document_format(path)
    if written.startswith("msmrta-run"):
        return Run.read(path)
    return (Plan if written.startswith("msmrta-plan") else Instance).read(path)


def _tell(file: Path, verdict: _Verdict) -> None:
    from .console import say

    for line in verdict.said:
        say(f"{file}: {line}")
    for line in verdict.warnings:
        say(f"{file}: warning: {line}")
    for line in verdict.wrong:
        typer.echo(f"{file}: {line}", err=True)


def _record(file: Path, kind: str, verdict: _Verdict) -> dict[str, Any]:
    """What a file comes to, in JSON."""
    return {"file": str(file), "kind": kind, "holds": not verdict.wrong, **asdict(verdict)}


def _instance(mission: Instance) -> _Verdict:
    """An instance that could be read, with what nobody can serve."""
    from ..certify.availability import unavailable

    counts = [
        counted(mission.n_robots, "robot"),
        counted(mission.n_victims, "victim"),
        counted(len(mission.scouts), "scout"),
    ]
    return _Verdict(said=[f"a valid instance ({', '.join(counts)})"], warnings=unavailable(mission))


def _plan(plan: Plan, missions: list[Instance], *, claims: bool, proving: bool) -> _Verdict:
    """Whether the plan holds, with what it claims, and for one of `missions`, if there are any."""
    from ..certify.certificates import claim_problems
    from ..certify.cluster_weights import doubts
    from ..certify.plan import problems
    from ..certify.same_mission import differences

    verdict = _Verdict(problems(plan))
    if not verdict.wrong:
        verdict.warnings += doubts(plan)
    if claims and not verdict.wrong:
        verdict.wrong += claim_problems(plan)
    if missions:
        closest = min((differences(plan, mission) for mission in missions), key=len)
        verdict.wrong += [f"the plan is for another mission: {line}" for line in closest]
    if not verdict.wrong:
        verdict.said.append(
            f"the plan holds ({counted(plan.metrics.n_served, 'requirement')} served)"
        )
        verdict.said += [
            f"of its {item.model} is said: {item.how}; --proof FILE checks that (SHA-256 "
            f"{item.proved.digest[:16]}…)"
            for item in plan.certificates
            if item.proved is not None and not proving
        ]
    verdict.said += _changed(plan)
    return verdict


def _proof(plan: Plan, path: Path, verdict: _Verdict) -> None:
    """Whether the file proves the plan's optimality, or how far."""
    from ..certify.certificates import STAGE, TOLERANCE
    from ..certify.plan_proof import check_plan_proof, digest_of
    from ..mission.errors import CheckError

    try:
        found = check_plan_proof(path, plan)
    except CheckError as error:
        verdict.wrong.append(str(error))
        return
    verdict.said.append(f"{path}: {found.summary}")
    digest = digest_of(path)
    for certificate in plan.certificates:
        if certificate.proved is not None:
            named = certificate.proved.digest
            one = "the proof" if digest == named else f"not the proof (SHA-256 {named[:16]}…)"
            verdict.said.append(f"{path}: {one} that the plan names")
        if certificate.stage == STAGE and certificate.model == found.objective:
            claimed = certificate.bound or 0.0
            if claimed > found.bound + Fraction(TOLERANCE) * found.value:
                verdict.only_claimed.append(
                    f"the certificate claims {claimed:.9g} by {certificate.proof}: it is not proved"
                )


def _run(run: Run, missions: list[Instance]) -> _Verdict:
    """Whether a run holds, and was for one of `missions`, if there are any."""
    from ..certify.run import problems
    from ..certify.same_mission import differences

    verdict = _Verdict(problems(run))
    if missions:
        closest = min((differences(run.plan, mission) for mission in missions), key=len)
        verdict.wrong += [f"the plan is for another mission: {line}" for line in closest]
    if not verdict.wrong:
        verdict.said.append(
            f"the run holds ({counted(run.metrics.n_served, 'requirement')} served)"
        )
    return verdict


def _changed(plan: Plan) -> list[str]:
    """The formulations whose files are others now than when the plan was made."""
    from ..optimise.registry import digest_of, find

    said = []
    for model, digest in {x.model: x.digest for x in plan.certificates if x.digest}.items():
        path = find(model)
        if path is None:
            said.append(f"no formulation {model} is found here; --models names its folder")
        elif digest_of(path) != digest:
            said.append(f"formulation {model} has changed since the plan was made")
    return said


def _bounds(plan: Plan, verdict: _Verdict, solver: str | None, time_limit: float | None) -> None:
    """Prove every bound of a plan that holds again."""
    from ..certify.certificates import recheck, search_problems, stage_problems

    verdict.wrong += [*stage_problems(plan), *search_problems(plan)]
    every = recheck(plan)
    for number, found in enumerate(every):
        one = _bound(plan, found, solver, time_limit)
        name = f"certificate {number}: " if len(every) > 1 else ""
        verdict.wrong += [name + line for line in one.wrong]
        verdict.said += [name + line for line in one.said]
        verdict.only_claimed += [name + line for line in one.only_claimed]


def _bound(plan: Plan, found: Recheck, solver: str | None, time_limit: float | None) -> _Verdict:
    """One bound proved again, as far as it can be."""
    verdict = _Verdict(list(found.problems))
    certificate = found.certificate
    if verdict.wrong or certificate.bound is None:
        return verdict
    verdict.said.append(_root(found))
    _root_again(found, solver, verdict)
    claim = f"the certificate claims {certificate.bound:.9g} by {certificate.proof}"
    if found.whole:
        verdict.said.append(f"{claim}: all of it is proved again")
        return verdict
    how = f"what is beyond the root was proved by {certificate.proof}"
    verdict.said.append(f"{claim}: {how}, and is not re-checked")
    explicitly = time_limit is not None and _explicitly(
        plan, certificate.model, certificate.bound, solver, time_limit, verdict
    )
    if not explicitly:
        verdict.only_claimed.append(f"{claim}: it is not proved again")
    return verdict


def _root(found: Recheck) -> str:
    from ..certify.joint_problem import figure

    certificate = found.certificate
    proved = figure(found.proved or found.value)
    if certificate.root is not None:
        who, how = certificate.root.solver, f"{certificate.root.n_cuts} cuts"
    elif certificate.pricing is not None:
        who, how = certificate.pricing.solver, f"rounds: {len(certificate.pricing.rounds)}"
    else:
        return f"a {certificate.model} of {proved} follows from the requirements alone"
    return (
        f"root bound {proved} on the {certificate.model} proved again, in exact numbers from the "
        f"dual values of {who} ({how})"
    )


def _root_again(found: Recheck, solver: str | None, verdict: _Verdict) -> None:
    """The root relaxation by another solver."""
    from ..certify.certificates import TOLERANCE
    from ..mission.errors import SolverError
    from ..routing.second_solver import other_solver, root_again

    if found.relaxation is None:
        return
    try:
        name = other_solver(solver)
    except SolverError as error:
        verdict.said.append(f"root relaxation not solved again: {error}")
        return
    solution = root_again(found.relaxation, solver=name, time_limit=ROOT_SECONDS)
    who, proved = _who(solution), float(found.relaxation.bound())
    if solution.status == "infeasible":
        verdict.wrong.append(f"{who} finds no point of the root relaxation, where the plan is one")
    if solution.status != "optimal" or solution.objective is None:
        verdict.said.append(f"{who} does not solve the root relaxation: {solution.message}")
        return
    if solution.objective < proved - TOLERANCE * float(found.value):
        verdict.wrong.append(
            f"{who} solves the root relaxation to {solution.objective:.9g}, below what its dual "
            f"values prove, {proved:.9g}"
        )
    verdict.said.append(
        f"{who} solves the same relaxation to {solution.objective:.9g}; the dual values prove "
        f"{proved:.9g}"
    )


def _explicitly(
    plan: Plan,
    objective: str,
    claimed: float,
    solver: str | None,
    time_limit: float,
    verdict: _Verdict,
) -> bool:
    """The explicit model of the plan's problem, solved again; whether it proves what is claimed."""
    from ..certify.certificates import TOLERANCE
    from ..planners.support.explicit_model import solve_explicitly

    solution = solve_explicitly(plan, objective, solver=solver, time_limit=time_limit)
    who = f"{_who(solution)} on {solution.formulation}"
    slack = TOLERANCE * abs(claimed)
    if solution.status == "infeasible":
        verdict.wrong.append(f"{who} finds no plan at all, where there is one")
    elif solution.objective is not None and solution.objective < claimed - slack:
        verdict.wrong.append(
            f"{who} finds {solution.objective:.9g}, below the bound {claimed:.9g} that is claimed"
        )
    reached = "no bound" if solution.bound is None else f"{solution.bound:.9g}"
    if solution.bound is not None and solution.bound >= claimed - slack:
        verdict.said.append(f"{who} proves {reached}: all of the claim is proved again")
        return True
    verdict.said.append(
        f"{who} proves {reached} in {time_limit:g} s: the claim is not proved again"
    )
    return False


def _who(solution: Solution) -> str:
    return f"{solution.solver} {solution.solver_version}"
