"""What a run does: plan a mission, or solve a formulation for it. Either says what comes of it."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from ..certify.certificates import STAGE as STAGE_OF_BOUNDS
from ..mission.errors import InputError, ModelError, UnsupportedError
from ..mission.instance import Instance
from ..mission.metrics import METRICS
from ..mission.plan import Plan
from ..mission.suggestions import meant
from ..optimise import registry, solvers
from ..optimise.data import ClusterData
from ..optimise.solution import Solution
from ..optimise.solve import AUTO, solve
from ..optimise.solvers import Options
from ..planners import plan
from ..stages.data import STAGES, stage_data
from ..stages.options import StagedOptions
from .record import FINISHED, SKIPPED

CERTIFIED = (
    *("status", "sense", "objective", "bound", "gap", "proof"),
    *("n_variables", "n_rows"),
)
SOLVED = (*CERTIFIED, "objective_size", "check", "nodes", "solver_version")


@dataclass(frozen=True)
class Planning:
    """A planner and its options: one way to plan."""

    planner: str
    options: Mapping[str, Any]
    folders: tuple[str, ...] = ()
    """Folders of models."""

    def asked(self) -> dict[str, Any]:
        """What a record says of it before there is a result."""
        options = dict(self.options)
        return {
            "method": "planner",
            "planner": self.planner,
            **{name: options.get(name) for name in ("psi", "beta", "seed")},
            "options_json": json.dumps(options, sort_keys=True),
        }

    def warm_up(self) -> None:
        """Plan a tiny mission: what libraries do once per process is no planning time."""
        options = {name: value for name, value in self.options.items() if name != "improve"}
        with suppress(Exception):  # what is wrong will be said of the run
            plan(_tiny_mission(), planner=self.planner, **options)

    def do(self, instance: Instance) -> dict[str, Any]:
        """Plan `instance`; returns fields of a record."""
        made = plan(instance, planner=self.planner, **dict(self.options))
        return {
            **_certified(made),
            "metrics_json": json.dumps({name: getattr(made.metrics, name) for name in METRICS}),
            "check": "passed",
            "plan_digest": _plan_digest(made),
            "seconds": made.metrics.planning_seconds,
            "stage_seconds_json": json.dumps(made.planning_seconds),
        }


@dataclass(frozen=True)
class Solving:
    """A formulation, a solver and their options: one way to solve a stage."""

    stage: str
    model: str
    solver: str
    seed: int | None
    """Of the solver."""
    options: StagedOptions
    """Of the stages before."""
    parameters: Mapping[str, float]
    time_limit: float | None
    gap: float | None
    folders: tuple[str, ...]
    """Folders of models."""
    structure: bool = True
    """Whether ``auto`` may use what the matrix proves."""

    def asked(self) -> dict[str, Any]:
        """What a record says of it before there is a result."""
        options = {**self.options.as_dict(), **self.parameters}
        options |= {"solver_seed": self.seed, "time_limit": self.time_limit, "gap": self.gap}
        return {
            **{name: getattr(self, name) for name in ("stage", "model", "solver")},
            **{name: options[name] for name in ("psi", "beta", "seed")},
            "options_json": json.dumps(options, sort_keys=True),
        }

    def warm_up(self) -> None:
        """Solve a tiny program: what a library does once per process is no solving time."""
        with suppress(Exception):  # what is wrong will be said of the run
            _solve_tiny(self.solver)

    def do(self, instance: Instance) -> dict[str, Any]:
        """Solve it for `instance`; returns fields of a record.

        Time is that from the stage's data to a checked solution. A solver that is not installed, or
        cannot do what is asked, is skipped.
        """
        formulation = registry.get(self.model, stage=self.stage)
        if reason := self._cannot():
            return {"outcome": SKIPPED, "error": reason}
        data = stage_data(instance, self.stage, self.options)
        able = self.solver == AUTO or "time_limit" in solvers.get(self.solver).abilities
        began = time.perf_counter()
        try:
            solution = solve(
                formulation,
                data,
                solver=self.solver,
                structure=self.structure,
                seed=self.seed,
                time_limit=self.time_limit if able else None,
                gap=self.gap,
                **self.values_for(formulation),
            )
        except UnsupportedError as error:
            return {"outcome": SKIPPED, "error": str(error)}
        return _solved(solution, time.perf_counter() - began)

    def values_for(self, formulation: registry.Formulation) -> dict[str, Any]:
        """The values of the formulation's parameters: those given, or of options of the same name."""
        known = formulation.spec.parameters
        given = self.options.values_for(formulation)
        return given | {k: v for k, v in self.parameters.items() if k in known}

    def _cannot(self) -> str:
        if self.solver == AUTO:
            return ""
        solver = solvers.get(self.solver)
        if not solver.installed:
            return f"not installed; {solver.install}"
        for name, value in (("seed", self.seed), ("gap", self.gap)):
            if value is not None and name not in solver.abilities:
                return f"solver {solver.name} cannot do {name}"
        return ""


def solving_tasks(
    *,
    stage: str,
    models: Sequence[str] = (),
    solver_names: Sequence[str] = (),
    seeds: Sequence[int] = (),
    options: StagedOptions | None = None,
    parameters: Mapping[str, float] | None = None,
    time_limit: float | None = None,
    gap: float | None = None,
    structure: bool = True,
) -> list[Solving]:
    """Every combination of models, solvers and seeds, in this order.

    Without `models` all formulations of the stage are meant, broken files included; without
    `solver_names` ``auto`` and every installed solver. Without `structure` the solver ``auto`` is
    HiGHS with the integer program as it stands.

    Raises
    ------
    InputError
        If a stage, a solver or a model is unknown, a limit or seed out of range, or there is nothing
        to solve.
    """
    if stage not in STAGES:
        raise InputError(
            f"no stage {stage!r}{meant(stage, STAGES)}; there are {', '.join(STAGES)}",
            field="stage",
        )
    for seed in seeds or (None,):
        Options(time_limit=time_limit, gap=gap, seed=seed)
    known = {item.name for item in registry.listings()}
    for name in models:
        if name not in known:
            registry.get(name)
    chosen = dict.fromkeys(models or (item.name for item in registry.listings(stage)))
    if not chosen:
        raise InputError(f"no formulation of stage {stage!r}", field="models")
    for name in solver_names:
        if name != AUTO:
            solvers.get(name)
    _check_parameters(chosen, parameters or {})
    installed = (name for name, solver in solvers.solvers().items() if solver.installed)
    names = dict.fromkeys(solver_names or (AUTO, *installed))
    return [
        Solving(
            stage,
            model,
            solver,
            seed,
            options or StagedOptions(),
            parameters or {},
            time_limit,
            gap,
            folders_of_models(),
            structure,
        )
        for model, solver, seed in product(chosen, names, dict.fromkeys(seeds or (None,)))
    ]


def _check_parameters(models: Iterable[str], parameters: Mapping[str, float]) -> None:
    """Refuse a parameter that none of `models` has; files that do not load tell it themselves."""
    known: dict[str, None] = {}
    for name in models if parameters else ():
        with suppress(ModelError):
            known |= dict.fromkeys(registry.get(name).spec.parameters)
    for name in parameters:
        if name not in known:
            there = ", ".join(known) or "none"
            raise InputError(f"no such parameter; these formulations have {there}", field=name)


def folders_of_models() -> tuple[str, ...]:
    """The folders of formulations of one's own, for another process to add."""
    return tuple(str(folder) for folder in registry.folders())


def add_folders(folders: Iterable[str]) -> None:
    """Add what `folders_of_models` said, in another process."""
    for folder in folders:
        registry.add_models(folder)


def _certified(made: Plan) -> dict[str, Any]:
    """The certificate of a plan that has one as a whole, as the exact planner's does."""
    whole = [item for item in made.certificates if item.stage == STAGE_OF_BOUNDS]
    return {name: getattr(whole[-1], name) for name in CERTIFIED} if whole else {}


def _plan_digest(made: Plan) -> str:
    """Equal for plans that do the same."""
    routes = [route.model_dump(mode="json") for route in made.routes]
    return hashlib.sha256(json.dumps(routes, sort_keys=True).encode()).hexdigest()[:16]


def _solved(solution: Solution, seconds: float) -> dict[str, Any]:
    if solution.status == "skipped":
        return {"outcome": SKIPPED, "error": solution.message}
    return {
        **{name: getattr(solution, name) for name in SOLVED},
        "error": solution.reason,
        "outcome": FINISHED,
        "seconds": seconds,
        "stage_seconds_json": json.dumps(
            {"canonicalise": solution.canonicalise_seconds, "solve": solution.solve_seconds}
        ),
    }


@cache
def _solve_tiny(solver: str) -> None:
    tiny = ClusterData(np.eye(2), np.eye(2), np.ones(2, dtype=np.int64))
    solve("cluster_one_to_one", tiny, solver=solver)


def _tiny_mission() -> Instance:
    return Instance.from_document(
        {
            "format": "msmrta-instance/1",
            "map": {"rows": [".."]},
            "capabilities": ["A"],
            "service_time": {"A": 1},
            "robots": [{"id": 0, "start": [0, 0], "speed": 1, "capabilities": ["A"]}],
            "victims": [{"id": 0, "cell": [0, 1], "requirements": ["A"]}],
        }
    )
