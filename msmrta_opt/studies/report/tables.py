"""The tables of a report: what was run on what, what came of it, and what failed."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import pandas as pd

from ...mission.metrics import METRICS
from ..analysis.times import SHIFT_SECONDS, shifted_geometric_mean
from .blocks import Table, Words
from .runs import METHODS, common_instances, constants, contenders, failures, varying

if TYPE_CHECKING:
    from collections.abc import Sequence

STATUSES = (
    *("optimal", "claimed", "feasible", "no_solution", "infeasible", "unbounded"),
    *("contradicted", "error"),
)
MAX_NAMED = 3
"""Instances of a failure that are named; the rest is in the table of all runs."""


def contender_table(runs: pd.DataFrame) -> Table:
    """Who was run, and with what."""
    rows = []
    for contender, mine in _by_contender(runs):
        first = mine.iloc[0]
        if first["method"] == "planner":
            what = f"planner {first['planner']}"
        elif first["method"] == "execution":
            what = f"planner {first['planner']}, policy {first['policy']}"
        else:
            what = f"{first['stage']}: {first['model']} by {first['solver']}"
        rows.append(
            {
                "contender": contender,
                "what": what,
                "options": _options(mine["options_json"]),
                "runs": len(mine),
                "instances": mine["instance"].nunique(),
            }
        )
    return Table(
        "contenders", "Contenders", pd.DataFrame(rows),
        "Options are those given; of all others the default was taken.",
    )  # fmt: skip


def instance_table(runs: pd.DataFrame) -> Table:
    """What it was run on, map by map."""
    instances = runs.groupby("instance", sort=False)
    first = instances[["map", "n_robots", "n_victims", "n_requirements", "n_available"]].max()
    rows = [
        {
            "map": name or "without a name",
            "instances": len(group),
            "robots": _span(group["n_robots"]),
            "victims": _span(group["n_victims"]),
            "requirements": _span(group["n_requirements"]),
            "of them available": _span(group["n_available"]),
        }
        for name, group in first.groupby("map", sort=False)
    ]
    return Table(
        "instances", "Instances", _without_empty(pd.DataFrame(rows).replace("", None)),
        "Counts of one instance, the smallest to the largest. A requirement is available when some robot"
        " that can reach the victim has it.",
    )  # fmt: skip


def counts_table(runs: pd.DataFrame) -> Table:
    """How many runs of each contender came to what."""
    outcomes = [name for name in dict.fromkeys(runs["outcome"]) if name != "finished"]
    rows = []
    for contender, mine in _by_contender(runs):
        counts = mine["outcome"].value_counts()
        row = {"contender": contender, "runs": len(mine), "finished": int(mine["finished"].sum())}
        rows.append(row | {name: int(counts.get(name, 0)) for name in outcomes})
    return Table("run-counts", "Runs", pd.DataFrame(rows))


def timing_table(runs: pd.DataFrame, method: str) -> Table:
    """Medians and spread of the seconds of each contender, over the instances common to all."""
    common = common_instances(runs)
    rows = []
    for contender, mine in _by_contender(_on(runs, common)):
        seconds = mine["seconds"].dropna()
        low, middle, high = seconds.quantile([0.25, 0.5, 0.75])
        repeated = mine[mine["repetitions"] > 1]
        spread = (repeated["seconds_high"] - repeated["seconds_low"]) / repeated["seconds"]
        rows.append(
            {
                "contender": contender,
                "runs": len(mine),
                "median (s)": middle,
                "lower quartile (s)": low,
                "upper quartile (s)": high,
                "lowest (s)": mine["seconds_low"].fillna(mine["seconds"]).min(),
                "highest (s)": mine["seconds_high"].fillna(mine["seconds"]).max(),
                "spread of repetitions (%)": 100 * spread.median(),
                "peak memory (MiB)": mine["peak_memory"].median(),
            }
        )
    return Table(
        f"{METHODS[method].replace(' ', '-')}s", METHODS[method].capitalize(),
        _without_empty(pd.DataFrame(rows)),
        f"{_common(runs, common)} A run's time is the median of its repetitions; lowest and highest"
        " are over all repetitions; their spread is (highest − lowest) / median of a run, of which"
        " the median run is given.",
        {"median (s)": "less", "highest (s)": "less", "peak memory (MiB)": "less"},
    )  # fmt: skip


def quality_table(runs: pd.DataFrame) -> Table:
    """Means of the metrics of each planner's plans, over the instances common to all."""
    common, metrics = common_instances(runs), varying(runs)
    rows = []
    for contender, mine in _by_contender(_on(runs, common)):
        row = {"contender": contender, "instances": mine["instance"].nunique()}
        # Instance by instance first: another seed more must not weigh an instance more.
        means = mine.groupby("instance", sort=False)[[m.name for m in metrics]].mean().mean()
        rows.append(row | {m.title: m.scaled(means[m.name]) for m in metrics})
    return Table(
        "plan-metrics", "Plans", _without_empty(pd.DataFrame(rows)),
        f"{_common(runs, common)} Means over instances.",
        {m.title: m.better for m in metrics},
    )  # fmt: skip


def same_everywhere(runs: pd.DataFrame) -> Words | None:
    """The metrics of plans that are the same in every run, in a sentence; `None` if all vary."""
    found = constants(runs)
    if not found:
        return None
    said = ", ".join(
        f"{METRICS[name].label} {METRICS[name].scaled(value):.6g} {METRICS[name].unit}".strip()
        for name, value in found.items()
    )
    return Words(f"The same in every run: {said}.")


def solving_table(runs: pd.DataFrame) -> Table:
    """What came of each formulation by each solver: statuses, shifted geometric mean, gaps."""
    rows = []
    for contender, mine in _by_contender(runs):
        counts = mine.loc[mine["finished"], "status"].value_counts()
        stopped = mine[mine["finished"] & (mine["status"] == "feasible")]
        solved = mine[mine["counts"] & mine["seconds"].notna()]
        rows.append(
            {
                "formulation and solver": contender,
                "runs": len(mine),
                **{s.replace("_", " "): int(counts.get(s, 0)) for s in STATUSES},
                "without result": int((~mine["finished"]).sum()),
                "shifted geometric mean (s)": shifted_geometric_mean(solved["seconds"]),
                "mean gap where stopped early (%)": 100 * stopped["gap"].mean(),
                "median nodes": mine["nodes"].median(),
                "variables": _span(mine["n_variables"]),
                "rows": _span(mine["n_rows"]),
            }
        )
    data = pd.DataFrame(rows)
    unused = [s.replace("_", " ") for s in STATUSES if s != "optimal"]
    data = data.drop(columns=[name for name in unused if not data[name].any()])
    return Table(
        "formulations", "Formulations and solvers", _without_empty(data),
        "Times are from a stage's data to a checked solution, over the runs solved to optimality;"
        f" the mean is exp(mean log(t + {SHIFT_SECONDS:g} s)) − {SHIFT_SECONDS:g} s.",
        {"optimal": "more"},
    )  # fmt: skip


def failure_table(runs: pd.DataFrame) -> Table:
    """Why runs gave no result, one row for each contender and error."""
    failed = failures(runs)
    rows = []
    groups = failed.groupby(["contender", "outcome", "error"], sort=False)
    for (contender, outcome, error), group in groups:
        names = list(dict.fromkeys(group["instance"]))
        more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
        rows.append(
            {
                "contender": contender,
                "outcome": outcome,
                "error": error,
                "runs": len(group),
                "instances": ", ".join(names[:MAX_NAMED]) + more,
            }
        )
    return Table("errors", "Why", pd.DataFrame(rows))


def _by_contender(runs: pd.DataFrame) -> Iterable[tuple[str, pd.DataFrame]]:
    groups: Iterable[tuple[str, pd.DataFrame]] = runs.groupby("contender", sort=False)
    return groups


def _on(runs: pd.DataFrame, instances: set[str]) -> pd.DataFrame:
    """The runs on `instances`, of the contenders that finished any."""
    return runs[runs["instance"].isin(instances) & runs["counts"]]


def _common(runs: pd.DataFrame, common: set[str]) -> str:
    """What a note says of the instances that a table is over."""
    finished = set(runs.loc[runs["counts"], "contender"])
    idle = [name for name in contenders(runs) if name not in finished]
    left = f" {', '.join(idle)} finished none and is left out." if idle else ""
    return (
        f"Over the {len(common)} of {runs['instance'].nunique()} instances that all contenders"
        f" finished, so that the figures can be compared.{left}"
    )


def _without_empty(data: pd.DataFrame) -> pd.DataFrame:
    """`data` without the columns of which nothing is known."""
    return data.dropna(axis="columns", how="all")


def _span(values: pd.Series) -> str:
    known = values.dropna()
    if known.empty:
        return ""
    low, high = known.min(), known.max()
    return f"{low:,.0f}" if low == high else f"{low:,.0f} to {high:,.0f}"


def _options(documents: Sequence[str]) -> str:
    """The options of a contender's runs; of one that varies, all values."""
    found: dict[str, list[Any]] = {}
    for text in dict.fromkeys(documents):
        for name, value in json.loads(text).items():
            values = found.setdefault(name, [])
            if value is not None and value not in values:
                values.append(value)
    return "; ".join(
        f"{name} = {', '.join(map(_option, values))}" for name, values in found.items() if values
    )


def _option(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
