"""What proves a root bound, in words that outlive the program: rows by what they are about.

The prices of `bound.Bound`, by the ids of robots and victims, without those that are 0; see
`mission.proof`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from ...arrays import Bools
from ...mission.instance import Instance
from ...mission.proof import RootProof
from ..bound import Bound
from ..objective_step import objective_step
from .edge_formulation import Columns, decisive
from .separation import Cut

_DIGITS = 12
"""Significant digits of a price: any prices prove a bound, these the same one to that precision."""


def root_proof(instance: Instance, bound: Bound, worth: float) -> RootProof | None:
    """The proof of the root bound, none if no relaxation was solved.

    Parameters
    ----------
    instance : Instance
        With the known victims, in the order of the columns' data.
    bound : Bound
        With its root relaxation.
    worth : float
        Value of the routes found: no bound is above it.
    """
    columns, prices, root = bound.columns, bound.prices, bound.root()
    if columns is None or prices is None or root is None or not np.isfinite(root):
        return None
    fields: dict[str, list[dict[str, Any]]] = {}
    n_first = columns.rows[0].shape[0]
    for (name, about), price in zip(_first_rows(instance, columns), prices[:n_first], strict=True):
        _note(fields, name, about, price)
    for cut, price in zip(bound.cuts, prices[n_first:], strict=True):
        name, about = _cut(instance, cut)
        _note(fields, name, about, price)
    grain = objective_step(columns.data, columns.objective)
    return RootProof.model_validate(
        {
            "objective": columns.objective.name,
            "bound": min(grain.up(root), worth),
            "solver": f"highs {version('highspy')}",
            **fields,
        }
    )


def _note(
    fields: dict[str, list[dict[str, Any]]], name: str, about: dict[str, Any], price: float
) -> None:
    if price:
        fields.setdefault(name, []).append({**about, "price": float(f"{price:.{_DIGITS}g}")})


def _first_rows(instance: Instance, columns: Columns) -> Iterator[tuple[str, dict[str, Any]]]:
    """Name of each row of `Columns.rows`, and what it is about, in the same order."""
    data = columns.data
    robots, victims = [r.id for r in instance.robots], [v.id for v in instance.victims]
    kinds = instance.capabilities
    for r, v in columns.pairs:
        yield "degree", {"robot": robots[r], "victim": victims[v]}
    for name in ("leaves", "ends"):
        for robot in robots:
            yield name, {"robot": robot}
    loads = bool(len(columns.services))
    for v, k in np.argwhere(data.required) if loads else decisive(data):
        yield "served", {"victim": victims[v], "kind": kinds[k]}
    for pair, k in columns.services:
        r, v = columns.pairs[pair]
        yield "present", {"robot": robots[r], "victim": victims[v], "kind": kinds[k]}
    yield from _of_robots("endurance", robots, np.isfinite(data.endurance))
    yield from _of_robots("walk", robots, np.isfinite(data.longest_walk))
    if columns.objective.only_last:
        yield from _of_robots("makespan", robots, np.ones(data.n_robots, dtype=bool))


def _of_robots(
    name: str, robots: Sequence[int], chosen: Bools
) -> Iterator[tuple[str, dict[str, Any]]]:
    for robot, is_chosen in zip(robots, chosen, strict=True):
        if is_chosen:
            yield name, {"robot": robot}


def _cut(instance: Instance, cut: Cut) -> tuple[str, dict[str, Any]]:
    about: dict[str, Any] = {
        "robot": instance.robots[cut.robot].id,
        "victims": [instance.victims[v].id for v in cut.members],
    }
    if cut.vertex is None:
        return ("first" if cut.first else "last"), about
    about["victim"] = instance.victims[cut.vertex].id
    return ("outside" if cut.first else "subtour"), about
