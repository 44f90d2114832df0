"""Solvers convicted: one claim of each program is proved, and the others are held against the proof."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..mission.errors import MsmrtaError
from ..optimise import registry
from ..optimise.solve import solve
from ..proofs.prove import Claimed, Proof, contradiction, prove
from ..stages.data import stage_data
from .record import Record
from .runs import Run
from .tasks import Solving


@dataclass(frozen=True)
class Verdict:
    """What is proved of a program, and whose claims that contradicts."""

    instance: str
    model: str
    proof: Proof | None
    """``None`` if the program could not be built or solved."""
    reason: str = ""
    """Why there is no proof."""
    contradicted: tuple[tuple[Record, str], ...] = ()
    """Records, and in what each is wrong."""


def verdicts(
    todo: Sequence[Run], records: Sequence[Record], *, time_limit: float
) -> Iterator[Verdict]:
    """Prove the optimum of each program of `todo` once, and hold the `records` against it.

    Parameters
    ----------
    todo : sequence of Run
        From `comparison.cases`.
    records : sequence of Record
        What became of them.
    time_limit : float
        Seconds for each proof.
    """
    programs: dict[tuple[str, str], tuple[Run, Solving]] = {}
    for run in todo:
        if isinstance(run.task, Solving):
            programs.setdefault((run.instance.name, run.task.model), (run, run.task))
    for (instance, model), (run, task) in programs.items():
        claims = [row for row in records if (row.instance, row.model) == (instance, model)]
        try:
            proof = _proof(run, task, time_limit)
        except MsmrtaError as error:
            yield Verdict(instance, model, None, str(error))
            continue
        found = ((row, contradiction(Claimed(row.verdict, row.objective), proof)) for row in claims)
        wrong = tuple((row, what) for row, what in found if what)
        yield Verdict(instance, model, proof, proof.remark, wrong)


def _proof(run: Run, task: Solving, time_limit: float) -> Proof:
    formulation = registry.get(task.model, stage=task.stage)
    data = stage_data(run.instance, task.stage, task.options)
    values = task.values_for(formulation)
    solution = solve(formulation, data, time_limit=task.time_limit, **values)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "proof.vipr"
        return prove(
            formulation, data, path=path, solution=solution, time_limit=time_limit, **values
        )
