"""Formulations × solvers × instances, each solve in a process of its own, as a table."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Any

from ..isolation import Limits
from ..mission.errors import InputError
from ..mission.instance import Instance, require_mission
from ..stages.options import StagedOptions
from .missions import Mission
from .record import Record
from .runner import here, locally, records
from .runs import Run, combined, solving_contender
from .specification import Timing
from .tasks import Solving, solving_tasks

if TYPE_CHECKING:
    from .comparison_table import Comparison

GRACE_SECONDS = 20.0
"""Time beyond the solver's limit after which a solve is killed; building is included."""


def cases(instances: Sequence[Instance], **options: Any) -> list[Run]:
    """Every solve of a comparison, instance by instance; the options are those of `solving_tasks`.

    Raises
    ------
    InputError
        As `solving_tasks`, or if there is no instance.
    """
    contenders = [solving_contender(task) for task in solving_tasks(**options)]
    if not instances:
        raise InputError("no instance; give at least one", field="compare")
    missions = [Mission.of(require_mission(instance)) for instance in instances]
    return combined(missions, contenders, Timing())


def compare(
    todo: Sequence[Run], *, jobs: int = 1, memory_limit: float | None = None
) -> Generator[Record, None, None]:
    """Solve each of `todo` by itself; records come as they are finished.

    Closing the iterator ends what is still being solved.

    Parameters
    ----------
    todo : sequence of Run
        From `cases`.
    jobs : int
        How many at a time; more than one makes times less comparable.
    memory_limit : float, optional
        MiB of memory per solve.
    """
    limits = [run.task.time_limit for run in todo if isinstance(run.task, Solving)]
    given = [limit for limit in limits if limit is not None]
    deadline = max(given) + GRACE_SECONDS if given else None
    return records(todo, Limits(deadline, memory_limit), locally(jobs))


def solve_here(run: Run) -> Record:
    """Solve one of `cases` in this process: quicker, but nothing stops it or survives its crash."""
    (record,) = records([run], Limits(), here)
    return record


def in_order(todo: Sequence[Run], finished: Sequence[Record]) -> list[Record]:
    """The records of `todo` in its order."""
    place = {run.key: i for i, run in enumerate(todo)}
    return sorted(finished, key=lambda record: place[record.key])


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
) -> Comparison:
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
    Comparison
        A pandas table: one row a solve, in the order of `cases`, one column per entry of
        `solves.COLUMNS`.

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
    from .comparison_table import Comparison

    finished = compare(todo, jobs=jobs, memory_limit=memory_limit)
    return Comparison.of(in_order(todo, list(finished)))
