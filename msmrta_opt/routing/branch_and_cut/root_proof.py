"""What proves a root bound, in words that outlive the program: rows by what they are about.

Dual values by the ids of robots and victims, without those that are 0; see `mission.proof`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...arrays import Bools, Floats
from ...mission.instance import Instance
from ...mission.proof import RootProof
from ...optimise.check import dual_bound
from ...optimise.program import Program
from ..objective_step import objective_step
from ..run_highs import highs_version
from .edge_formulation import EdgeFormulation, decisive
from .separation import Cut

_DIGITS = 12
"""Significant digits of a dual value: any prove a bound, these the same one to that precision."""
_OF_TIME = ("walk", "endurance", "makespan")
"""Rows in time units, so that their dual values have no unit; the others have the objective's."""


@dataclass(frozen=True, eq=False)
class RootRelaxation:
    """The root relaxation, whole.

    Whoever solves `program` with any solver, or multiplies it with `dual_values` by hand (`bound`),
    sees what it proves. What branching adds to that rests on the tree; what rounding adds, on the
    objective's step.
    """

    formulation: EdgeFormulation
    cuts: tuple[Cut, ...]
    dual_values: Floats
    """Of the formulation's rows, then of `cuts`, ``(n_rows,)``."""

    @cached_property
    def program(self) -> Program:
        """The linear program with its cuts."""
        return self.formulation.program(self.cuts).relaxed()

    @property
    def size(self) -> tuple[int, int]:
        """Its variables and rows."""
        return self.program.n_columns, self.program.n_rows

    def bound(self) -> float:
        """What it proves, worked out from it and its dual values, without a solver.

        In the units of the formulation's data.
        """
        return dual_bound(self.program, self.dual_values)

    def written(self, instance: Instance, worth: float) -> RootProof | None:
        """The proof by ids, none if the dual values prove nothing.

        Parameters
        ----------
        instance : Instance
            With the known victims, in the order of the formulation's data.
        worth : float
            Value of the routes found: no bound is above it.
        """
        bound, formulation = self.bound(), self.formulation
        if not np.isfinite(bound):
            return None
        fields: dict[str, list[dict[str, Any]]] = {}
        about = [
            *about_rows(instance, formulation),
            *(about_cut(instance, cut) for cut in self.cuts),
        ]
        unit = formulation.objective.unit_of(formulation.data)
        for (name, ids), value in zip(about, self.dual_values, strict=True):
            _note(fields, name, ids, value if name in _OF_TIME else value * unit)
        step = objective_step(formulation.data, formulation.objective)
        return RootProof.model_validate(
            {
                "objective": formulation.objective.name,
                "bound": min(step.up(bound) * unit, worth),
                "solver": highs_version(),
                **fields,
            }
        )


def _note(
    fields: dict[str, list[dict[str, Any]]], name: str, about: dict[str, Any], value: float
) -> None:
    if value:
        fields.setdefault(name, []).append({**about, "dual": float(f"{value:.{_DIGITS}g}")})


def about_rows(
    instance: Instance, formulation: EdgeFormulation
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Name of each row of `EdgeFormulation.rows`, and what it is about, in the same order."""
    data = formulation.data
    robots, victims = [r.id for r in instance.robots], [v.id for v in instance.victims]
    kinds = instance.capabilities
    for r, v in formulation.pairs:
        yield "degree", {"robot": robots[r], "victim": victims[v]}
    for name in ("leaves", "ends"):
        for robot in robots:
            yield name, {"robot": robot}
    loads = bool(len(formulation.services))
    for v, k in np.argwhere(data.required) if loads else decisive(data):
        yield "served", {"victim": victims[v], "kind": kinds[k]}
    for pair, k in formulation.services:
        r, v = formulation.pairs[pair]
        yield "present", {"robot": robots[r], "victim": victims[v], "kind": kinds[k]}
    yield from _of_robots("endurance", robots, np.isfinite(data.endurance))
    yield from _of_robots("walk", robots, np.isfinite(data.longest_walk))
    if formulation.objective.only_last:
        yield from _of_robots("makespan", robots, np.ones(data.n_robots, dtype=bool))


def _of_robots(
    name: str, robots: Sequence[int], chosen: Bools
) -> Iterator[tuple[str, dict[str, Any]]]:
    for robot, is_chosen in zip(robots, chosen, strict=True):
        if is_chosen:
            yield name, {"robot": robot}


def about_cut(instance: Instance, cut: Cut) -> tuple[str, dict[str, Any]]:
    """The kind of a cut, and what it is about."""
    about: dict[str, Any] = {
        "robot": instance.robots[cut.robot].id,
        "victims": [instance.victims[v].id for v in cut.members],
    }
    if cut.vertex is None:
        return ("first" if cut.first else "last"), about
    about["victim"] = instance.victims[cut.vertex].id
    return ("outside" if cut.first else "subtour"), about
