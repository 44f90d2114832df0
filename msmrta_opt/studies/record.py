"""The one type of record: what was asked of a run, what came of it, on what machine."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, get_args, get_type_hints

from ..mission.errors import InputError, shown
from ..mission.files import parse_json
from ..mission.metrics import METRICS

if TYPE_CHECKING:
    import pandas as pd

FINISHED, SKIPPED = "finished", "skipped"
"""The outcomes of a run that gave a result, and of one whose solver cannot do what was asked."""


@dataclass(frozen=True, kw_only=True)
class Record:
    """One run, whether of a study or of a comparison.

    Distances are in cells, mission times in time units, ``seconds…`` in seconds of wall time and
    ``peak_memory`` in MiB. What does not apply is ``None``. Fields that end in ``_json`` hold a JSON
    document.
    """

    key: str = ""
    """Digest of all that determines the result, versions included."""
    run: str = ""
    """The same without versions: equal for the same run done again elsewhere."""
    instance: str
    map: str = ""
    n_robots: int = 0
    n_victims: int = 0
    contender: str = ""
    """Who was run, in the study's own words; records of one contender are compared over instances."""
    method: str = "formulation"
    """``planner``, ``formulation``, or ``execution`` of a planner's plan by a policy."""
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
    """``finished``, or why not: ``skipped``, ``raised``, ``crashed``, ``timed out``, …"""
    error: str = ""
    limit: float | None = None
    """Seconds or MiB that a run hit, where it was killed for it."""
    status: str | None = None
    """Of the program solved, or of the exact planner's: ``optimal``, ``feasible``, …"""
    sense: str | None = None
    """``min`` or ``max``."""
    objective: float | None = None
    bound: float | None = None
    objective_size: float | None = None
    """What differences of these are relative to: the objective's value without its constant."""
    gap: float | None = None
    proof: str | None = None
    check: str | None = None
    nodes: int | None = None
    n_variables: int | None = None
    n_rows: int | None = None
    solver_version: str | None = None

    scenario: str = ""
    """Under which a plan was executed."""
    policy: str | None = None
    executions_json: str = "{}"
    """What came of each seed: ``seeds`` and, by metric of runs, a list with a value for each."""

    metrics_json: str = "{}"
    """The metrics of a plan by name, or means over runs; a table has a column for each."""
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

    @property
    def metrics(self) -> dict[str, float]:
        """The metrics of the plan, by name; none where there is no plan."""
        found: dict[str, float] = json.loads(self.metrics_json)
        return found

    @property
    def executions(self) -> dict[str, list[float]]:
        """`executions_json`, read."""
        found: dict[str, list[float]] = json.loads(self.executions_json)
        return found

    @property
    def stage_seconds(self) -> dict[str, float | None]:
        """`stage_seconds_json`, read."""
        found: dict[str, float | None] = json.loads(self.stage_seconds_json)
        return found

    @property
    def reason(self) -> str:
        """Why there is no result, or what a solver said."""
        told = self.outcome in (FINISHED, SKIPPED, "raised")
        return self.error if told else f"{self.outcome}: {self.error}"

    @property
    def solver_seed(self) -> int | None:
        """The seed that a solver was given."""
        found: int | None = json.loads(self.options_json).get("solver_seed")
        return found

    @property
    def solve(self) -> tuple[str, str | None, str | None, int | None]:
        """What identifies a solve: instance, model, solver, and the solver's seed."""
        return self.instance, self.model, self.solver, self.solver_seed

    @property
    def verdict(self) -> str:
        """The status of a solve; ``skipped`` or ``error`` of one without a result."""
        if self.outcome == FINISHED:
            return self.status or ""
        return SKIPPED if self.outcome == SKIPPED else "error"


MEASURED = (
    *("seconds", "seconds_low", "seconds_high", "seconds_json", "stage_seconds_json"),
    *("peak_memory", "machine", "finished_at"),
)
"""Fields in which two runs of the same key may differ."""
_RIGHT = {str: "a text", int: "a whole number", float: "a number", type(None): "nothing"}


@cache
def kinds_of_fields() -> Mapping[str, tuple[type, ...]]:
    """The types that each field of `Record` may have."""
    hints = get_type_hints(Record)
    return {item.name: get_args(hints[item.name]) or (hints[item.name],) for item in fields(Record)}


def record_of(values: Mapping[str, Any]) -> Record:
    """The record with these values, read from a file.

    Parameters
    ----------
    values : mapping
        By field; a number that is no field is a metric.

    Raises
    ------
    InputError
        Naming the field, the offending value and what would be right.
    """
    kinds = kinds_of_fields()
    if "instance" not in values:
        raise InputError("is missing; give it, for it has no default", field="instance")
    known = {name: value for name, value in values.items() if name in kinds}
    for name, value in known.items():
        allowed = kinds[name]
        if type(value) not in allowed and not (type(value) is int and float in allowed):
            right = " or ".join(_RIGHT[kind] for kind in allowed)
            raise InputError(f"{shown(value)}; give {right}", field=name)
        if name.endswith("_json"):
            _check_document(name, value)
    others = {name: x for name, x in values.items() if name not in kinds}
    more = {name: x for name, x in others.items() if isinstance(x, (int, float))}
    record = Record(**known)
    if not more:
        return record
    merged = json.dumps({**more, **record.metrics})
    return Record(**{**known, "metrics_json": merged})


def _check_document(name: str, text: str) -> None:
    kind, right = (list, "a list") if name == "seconds_json" else (dict, "an object")
    try:
        document = parse_json(text)
    except InputError as error:
        raise InputError(error.problem, field=name) from None
    if not isinstance(document, kind):
        raise InputError(f"{shown(document)}; give {right} as JSON", field=name)


def frame(records: Sequence[Record]) -> pd.DataFrame:
    """The records as a pandas table: a column per field of `Record`, and one per metric."""
    import pandas as pd

    columns = [item.name for item in fields(Record)]
    place = columns.index("metrics_json")
    columns[place : place + 1] = _metrics_in(records)
    rows = [{**asdict(record), **record.metrics} for record in records]
    return pd.DataFrame(rows, columns=columns)


def _metrics_in(records: Iterable[Record]) -> list[str]:
    """All metrics there are, and those of another version that a record has."""
    found = dict.fromkeys(METRICS)
    for record in records:
        found |= dict.fromkeys(record.metrics)
    return list(found)
