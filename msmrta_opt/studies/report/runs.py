"""The records of a study as one table, and what in it can be compared.

A contender may have run several times on one instance, with other seeds: such runs count as one, by
their mean, and the instance counts as finished by the contender if all of them count.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...mission.metrics import Metric, metrics_of
from ..record import FINISHED, Record, frame, kinds_of_fields

if TYPE_CHECKING:
    import pandas as pd

METHODS = {"planner": "planning time", "formulation": "solving time"}
"""The two kinds of contender, and what their seconds are."""
NUMBERS = frozenset(name for name, kinds in kinds_of_fields().items() if {int, float} & {*kinds})
"""Fields of a record that hold numbers."""
INSTANCE = ["map", "instance", "n_robots", "n_victims"]
CELL = ["map", "n_robots", "n_victims"]


def table_of(records: Sequence[Record]) -> pd.DataFrame:
    """One row a run, with the columns of `Record`; what is missing is NaN.

    Two columns more: ``finished``, and ``counts``, whether the run counts where contenders are
    compared: a plan that was made, or a program that was solved to optimality.
    """
    import pandas as pd

    runs = frame(records)
    texts = kinds_of_fields().keys() - NUMBERS
    for name in runs.columns.difference(texts):
        runs[name] = pd.to_numeric(runs[name])
    runs["finished"] = runs["outcome"] == FINISHED
    runs["counts"] = runs["finished"] & (
        (runs["method"] != "formulation") | (runs["status"] == "optimal")
    )
    return runs


def contenders(runs: pd.DataFrame) -> list[str]:
    """All contenders, in the order in which they appear."""
    return list(dict.fromkeys(runs["contender"]))


def of_method(runs: pd.DataFrame, method: str) -> pd.DataFrame:
    """The runs of planners, or those of formulations."""
    return runs[runs["method"] == method]


def per_instance(runs: pd.DataFrame, value: str) -> pd.DataFrame:
    """`value` by instance (rows) and contender (columns); NaN where not all of its runs count.

    Parameters
    ----------
    runs : DataFrame
        As of `table_of`.
    value : str
        A column of numbers.

    Returns
    -------
    DataFrame
        Indexed by map, instance, number of robots and of victims, in the order of appearance.
    """
    keys = [*INSTANCE, "contender"]
    groups = runs.groupby(keys, sort=False)
    values = groups[value].mean().where(groups["counts"].all())
    wide = values.unstack("contender")  # noqa: PD010 - one value each, as grouped
    instances = runs[INSTANCE].drop_duplicates()
    import pandas as pd

    return wide.reindex(index=pd.MultiIndex.from_frame(instances), columns=contenders(runs))


def common_instances(runs: pd.DataFrame) -> set[str]:
    """The instances that every contender finished, of those who finished any."""
    times = per_instance(runs, "counts")
    times = times.dropna(axis="columns", how="all")
    if times.empty:
        return set()
    return set(times.dropna().index.get_level_values("instance"))


def constants(runs: pd.DataFrame) -> dict[str, float]:
    """The metrics of plans that are the same in every run that counts, of two or more."""
    known = runs[runs["counts"]]
    found = {}
    for metric in metrics_of("report"):
        values = known[metric.name]
        if len(values) > 1 and (values == values.iloc[0]).all():
            found[metric.name] = float(values.iloc[0])
    return found


def varying(runs: pd.DataFrame) -> list[Metric[Any]]:
    """The metrics that a report shows in tables and pictures: those that are not `constants`."""
    same = constants(runs)
    return [metric for metric in metrics_of("report") if metric.name not in same]


def failures(runs: pd.DataFrame) -> pd.DataFrame:
    """The runs that gave no result, those that were skipped for want of a solver among them."""
    return runs[~runs["finished"]]
