"""The runs of a study: every combination it asks for, each keyed by what determines its result."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from pathlib import Path
from typing import Any

from ..execution.policies import policy_of
from ..mission.errors import InputError, ModelError, all_of, each_of
from ..mission.instance import Instance
from ..mission.scenario import Scenario
from ..mission.suggestions import meant
from ..mission.validation import said_of
from ..optimise import registry, solvers
from ..optimise.solve import AUTO
from ..planners import check_options, planners
from ..planners.support.planner import versions
from ..routing.objectives import DEFAULT, OBJECTIVES
from ..stages.options import options_type
from .executing import Executing
from .missions import Known, Mission, digest_of, missions
from .record import Record
from .specification import (
    FormulationTable,
    PlannerTable,
    PolicyTable,
    Scalar,
    Study,
    Timing,
)
from .tasks import Planning, Solving, add_folders, folders_of_models, solving_tasks

Task = Planning | Solving | Executing
"""What a run does."""
SOLVING = ("solver_seed", "time_limit", "gap")
"""Options of a formulation's table that are its solver's."""


@dataclass(frozen=True)
class Run:
    """One run: `task` on a mission."""

    contender: str
    mission: Mission
    task: Task
    timing: Timing
    versions: Mapping[str, str]
    run: str
    """Digest of what determines the result, versions aside."""
    key: str
    """The same with versions."""

    @property
    def instance(self) -> Instance:
        """The mission itself."""
        return self.mission.instance


@dataclass(frozen=True)
class Contender:
    """Who is run: a task under the name that tables have for it."""

    label: str
    task: Task
    what: Mapping[str, Any]
    """All that determines the result, mission and versions aside."""
    versions: Mapping[str, str]
    field: str = ""
    """Where the study asks for it."""


def runs(study: Study, known: Known | None = None) -> list[Run]:
    """Every run of `study`, mission by mission, contenders in the order of the file.

    Parameters
    ----------
    study : Study
        As read.
    known : mapping of str to tuple of str, optional
        Names and digests of missions that need not be made, see `Ledger.missions`; then it is not
        looked at whether scenarios fit missions.

    Raises
    ------
    InputError
        Naming the study's file and what in it is wrong; nothing has been run then.
    """
    try:
        add_folders(str(study.path.parent / folder) for folder in study.models)
        planned = list(_planners(study.planners))
        if study.policies:
            planned = list(_executions(study, planned))
        contenders = [*planned, *_formulations(study.formulations)]
        _check_labels(contenders, study.report.baseline)
        found = missions(study, known or {})
        if known is None:
            _check_scenarios(study, found)
        return combined(found, contenders, study.timing)
    except InputError as error:
        raise error.within(study.path) from None


def combined(
    missions: Iterable[Mission], contenders: Sequence[Contender], timing: Timing
) -> list[Run]:
    """Every contender on every mission."""
    return [_run(contender, mission, timing) for mission in missions for contender in contenders]


def current(todo: Sequence[Run], records: Iterable[Record]) -> list[Record]:
    """The records of `todo`, in its order; where there is none of these versions, the newest."""
    of_key: dict[str, Record] = {}
    of_run: dict[str, Record] = {}
    for record in records:
        of_key[record.key] = record
        newest = of_run.setdefault(record.run, record)
        if record.finished_at > newest.finished_at:
            of_run[record.run] = record
    found = (of_key.get(run.key, of_run.get(run.run)) for run in todo)
    return [record for record in found if record is not None]


def solving_contender(
    task: Solving, label: str = "", options: Mapping[str, Any] | None = None, field: str = ""
) -> Contender:
    """A formulation and a solver; `options` are those that a study gives."""
    names = [*planners()["msmrta"].formulations_of(task.options.as_dict()), task.model]
    used = versions()
    if task.solver != AUTO:
        solver = solvers.get(task.solver)
        used[solver.package] = solver.package_version
    what = {
        "stage": task.stage,
        "model": task.model,
        "solver": task.solver,
        "options": options or {},
        "models": _sources(names),
    }
    return Contender(label or f"{task.model} by {task.solver}", task, what, used, field)


def _run(contender: Contender, mission: Mission, timing: Timing) -> Run:
    what = {**contender.what, "instance": mission.digest, "timing": timing.model_dump()}
    return Run(
        contender=contender.label,
        mission=mission,
        task=contender.task,
        timing=timing,
        versions=contender.versions,
        run=digest_of(what),
        key=digest_of({**what, "versions": contender.versions}),
    )


def _planners(tables: Iterable[PlannerTable]) -> Iterator[Contender]:
    for i, table in enumerate(tables):
        field = f"planners[{i}]"
        try:
            for words, options in _combinations(table.axes()):
                check_options(table.planner, options)
                names = planners()[table.planner].formulations_of(options)
                yield Contender(
                    label=", ".join([table.name or table.planner, *words]),
                    task=Planning(table.planner, options, folders_of_models()),
                    what={
                        "planner": table.planner,
                        "options": options,
                        "models": _sources(names),
                    },
                    versions=versions(),
                    field=field,
                )
        except InputError as error:
            raise said_of(field, error) from None


def _executions(study: Study, planned: Sequence[Contender]) -> Iterator[Contender]:
    """Every planner's plan under every scenario by every policy."""
    scenarios = list(_scenarios(study))
    policies = list(_policies(study.policies))
    quality = study.report.quality
    objective = quality if quality in OBJECTIVES else DEFAULT
    for made, scenario, policy in product(planned, scenarios, policies):
        assert isinstance(made.task, Planning)
        task = Executing(made.task, policy.name, policy.options, *scenario, objective)
        labels = [policy.label] if len(planned) == 1 else [made.label, policy.label]
        what = {
            "policy": policy.name,
            "policy_options": policy.options,
            "scenario": scenario[0].model_dump(mode="json"),
            "runs": scenario[1],
            "hindsight": scenario[2] and [scenario[2], objective],
        }
        yield replace(
            made, label=", ".join(labels), task=task, what={**made.what, **what}, field=policy.field
        )


def _scenarios(study: Study) -> Iterator[tuple[Scenario, int, float | None]]:
    """The scenarios, each with how often plans are executed; a nameless one takes its file's name."""
    seen: dict[str, str] = {}
    for i, table in enumerate(study.scenarios):
        for file in table.file:
            try:
                read = Scenario.read(study.path.parent / file)
            except InputError as error:
                raise said_of(f"scenarios[{i}]", error) from None
            named = read if read.name else read.model_copy(update={"name": Path(file).stem})
            if named.name in seen:
                raise InputError(
                    f"{named.name!r} is also the name of {seen[named.name]}; names tell rows apart",
                    field=f"scenarios[{i}].file",
                )
            seen[named.name] = file
            yield named, table.runs, table.hindsight


def _check_scenarios(study: Study, found: Sequence[Mission]) -> None:
    """Refuse scenarios that do not fit a mission, each mistake once with the missions it is one for."""
    missions_of: dict[tuple[str, str, Path], list[str]] = {}
    for file in (file for table in study.scenarios for file in table.file):
        path = study.path.parent / file
        scenario = Scenario.read(path)
        for mission in found:
            try:
                scenario.check_for(mission.instance)
            except InputError as error:
                for one in each_of(error):
                    missions_of.setdefault((one.problem, one.field, path), []).append(mission.name)
    if missions_of:
        raise all_of(
            [
                InputError(f"{problem} (mission {_first(names)})", field=field, file=path)
                for (problem, field, path), names in missions_of.items()
            ]
        )


def _first(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"


@dataclass(frozen=True)
class _Policy:
    label: str
    name: str
    options: Mapping[str, Any]
    field: str


def _policies(tables: Iterable[PolicyTable]) -> Iterator[_Policy]:
    for i, table in enumerate(tables):
        field = f"policies[{i}]"
        try:
            for words, options in _combinations(table.axes()):
                policy_of(table.policy, options)
                label = ", ".join([table.name or table.policy, *words])
                yield _Policy(label, table.policy, options, field)
        except InputError as error:
            raise said_of(field, error) from None


def _formulations(tables: Iterable[FormulationTable]) -> Iterator[Contender]:
    for i, table in enumerate(tables):
        field = f"formulations[{i}]"
        try:
            for words, options in _combinations(table.axes()):
                for task in _solving(table, options):
                    label = ", ".join([f"{task.model} by {task.solver}", *words])
                    yield solving_contender(task, label, options, field)
        except InputError as error:
            raise said_of(field, error) from None


def _solving(table: FormulationTable, options: Mapping[str, Any]) -> Sequence[Solving]:
    for name in SOLVING:
        value = options.get(name, 0)
        if isinstance(value, (str, bool)):
            raise InputError(f"{value!r}; give a number", field=name)
        if name == "solver_seed" and not isinstance(value, int):
            raise InputError(f"{value!r}; give a whole number", field=name)
    options_of_stage = options_type(table.stage)
    staged = {item.name for item in fields(options_of_stage)} - {"params"}
    parameters = {k: v for k, v in options.items() if k not in staged and k not in SOLVING}
    found = solving_tasks(
        stage=table.stage,
        models=table.models or (),
        solver_names=table.solvers,
        seeds=[options["solver_seed"]] if "solver_seed" in options else (),
        options=options_of_stage(**{k: v for k, v in options.items() if k in staged}),
        parameters=parameters,
        time_limit=options.get("time_limit"),
        gap=options.get("gap"),
    )
    known = {name for task in found for name in _parameters(task.model)}
    for name in parameters:
        if name not in known:
            there = ", ".join(sorted(known | staged | set(SOLVING)))
            raise InputError(
                f"no such option{meant(name, (*known, *staged, *SOLVING))}; there are {there}",
                field=name,
            )
    return found


def _parameters(model: str) -> Iterable[str]:
    """The parameters of a formulation; none of a file that does not load, which its runs tell."""
    try:
        return registry.get(model).spec.parameters
    except ModelError:
        return ()


def _combinations(
    axes: Mapping[str, list[Scalar]],
) -> Iterator[tuple[list[str], dict[str, Scalar]]]:
    """Every choice of one value per axis, and the words that tell it from the others.

    The seed has a column of its own: repetitions with other seeds are one contender.
    """
    telling = [name for name, values in axes.items() if len(values) > 1 and name != "seed"]
    for values in product(*axes.values()):
        chosen = dict(zip(axes, values, strict=True))
        yield [f"{name} = {chosen[name]}" for name in telling], chosen


def _check_labels(contenders: Sequence[Contender], baseline: str | None) -> None:
    seen: dict[tuple[object, ...], str] = {}
    for contender in contenders:
        scenario = contender.what.get("scenario", {}).get("name", "")
        one = contender.label, contender.what["options"].get("seed"), scenario
        if one in seen:
            raise InputError(
                f"{contender.label!r} is also in {seen[one]}; give one of them a name of its own",
                field=contender.field,
            )
        seen[one] = contender.field
    labels = dict.fromkeys(contender.label for contender in contenders)
    if baseline is not None and baseline not in labels:
        raise InputError(
            f"{baseline!r} is not run{meant(baseline, labels)}; give one of {', '.join(labels)}",
            field="report.baseline",
        )


def _sources(names: Iterable[str]) -> dict[str, str]:
    """Formulations' names with the digests of their files: an edited one is another."""
    return {name: hashlib.sha256(registry.path_of(name).read_bytes()).hexdigest() for name in names}
