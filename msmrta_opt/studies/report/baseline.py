"""Contenders measured against the baseline: planning time saved, and the quality of the plans.

Planning time saved is read as the paper's "MSMRTA reduces planning times by 97.70 %, …" is: over the
grid of robots × victims of a map, 100 · (1 − mean of the contender's / mean of the baseline's).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from .blocks import Table
from .runs import CELL, INSTANCE, METHODS, contenders, per_instance, varying

ALL_MAPS = "all maps"
SAVED = "saved (%)"
PUBLISHED = "published (%)"


def savings(
    runs: pd.DataFrame, baseline: str, published: Mapping[str, float] | None = None
) -> pd.DataFrame:
    """Planning time saved against `baseline`, by map and contender.

    Parameters
    ----------
    runs : DataFrame
        As of `table_of`.
    baseline : str
        A contender.
    published : mapping of str to float
        Percent saved as published, by map.

    Returns
    -------
    DataFrame
        A row for each map and contender that have something in common with the baseline, and for
        all maps together if there are several: cells, mean seconds of both, ``saved (%)`` of the
        means, the published percentage, and median and quartiles of what is saved instance by
        instance. Only instances that both finished count; a cell is the mean over its instances.
    """
    published = published or {}
    seconds = per_instance(runs, "seconds")
    # Below what the clock tells, nothing can be said to be saved.
    seconds = seconds.where(seconds > 0)
    if baseline not in seconds:
        return pd.DataFrame()
    rows = []
    for name, here in _by_map(seconds):
        for contender in contenders(runs):
            both = here[[baseline, contender]].dropna() if contender != baseline else None
            if both is None or both.empty:
                continue
            cells = both.groupby(level=CELL, sort=False).mean()
            each = 100 * (1 - both[contender] / both[baseline])
            low, middle, high = each.quantile([0.25, 0.5, 0.75])
            mean, base = cells[contender].mean(), cells[baseline].mean()
            rows.append(
                {
                    "map": name,
                    "contender": contender,
                    "cells": len(cells),
                    "mean (s)": mean,
                    "baseline's mean (s)": base,
                    SAVED: 100 * (1 - mean / base),
                    PUBLISHED: published.get(name, np.nan),
                    "median of instances (%)": middle,
                    "lower quartile (%)": low,
                    "upper quartile (%)": high,
                }
            )
    return pd.DataFrame(rows).dropna(axis="columns", how="all")


def savings_table(
    runs: pd.DataFrame, method: str, baseline: str, published: Mapping[str, float], source: str
) -> Table:
    """`savings`, with what is said of them."""
    data = savings(runs, baseline, published)
    told = f" Published: {source}." if source and PUBLISHED in data else ""
    if PUBLISHED in data:
        told += " The published figure of a map stands beside every contender."
    return Table(
        f"saved-{METHODS[method].split()[0]}-time", f"{METHODS[method].capitalize()} saved", data,
        f"Against {baseline}. Saved: 100 · (1 − mean of the contender's time / mean of the"
        " baseline's), both means over the cells of the grid of robots × victims, the reading of"
        " the paper's percentages. Beside it the median and the quartiles of what is saved on"
        " each instance, which no single slow instance sways. Only instances that both finished"
        f" count.{told}",
        {SAVED: "more", "median of instances (%)": "more"},
        "map",
    )  # fmt: skip


def ratios(runs: pd.DataFrame, baseline: str) -> pd.DataFrame:
    """Mean ratios of the metrics of plans to the baseline's, by map and contender.

    Instances count that both finished and where the baseline's value is not zero.
    """
    tables = {m.label: per_instance(runs, m.name) for m in varying(runs)}
    if any(baseline not in wide for wide in tables.values()):
        return pd.DataFrame()
    found: dict[tuple[str, str], dict[str, float]] = {}
    for label, wide in tables.items():
        for name, here in _by_map(wide):
            base = here[baseline].replace(0, np.nan)
            means = here.drop(columns=baseline).div(base, axis="index")
            for contender, mean in means.mean().items():
                entry = found.setdefault((name, contender), {})
                both = int(here[[contender, baseline]].notna().all(axis="columns").sum())
                entry["instances"] = max(both, entry.get("instances", 0))
                entry[label] = mean
    rows = [
        {"map": name, "contender": contender} | values
        for (name, contender), values in found.items()
        if values["instances"]
    ]
    return pd.DataFrame(rows).dropna(axis="columns", how="all")


def ratios_table(runs: pd.DataFrame, baseline: str) -> Table:
    """`ratios`, with what is said of them."""
    more = ", ".join(f"the {m.label}" for m in varying(runs) if m.better == "more")
    better = f"More is better of {more}, less of all others" if more else "Less is better"
    return Table(
        "quality-against-the-baseline", "Quality of the plans", ratios(runs, baseline),
        f"Mean over instances of the contender's value / that of {baseline}; 1 is equal."
        f" {better}. Only instances that both finished"
        " count, and of them those where the baseline's value is not zero.",
        {m.label: m.better for m in varying(runs)},
        "map",
    )  # fmt: skip


def _by_map(wide: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """The rows of each map, and all together if there are several."""
    maps = list(wide.groupby(level=INSTANCE[0], sort=False))
    return maps + ([(ALL_MAPS, wide)] if len(maps) > 1 else [])
