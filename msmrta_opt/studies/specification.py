"""The study file: what is run on what, in TOML.

Everywhere, a list of values is an axis: all combinations are run.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    ValidationError,
    field_validator,
    model_validator,
)

from ..mission.errors import InputError
from ..mission.files import read_toml
from ..mission.metrics import metrics_of
from ..mission.suggestions import none_of
from ..mission.validation import first_problem

Scalar = bool | int | float | str


def _listed(value: object) -> object:
    return value if isinstance(value, list) else [value]


def _paired(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


Texts = Annotated[list[str], BeforeValidator(_listed), Field(min_length=1)]
Counts = Annotated[list[PositiveInt], BeforeValidator(_listed), Field(min_length=1)]
Seeds = Annotated[list[NonNegativeInt], BeforeValidator(_listed), Field(min_length=1)]


Range = Annotated[tuple[NonNegativeInt, NonNegativeInt], BeforeValidator(_paired)]
Share = Annotated[float, Field(ge=0, le=1)]


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class InstanceFiles(_Table):
    """Instances from files: paths and globs, from the study's folder."""

    files: Texts


class GeneratedInstances(_Table):
    """Instances from the generator: all combinations of maps, robots, victims and seeds.

    The other fields are the generator's own, see `generate_mission` and `named_maps.make_map`; what is
    not given is as it has it.
    """

    maps: Texts
    """Names, files from the study's folder, or layouts to generate."""
    robots: Counts
    victims: Counts
    seeds: Seeds = [0]

    kinds: PositiveInt | None = None
    per_robot: Range | None = None
    per_victim: Range | None = None
    priorities: Range | None = None
    speeds: list[PositiveFloat] | None = None
    unreachable: Share | None = None
    unmeetable: Share | None = None
    size: Range | None = None
    room: PositiveInt | None = None
    density: Share | None = None
    openings: Share | None = None

    def given(self, *names: str) -> dict[str, Any]:
        """Those of the generator's fields that the study gives."""
        values = {name: getattr(self, name) for name in names}
        return {name: value for name, value in values.items() if value is not None}


class _Options(_Table):
    """A table whose keys beyond its own are options; each value a scalar or a list of them."""

    model_config = ConfigDict(frozen=True, extra="allow", strict=True)

    def axes(self) -> dict[str, list[Scalar]]:
        """The values of each option, in the order of the file."""
        return {name: _axis(name, value) for name, value in (self.model_extra or {}).items()}


class PlannerTable(_Options):
    """A planner, with its options."""

    name: str | None = None
    planner: str = "msmrta"


class ScenarioTable(_Table):
    """What may happen while plans are executed: scenario files, from the study's folder."""

    file: Texts
    runs: PositiveInt = 100
    """How often each plan is executed by each policy: with the seeds from 0 on."""
    hindsight: PositiveFloat | None = None
    """Seconds to find, for each run, the best that its world allowed; none by default.

    By the report's metric of quality, or by total time where that is no objective."""


class PolicyTable(_Options):
    """What to do when something happens: a policy, with its options."""

    name: str | None = None
    policy: str = "keep"


class FormulationTable(_Options):
    """Formulations of a stage × solvers; further options are those of the stages before."""

    stage: str
    models: Annotated[list[str] | None, BeforeValidator(lambda v: v and _listed(v))] = None
    solvers: Texts = ["auto"]


class Limits(_Table):
    """What one run may use, beyond which it is killed and counts as failed."""

    seconds: PositiveFloat | None = None
    """For each repetition."""
    memory: PositiveFloat | None = None
    """MiB."""


class Timing(_Table):
    """How a run is timed: plans made and thrown away first, then those that count."""

    warm_up: NonNegativeInt = 0
    repetitions: PositiveInt = 1


class ReportTable(_Table):
    """What the report compares: by which metric, and against which contender."""

    baseline: str | None = None
    quality: str = "total_time"
    """The metric by which plans that serve the same are compared."""
    published: dict[str, float] = Field(default_factory=dict)
    """Percent of planning time saved against the baseline, as published, by map."""
    published_source: str = ""

    @field_validator("quality")
    @classmethod
    def _is_a_metric_of_plans(cls, name: str) -> str:
        known = [m.name for m in metrics_of("report") if m.better != "neither"]
        if name not in known:
            raise none_of(name, known)
        return name


class Study(_Table):
    """A study, read and checked."""

    title: str
    description: str = ""
    instances: Annotated[list[InstanceFiles | GeneratedInstances], Field(min_length=1)]
    models: list[str] = []
    """Folders of formulations of one's own, from the study's folder."""
    planners: list[PlannerTable] = []
    formulations: list[FormulationTable] = []
    scenarios: list[ScenarioTable] = []
    """With policies, each planner's plan is executed under each; it is not only made."""
    policies: list[PolicyTable] = []
    limits: Limits = Limits()
    timing: Timing = Timing()
    report: ReportTable = ReportTable()
    path: Path = Field(default=Path("study.toml"), exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _kinds_of_instances(cls, document: Any) -> Any:
        """Tell the two kinds of instance tables apart here, so that errors speak of the right one."""
        if isinstance(document, Mapping) and isinstance(document.get("instances"), list):
            document = dict(document)
            document["instances"] = [
                _instances(i, table) for i, table in enumerate(document["instances"])
            ]
        return document

    @model_validator(mode="after")
    def _has_something_to_run(self) -> Self:
        if not self.planners and not self.formulations:
            raise InputError(
                "nothing to run; give [[planners]] or [[formulations]]", field="planners"
            )
        for one, other in (("scenarios", "policies"), ("policies", "scenarios")):
            if getattr(self, one) and not getattr(self, other):
                raise InputError(f"is missing; [[{one}]] need some", field=other)
        if self.policies and not self.planners:
            raise InputError("is missing; [[policies]] execute their plans", field="planners")
        return self

    @classmethod
    def read(cls, path: str | Path) -> Study:
        """Read a study file.

        Raises
        ------
        InputError
            Naming the file, the field, the offending value and what would be right.
        """
        return cls.of(read_toml(path), path)

    @classmethod
    def of(cls, document: Mapping[str, Any], path: str | Path) -> Self:
        """The study of a document; `path` names its ledger, and files are looked for from there.

        Raises
        ------
        InputError
            As `read`.
        """
        if "path" in document:
            raise InputError(
                "there is no such field; correct its name or remove it", field="path", file=path
            )
        try:
            return cls.model_validate({**document, "path": Path(path)})
        except ValidationError as error:
            raise first_problem(error, toml=True).within(path) from None
        except InputError as error:
            raise error.within(path) from None

    @property
    def ledger(self) -> Path:
        """Where the results are kept: beside the study."""
        return self.path.with_suffix(".sqlite")


def _instances(i: int, table: Any) -> InstanceFiles | GeneratedInstances:
    kind = InstanceFiles if isinstance(table, Mapping) and "files" in table else GeneratedInstances
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        found = first_problem(error)
        field = ".".join(part for part in (f"instances[{i}]", found.field) if part)
        raise InputError(found.problem, field=field) from None


def _axis(name: str, value: object) -> list[Scalar]:
    values: list[Any] = value if isinstance(value, list) else [value]
    for item in values:
        if not isinstance(item, Scalar):
            raise InputError(f"{item!r}; give a number, a text, true or false", field=name)
    if not values:
        raise InputError("no value; give at least one", field=name)
    return values
