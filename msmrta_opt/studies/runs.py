"""The runs of a study: every combination it asks for, each keyed by what determines its result."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

from ..mission.errors import InputError, ModelError
from ..mission.instance import Instance
from ..optimise import registry, solvers
from ..optimise.solve import AUTO
from ..planners import check_options, planners
from ..planners.support.planner import versions
from ..stages.options import StagedOptions
from .compare import Case, cases, read_instances
from .generated import generated_instances
from .record import Record
from .specification import FormulationTable, InstanceFiles, PlannerTable, Scalar, Study, Timing

STAGED = frozenset(item.name for item in fields(StagedOptions))
SOLVING = ("solver_seed", "time_limit", "gap")
"""Options of a formulation's table that are its solver's."""


@dataclass(frozen=True)
class Planning:
    """A planner and its options: one way to plan."""

    planner: str
    options: Mapping[str, Scalar]
    folders: tuple[str, ...] = ()
    """Folders of models."""


@dataclass(frozen=True)
class Run:
    """One run of a study: `task` on `instance`."""

    contender: str
    instance: Instance
    task: Planning | Case
    timing: Timing
    versions: Mapping[str, str]
    run: str
    """Digest of what determines the result, versions aside."""
    key: str
    """The same with versions."""


@dataclass(frozen=True)
class _Contender:
    label: str
    field: str
    task: Planning | Case
    what: Mapping[str, Any]
    """All that determines the result, instance and versions aside."""
    versions: Mapping[str, str]


def runs(study: Study) -> list[Run]:
    """Every run of `study`, instance by instance, contenders in the order of the file.

    Raises
    ------
    InputError
        Naming the study's file and what in it is wrong; nothing has been run then.
    """
    try:
        for folder in study.models:
            registry.add_models(study.path.parent / folder)
        instances = _instances(study)
        contenders = [
            *_planners(study.planners),
            *_formulations(study.formulations, instances[0][0]),
        ]
        _check_labels(contenders, study.report.baseline)
    except InputError as error:
        raise error.within(study.path) from None
    return [
        _run(contender, instance, digest, study.timing)
        for instance, digest in instances
        for contender in contenders
    ]


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


def _run(contender: _Contender, instance: Instance, digest: str, timing: Timing) -> Run:
    what = {**contender.what, "instance": digest, "timing": timing.model_dump()}
    task = contender.task
    return Run(
        contender=contender.label,
        instance=instance,
        task=replace(task, instance=instance) if isinstance(task, Case) else task,
        timing=timing,
        versions=contender.versions,
        run=_digest(what),
        key=_digest({**what, "versions": contender.versions}),
    )


def _instances(study: Study) -> list[tuple[Instance, str]]:
    """All instances with their digests; names tell them apart."""
    found: dict[str, tuple[Instance, str]] = {}
    for i, table in enumerate(study.instances):
        try:
            several: list[Instance] = (
                read_instances(study.files(table))
                if isinstance(table, InstanceFiles)
                else list(generated_instances(table, folder=study.path.parent))
            )
        except InputError as error:
            raise _at(f"instances[{i}]", error) from None
        for instance in several:
            digest = _digest(instance.document())
            if found.setdefault(instance.name, (instance, digest))[1] != digest:
                raise InputError(
                    f"two instances are called {instance.name!r}; names tell rows apart",
                    field=f"instances[{i}]",
                )
    return list(found.values())


def _planners(tables: Iterable[PlannerTable]) -> Iterator[_Contender]:
    for i, table in enumerate(tables):
        field = f"planners[{i}]"
        try:
            for words, options in _combinations(table.axes()):
                check_options(table.planner, options)
                yield _Contender(
                    label=", ".join([table.name or table.planner, *words]),
                    field=field,
                    task=Planning(table.planner, options, _folders()),
                    what={
                        "planner": table.planner,
                        "options": options,
                        "models": _models_of(table.planner, options),
                    },
                    versions=versions(),
                )
        except InputError as error:
            raise _at(field, error) from None


def _formulations(tables: Iterable[FormulationTable], instance: Instance) -> Iterator[_Contender]:
    for i, table in enumerate(tables):
        field = f"formulations[{i}]"
        try:
            for words, options in _combinations(table.axes()):
                for case in _cases(table, options, instance):
                    before = _models_of("msmrta", case.options.as_dict())
                    yield _Contender(
                        label=", ".join([f"{case.model} by {case.solver}", *words]),
                        field=field,
                        task=case,
                        what={
                            "stage": case.stage,
                            "model": case.model,
                            "solver": case.solver,
                            "options": options,
                            "models": before | _sources([case.model]),
                        },
                        versions=_versions_with(case.solver),
                    )
        except InputError as error:
            raise _at(field, error) from None


def _cases(
    table: FormulationTable, options: Mapping[str, Any], instance: Instance
) -> Sequence[Case]:
    parameters = {k: v for k, v in options.items() if k not in STAGED and k not in SOLVING}
    found = cases(
        [instance],
        stage=table.stage,
        models=table.models or (),
        solver_names=table.solvers,
        seeds=[options["solver_seed"]] if "solver_seed" in options else (),
        options=StagedOptions(**{k: v for k, v in options.items() if k in STAGED}),
        parameters=parameters,
        time_limit=options.get("time_limit"),
        gap=options.get("gap"),
    )
    known = {name for case in found for name in _parameters(case.model)}
    for name in parameters:
        if name not in known:
            there = ", ".join(sorted(known | STAGED | set(SOLVING)))
            raise InputError(f"no such option; there are {there}", field=name)
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


def _check_labels(contenders: Sequence[_Contender], baseline: str | None) -> None:
    seen: dict[tuple[str, object], str] = {}
    for contender in contenders:
        seed = contender.what["options"].get("seed")
        if (contender.label, seed) in seen:
            raise InputError(
                f"{contender.label!r} is also in {seen[contender.label, seed]};"
                " give one of them a name of its own",
                field=contender.field,
            )
        seen[contender.label, seed] = contender.field
    labels = dict.fromkeys(contender.label for contender in contenders)
    if baseline is not None and baseline not in labels:
        raise InputError(
            f"{baseline!r} is not run; give one of {', '.join(labels)}", field="report.baseline"
        )


def _folders() -> tuple[str, ...]:
    return tuple(str(folder) for folder in registry.folders())


def _models_of(planner: str, options: Mapping[str, Any]) -> dict[str, str]:
    """The formulations that a planner's plans depend on, with their digests."""
    return _sources(planners()[planner].formulations_of(options))


def _sources(names: Iterable[str]) -> dict[str, str]:
    """Formulations' names with the digests of their files: an edited one is another."""
    return {name: hashlib.sha256(registry.path_of(name).read_bytes()).hexdigest() for name in names}


def _versions_with(solver: str) -> dict[str, str]:
    found = versions()
    if solver != AUTO:
        known = solvers.get(solver)
        found[known.package] = known.version
    return found


def _digest(document: object) -> str:
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _at(place: str, error: InputError) -> InputError:
    """`error`, met at `place` of the study."""
    if error.file:
        return InputError(str(error), field=place)
    return InputError(error.problem, field=".".join(p for p in (place, error.field) if p))
