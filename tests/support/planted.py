"""Shipped formulations with one row gone wrong: what `explain` and `diff` are to find."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.subject import subject
from msmrta_opt.stages.data import stage_data

INSTANCES = Path(__file__).parents[2] / "instances"
MODELS = {
    "clustering": ("clustering_pmedian",),
    "cluster": ("cluster_one_to_one", "cluster_budgeted", "cluster_fair", "cluster_printed"),
    "victim": (
        *("victim_one_to_one", "victim_covering", "victim_balanced", "victim_bottleneck"),
        *("victim_budgeted", "victim_generalized"),
    ),
    "joint": ("joint_assignment",),
}
MISSIONS = ("paper", "split", "corridor", "two_rooms")
EDITS = ("side", "sense", "equation", "coefficient", "entry", "dropped")


@dataclass(frozen=True)
class Planted:
    """A program, the same with one row gone wrong, and which that is."""

    name: str
    edit: str
    right: Program
    wrong: Program
    row: str
    is_infeasible: bool


def planted(count: int, *, seed: int = 0) -> Iterator[Planted]:
    """`count` programs whose edit makes them infeasible, or changes their optimum."""
    random = np.random.RandomState(seed)
    while count:
        mission = MISSIONS[random.randint(len(MISSIONS))]
        stage = list(MODELS)[random.choice(len(MODELS), p=[0.1, 0.35, 0.45, 0.1])]
        model = MODELS[stage][random.randint(len(MODELS[stage]))]
        right = program_of(model, mission, stage)
        edit = EDITS[random.randint(len(EDITS))]
        row = int(random.randint(right.n_rows))
        wrong = edited(right, row, edit, random)
        before, after = optimum(right), optimum(wrong)
        if before is None or (
            after is not None and abs(after - before) <= 1e-6 * (1 + abs(before))
        ):
            continue
        name = f"{model} on {mission}"
        yield Planted(name, edit, right, wrong, right.row_name(row), after is None)
        count -= 1


@cache
def program_of(model: str, mission: str, stage: str) -> Program:
    return subject(model, _data(mission, stage)).program


@cache
def _data(mission: str, stage: str) -> object:
    return stage_data(Instance.read(INSTANCES / f"{mission}.json"), stage)


def edited(right: Program, row: int, edit: str, random: np.random.RandomState) -> Program:
    """`right` with another statement in `row`, as a slip of the modeller makes one."""
    lower, upper = right.row_lower.copy(), right.row_upper.copy()
    matrix = right.matrix.tolil(copy=True)
    own = matrix.rows[row]
    if edit == "side":
        step = random.choice([-2, -1, 1, 2])
        lower[row], upper[row] = lower[row] + step, upper[row] + step
    elif edit == "sense":
        lower[row], upper[row] = (
            (upper[row], np.inf) if np.isinf(lower[row]) else (-np.inf, lower[row])
        )
    elif edit == "equation":
        lower[row] = upper[row] = upper[row] if np.isfinite(upper[row]) else lower[row]
    elif edit == "coefficient" and own:
        column = own[random.randint(len(own))]
        matrix[row, column] = matrix[row, column] * random.choice([-1.0, 0.5, 3.0])
    elif edit == "entry":
        matrix[row, random.randint(right.n_columns)] = float(random.choice([-1, 1, 2]))
    elif edit == "dropped":
        lower[row], upper[row] = -np.inf, np.inf
    return replace(right, matrix=matrix.tocsr(), row_lower=lower, row_upper=upper)


def optimum(program: Program) -> float | None:
    """By scipy; ``None`` if infeasible, infinite if unbounded."""
    rows = LinearConstraint(program.matrix, program.row_lower, program.row_upper)
    found = milp(
        program.sign * program.cost,
        constraints=rows,
        bounds=Bounds(program.lower, program.upper),
        integrality=program.integer.astype(int),
    )
    if found.status == 0:
        return float(program.sign * found.fun)
    return None if found.status == 2 else np.inf
