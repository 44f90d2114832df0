"""Solver regression in one call: solve again what a baseline holds, and say what changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..mission import display
from ..mission.errors import InputError
from ..mission.instance import Instance
from .analysis.agreement import disagreements
from .analysis.regression import Regression, read_baseline, regression, save_baseline
from .comparison import cases, compare, in_order
from .missions import read_instances
from .record import Record


@dataclass(frozen=True)
class Verdict:
    """What solving again came to."""

    records: tuple[Record, ...]
    regression: Regression | None
    """Against the baseline; ``None`` where there was none."""
    wrong: tuple[str, ...]
    """Contradictions between solves, failed checks, and errors: nothing to keep as a baseline."""
    written: bool = False
    """Whether the baseline was written."""

    @property
    def lines(self) -> list[str]:
        """All that is wrong or changed, a line each."""
        return [*self.wrong, *(self.regression.lines if self.regression else [])]

    def __repr__(self) -> str:
        return f"Verdict({self._summary})"

    def _repr_html_(self) -> str:
        notes = self.regression.information if self.regression else []
        return display.page(
            self._summary,
            display.table("Wrong or changed", [{"what": line} for line in self.lines]),
            display.table("For information", [{"what": line} for line in notes]),
        )

    @property
    def _summary(self) -> str:
        solves = display.counted(len(self.records), "solve")
        told = display.counted(len(self.lines), "line") if self.lines else "nothing"
        kept = ", baseline written" if self.written else ""
        return f"{solves}: {told} wrong or changed{kept}"


def against_baseline(
    path: str | Path,
    instances: Sequence[Instance | str | Path],
    *,
    update: bool = False,
    slower: float | None = None,
    jobs: int = 1,
    memory_limit: float | None = None,
    time_limit: float | None = 60.0,
    models: Sequence[str] = (),
    solvers: Sequence[str] = (),
    **options: Any,
) -> Verdict:
    """Compare formulations and solvers, and hold what comes of it against a baseline file.

    Parameters
    ----------
    path : path
        The baseline. It is written if there is none and `update` is given.
    instances : sequence of Instance, path or str
        Missions, their files, or names of shipped ones.
    update : bool
        Write the baseline again, unless solves contradict each other or fail their checks. Rows in which
        nothing changed stay as they are.
    slower : float, optional
        A total time beyond this ratio of that before is a change.
    jobs, memory_limit, time_limit
        As for `comparison`.
    models, solvers : sequence of str
        As for `comparison`.
    **options
        Further ones of `cases`: ``stage``, ``seeds``, ``options``, ``gap``, ``structure``,
        ``parameters``.

    Raises
    ------
    InputError
        If there is no baseline and `update` is not given, or what is asked for is wrong.
    """
    file = Path(path)
    if not update and not file.exists():
        raise InputError("no baseline yet; write it with update=True", file=file)
    before = read_baseline(file) if file.exists() else None
    given = [item for item in instances if isinstance(item, Instance)]
    named = read_instances([item for item in instances if not isinstance(item, Instance)])
    todo = cases(
        [*given, *named], models=models, solver_names=solvers, time_limit=time_limit,
        **{"stage": "cluster", **options},
    )  # fmt: skip
    records = in_order(todo, list(compare(todo, jobs=jobs, memory_limit=memory_limit)))
    found = None if before is None else regression(before, records, slower=slower)
    wrong = faults(records)
    written = update and not wrong
    if written:
        save_baseline(records, file, before=before or ())
    return Verdict(tuple(records), found, tuple(wrong), written)


def faults(records: Sequence[Record]) -> list[str]:
    """What no baseline should hold: contradictions, failed checks and errors, a line each."""
    failed = [
        f"{row.model} on {row.instance} by {row.solver}: check: {row.check}"
        for row in records
        if row.check not in (None, "", "passed")
    ]
    silent = [
        f"{row.model} on {row.instance} by {row.solver}: {row.reason or 'no solution'}"
        for row in records
        if row.verdict == "error"
    ]
    return [*disagreements(records), *failed, *silent]
