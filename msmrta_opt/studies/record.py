"""What is kept of one run of a study: what was asked, what came of it, on what machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

FINISHED = "finished"
"""The outcome of a run that gave a result; every other outcome is a failure's reason."""


@dataclass(frozen=True)
class Record:
    """One run: a row of the ledger and of the exported table.

    Distances are in cells, mission times in time units, ``seconds…`` in seconds of wall time and
    ``peak_memory`` in MiB. What does not apply is ``None``. Columns that end in ``_json`` hold a
    JSON document.
    """

    key: str
    """Digest of all that determines the result, versions included."""
    run: str
    """The same without versions: equal for the same run done again elsewhere."""
    instance: str
    map: str
    n_robots: int
    n_victims: int
    contender: str
    """Who was run, in the study's own words; rows of one contender are compared over instances."""
    method: str
    """``planner`` or ``formulation``."""
    planner: str | None = None
    stage: str | None = None
    model: str | None = None
    solver: str | None = None
    psi: float | None = None
    beta: float | None = None
    seed: int | None = None
    options_json: str = "{}"
    repetitions: int = 1
    warm_up: int = 0

    outcome: str = FINISHED
    """``finished``, or why not: ``raised``, ``crashed``, ``timed out``, ``out of memory``."""
    error: str = ""
    limit: float | None = None
    """Seconds or MiB that a run hit, where it was killed for it."""
    status: str | None = None
    """Of the program solved, or of the exact planner's: ``optimal``, ``feasible``, …"""
    objective: float | None = None
    bound: float | None = None
    gap: float | None = None
    proof: str | None = None
    check: str | None = None
    nodes: int | None = None
    n_variables: int | None = None
    n_rows: int | None = None

    n_requirements: int | None = None
    n_available: int | None = None
    n_served: int | None = None
    served_share: float | None = None
    victims_fully_served: int | None = None
    distance: int | None = None
    total_time: float | None = None
    makespan: float | None = None
    latency: float | None = None
    mean_completion: float | None = None
    weighted_completion: float | None = None
    plan_digest: str | None = None
    """Of the plan without its planning times: equal for equal plans."""

    seconds: float | None = None
    """Planning time, or that from a stage's data to a checked solution; median of repetitions."""
    seconds_low: float | None = None
    seconds_high: float | None = None
    seconds_json: str = "[]"
    """Of every repetition, in order."""
    stage_seconds_json: str = "{}"
    """Planning time per stage, of the median repetition."""
    peak_memory: float | None = None
    versions_json: str = "{}"
    machine: str = ""
    finished_at: str = ""
    """Coordinated universal time, ISO 8601."""

    @property
    def failed(self) -> bool:
        """Whether the run gave no result."""
        return self.outcome != FINISHED


MEASURED = (
    *("seconds", "seconds_low", "seconds_high", "seconds_json", "stage_seconds_json"),
    *("peak_memory", "machine", "finished_at"),
)
"""Columns in which two runs of the same key may differ."""


def frame(records: Sequence[Record]) -> pd.DataFrame:
    """The records as a pandas table, one column per field of `Record`."""
    import pandas as pd

    return pd.DataFrame([asdict(r) for r in records], columns=[f.name for f in fields(Record)])
