"""Formulations × solvers × instances, each solve in a process of its own, and what they agree on."""

from __future__ import annotations

import platform
import time
from collections.abc import Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..isolation import Failure, Limits, run_isolated
from ..mission.errors import InputError, MsmrtaError
from ..mission.instance import Instance
from ..optimise import registry, solvers
from ..optimise.data import ClusterData
from ..optimise.solution import Solution
from ..optimise.solve import AUTO, solve
from ..optimise.solvers import Options
from ..stages.data import STAGES, stage_data
from ..stages.options import StagedOptions
from .rows import Row, frame

if TYPE_CHECKING:
    import pandas as pd

GRACE_SECONDS = 20.0
"""Time beyond the solver's limit after which a solve is killed; building is included."""
LIBRARIES = ("highspy", "networkx", "scipy.optimize", "scipy.sparse.csgraph", "sklearn.cluster")
"""What stages and solvers import when first used; loading it once for all saves most of the time."""


@dataclass(frozen=True)
class Case:
    """One solve to be done."""

    instance: Instance
    model: str
    solver: str
    seed: int | None
    stage: str
    options: StagedOptions
    parameters: dict[str, float]
    time_limit: float | None
    gap: float | None
    folders: tuple[str, ...]
    structure: bool = True
    """Whether ``auto`` may use what the matrix proves."""

    @property
    def key(self) -> tuple[str, str, str, int | None]:
        """What identifies the solve, as `Row.key` does."""
        return self.instance.name, self.model, self.solver, self.seed


def cases(
    instances: Sequence[Instance],
    *,
    stage: str,
    models: Sequence[str] = (),
    solver_names: Sequence[str] = (),
    seeds: Sequence[int] = (),
    options: StagedOptions | None = None,
    parameters: dict[str, float] | None = None,
    time_limit: float | None = None,
    gap: float | None = None,
    structure: bool = True,
) -> list[Case]:
    """Every combination to solve, in the order of instances, models, solvers, seeds.

    Without `models` all formulations of the stage are meant, broken files included; without
    `solver_names` ``auto`` and every installed solver. Without `structure` the solver ``auto`` is
    HiGHS with the integer program as it stands.

    Raises
    ------
    InputError
        If a stage, a solver or a model is unknown, a limit or seed out of range, or there is nothing
        to compare.
    """
    if stage not in STAGES:
        raise InputError(f"no stage {stage!r}; there are {', '.join(STAGES)}", field="stage")
    for seed in seeds or (None,):
        Options(time_limit=time_limit, gap=gap, seed=seed)
    known = {item.name: item for item in registry.listings()}
    for name in models:
        if name not in known:
            registry.get(name)
    chosen = dict.fromkeys(models or (item.name for item in registry.listings(stage)))
    for name in solver_names:
        if name != AUTO:
            solvers.get(name)
    installed = (name for name, solver in solvers.solvers().items() if solver.installed)
    names = dict.fromkeys(solver_names or (AUTO, *installed))
    if not instances or not chosen:
        raise InputError(f"no instance or no formulation of stage {stage!r}", field="compare")
    folders = tuple(str(folder) for folder in registry.folders())
    return [
        Case(
            instance,
            model,
            solver,
            seed,
            stage,
            options or StagedOptions(),
            parameters or {},
            time_limit,
            gap,
            folders,
            structure,
        )
        for instance, model, solver, seed in product(
            instances, chosen, names, dict.fromkeys(seeds or (None,))
        )
    ]


def compare(
    todo: Sequence[Case], *, jobs: int = 1, memory_limit: float | None = None
) -> Generator[Row, None, None]:
    """Solve each of `todo` by itself; rows come as they are finished.

    Closing the iterator ends what is still being solved.

    Parameters
    ----------
    todo : sequence of Case
        From `cases`.
    jobs : int
        How many at a time; more than one makes times less comparable.
    memory_limit : float, optional
        MiB of memory per solve.
    """
    limits = {case.time_limit for case in todo if case.time_limit is not None}
    deadline = max(limits) + GRACE_SECONDS if limits else None
    results = run_isolated(
        solve_case,
        [(case,) for case in todo],
        jobs=jobs,
        limits=Limits(deadline, memory_limit),
        preload=("msmrta_opt.studies.compare", *_modules_of(case.solver for case in todo)),
    )
    with closing(results):
        for index, result in results:
            case = todo[index]
            yield _failed(case, result) if isinstance(result, Failure) else _row(case, *result)


def solve_here(case: Case) -> Row:
    """Solve one case in this process: quicker, but nothing stops it or survives its crash."""
    try:
        return _row(case, *solve_case(case))
    except MsmrtaError as error:
        return _failed(case, Failure("raised", str(error)))


def _modules_of(names: Iterable[str]) -> list[str]:
    """What the solvers import when they first solve; loading it is not solving time."""
    known = solvers.solvers()
    used = {known[name].module for name in names if name != AUTO}
    return sorted({*LIBRARIES, *used})


def solve_case(case: Case) -> tuple[Solution, float]:
    """Solve one case, here; returns the solution and the wall time from data to checked solution.

    A solver that is not installed, or cannot do what the case asks, gives a solution ``skipped``.
    """
    for folder in case.folders:
        registry.add_models(folder)
    formulation = registry.get(case.model, stage=case.stage)
    reason = _cannot(case)
    if reason:
        skipped = Solution(case.model, "skipped", "min", message=reason, solver=case.solver)
        return skipped, 0.0
    data = stage_data(case.instance, case.stage, case.options)
    given: dict[str, Any] = {
        k: v for k, v in case.parameters.items() if k in formulation.spec.parameters
    }
    given = {
        name: getattr(case.options, name)
        for name in formulation.spec.parameters
        if hasattr(case.options, name)
    } | given
    _warm_up(case.solver)
    able = case.solver == AUTO or "time_limit" in solvers.get(case.solver).abilities
    began = time.perf_counter()
    try:
        solution = solve(
            formulation,
            data,
            solver=case.solver,
            structure=case.structure,
            seed=case.seed,
            time_limit=case.time_limit if able else None,
            gap=case.gap,
            **given,
        )
    except MsmrtaError as error:
        if "cannot do" in str(error):
            skipped = Solution(case.model, "skipped", "min", message=str(error), solver=case.solver)
            return skipped, 0.0
        raise
    return solution, time.perf_counter() - began


@cache
def _warm_up(solver: str) -> None:
    """Solve a tiny program first: what a library does once per process is not solving time."""
    tiny = ClusterData(np.eye(2), np.eye(2), np.ones(2, dtype=np.int64))
    solve("cluster_one_to_one", tiny, solver=solver)


def _cannot(case: Case) -> str:
    if case.solver == AUTO:
        return ""
    solver = solvers.get(case.solver)
    if not solver.installed:
        return f"not installed; {solver.install}"
    if case.seed is not None and "seed" not in solver.abilities:
        return f"solver {solver.name} cannot do seed"
    if case.gap is not None and "gap" not in solver.abilities:
        return f"solver {solver.name} cannot do gap"
    return ""


def _row(case: Case, solution: Solution, total: float) -> Row:
    solved = solution.status != "skipped"
    return Row(
        instance=case.instance.name,
        stage=case.stage,
        model=case.model,
        solver=case.solver,
        seed=case.seed,
        status=solution.status,
        sense=solution.sense if solved else "",
        objective=solution.objective,
        bound=solution.bound,
        gap=solution.gap,
        check=solution.check,
        proof=solution.proof,
        message=solution.message,
        canonicalise_seconds=solution.canonicalise_seconds if solved else None,
        solve_seconds=solution.solve_seconds if solved else None,
        total_seconds=total if solved else None,
        nodes=solution.nodes,
        n_variables=solution.n_variables if solved else None,
        n_rows=solution.n_rows if solved else None,
        solver_version=solution.solver_version,
        machine=platform.machine(),
    )


def _failed(case: Case, failure: Failure) -> Row:
    message = (
        failure.message if failure.reason == "raised" else f"{failure.reason}: {failure.message}"
    )
    return Row(
        instance=case.instance.name,
        stage=case.stage,
        model=case.model,
        solver=case.solver,
        seed=case.seed,
        status="error",
        message=message,
        machine=platform.machine(),
    )


def read_instances(paths: Sequence[str | Path]) -> list[Instance]:
    """The instances of files; each needs a name of its own, so a nameless one takes its file's.

    Raises
    ------
    InputError
        If a file is not an instance, or two instances have one name.
    """
    found: dict[str, Instance] = {}
    for path in paths:
        instance = Instance.read(path)
        if not instance.name:
            instance = instance.replace(name=Path(path).stem, clusters=instance.clusters)
        if instance.name in found:
            raise InputError(
                f"{instance.name!r} is also another file's; names tell rows apart",
                field="name",
                file=path,
            )
        found[instance.name] = instance
    return list(found.values())


def comparison(
    instances: Sequence[Instance],
    *,
    stage: str = "cluster",
    models: Sequence[str] = (),
    solvers: Sequence[str] = (),
    seeds: Sequence[int] = (),
    options: StagedOptions | None = None,
    jobs: int = 1,
    time_limit: float | None = 60.0,
    memory_limit: float | None = None,
    gap: float | None = None,
    structure: bool = True,
    **parameters: float,
) -> pd.DataFrame:
    """Compare formulations and solvers on instances, as a pandas table.

    Parameters
    ----------
    instances : sequence of Instance
        Each with a name of its own.
    stage : str
        Of the formulations.
    models, solvers : sequence of str
        By default all formulations of the stage; ``auto`` and every installed solver.
    seeds : sequence of int
        Of the solvers.
    options : StagedOptions, optional
        Of the stages before this one.
    jobs : int
        Solves at a time; more than one makes times less comparable.
    time_limit : float, optional
        Seconds per solve.
    memory_limit : float, optional
        MiB per solve.
    gap : float, optional
        Relative gap to stop at.
    structure : bool
        Whether ``auto`` may use what the matrix proves.
    **parameters : float
        The formulations' own, for instance ``psi``.

    Returns
    -------
    DataFrame
        One row a solve, in the order of `cases`, one column per field of `Row`.

    Raises
    ------
    InputError
        As `cases`.
    """
    todo = cases(
        instances,
        stage=stage,
        models=models,
        solver_names=solvers,
        seeds=seeds,
        options=options,
        parameters=parameters,
        time_limit=time_limit,
        gap=gap,
        structure=structure,
    )
    place = {case.key: i for i, case in enumerate(todo)}
    rows = compare(todo, jobs=jobs, memory_limit=memory_limit)
    return frame(sorted(rows, key=lambda row: place[row.key]))
