"""The missions of a study: from files, and from the generator.

What is generated follows from its recipe: the generator's version and parameters, and the map. A ledger
keeps the names and digests that recipes gave, so that to look at a study makes no mission anew.
"""

from __future__ import annotations

import glob
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import Any

from ..mission.errors import InputError
from ..mission.generate import generate_mission
from ..mission.grid import GridMap
from ..mission.instance import Instance
from ..mission.layouts import share_of
from ..mission.named_maps import LAYOUTS, find_map, make_map, named_maps
from ..mission.shipped import shipped_instances
from ..mission.suggestions import meant
from ..mission.validation import said_of
from ..planners.support.planner import versions
from .specification import GeneratedInstances, InstanceFiles, Study

MISSION = (
    *("kinds", "per_robot", "per_victim", "speeds", "priorities"),
    *("unreachable", "unmeetable"),
)
LAYOUT = ("size", "room", "density", "openings")
DETERMINING = ("msmrta_opt", "python", "numpy")
"""Packages whose versions a generated mission depends on."""

Known = Mapping[str, tuple[str, str]]
"""The name and the digest of the mission that a recipe gave."""


class Mission:
    """A mission by name and digest, made when it is asked for.

    Parameters
    ----------
    make : callable
        Gives the instance.
    recipe : str
        Digest of all that it follows from; empty where there is none.
    known : tuple of str, optional
        Its name and digest, so that neither needs it to be made.
    """

    def __init__(
        self, make: Callable[[], Instance], recipe: str = "", known: tuple[str, str] | None = None
    ) -> None:
        self.recipe, self._make, self._known = recipe, make, known

    @classmethod
    def of(cls, instance: Instance) -> Mission:
        """The mission that there is."""
        return cls(lambda: instance)

    @cached_property
    def instance(self) -> Instance:
        """The mission itself."""
        return self._make()

    @cached_property
    def name(self) -> str:
        """The name that tells it apart."""
        return self._known[0] if self._known else self.instance.name

    @cached_property
    def digest(self) -> str:
        """Of the whole document."""
        return self._known[1] if self._known else digest_of(self.instance.document())

    def __reduce__(self) -> tuple[Any, ...]:
        """For another process, which cannot make it: as it is."""
        return Mission.of_parts, (self.instance, self.recipe, (self.name, self.digest))

    @classmethod
    def of_parts(cls, instance: Instance, recipe: str, known: tuple[str, str]) -> Mission:
        """What `__reduce__` takes apart."""
        return cls(lambda: instance, recipe, known)


def missions(study: Study, known: Known) -> list[Mission]:
    """All missions of `study`, in its order; names tell them apart.

    Raises
    ------
    InputError
        If a file is not a mission, a map is unknown, the generator refuses what it is asked for, or two
        missions have one name.
    """
    found: dict[str, Mission] = {}
    for i, table in enumerate(study.instances):
        try:
            several = (
                [Mission.of(instance) for instance in read_instances(_files(study, table))]
                if isinstance(table, InstanceFiles)
                else list(_generated(table, study.path.parent, known))
            )
            for mission in several:
                if found.setdefault(mission.name, mission).digest != mission.digest:
                    raise InputError(
                        f"two instances are called {mission.name!r}; names tell rows apart"
                    )
        except InputError as error:
            raise said_of(f"instances[{i}]", error) from None
    return list(found.values())


def read_instances(paths: Sequence[str | Path]) -> list[Instance]:
    """The instances of files; each needs a name of its own, so a nameless one takes its file's.

    Raises
    ------
    InputError
        If a file is not an instance, or two instances have one name.
    """
    found: dict[str, Instance] = {}
    for path in paths:
        instance = Instance.read(path)
        if not instance.name:
            instance = instance.replace(name=Path(path).stem, clusters=instance.clusters)
        if instance.name in found:
            raise InputError(
                f"{instance.name!r} is also another file's; names tell rows apart",
                field="name",
                file=path,
            )
        found[instance.name] = instance
    return list(found.values())


def digest_of(document: object) -> str:
    """Equal for equal documents."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _files(study: Study, table: InstanceFiles) -> list[Path]:
    """The files that `table` names, each once.

    That is a file of that name, else what matches the pattern, else the shipped instance of that name.
    """
    folder = study.path.parent
    found: dict[Path, None] = {}
    for pattern in table.files:
        matches = [folder / pattern]
        if not matches[0].is_file():
            # The study's folder is a place; only what the study says of files is a pattern, and where
            # its brackets match nothing, they are those of names.
            for text in (pattern, pattern.replace("[", "[[]")):
                inside = sorted(glob.glob(text, root_dir=folder, recursive=True))
                if matches := [folder / match for match in inside]:
                    break
        if not matches and pattern in shipped_instances():
            matches = [shipped_instances()[pattern]]
        if not matches:
            near = meant(pattern, shipped_instances())
            raise InputError(f"{pattern!r} matches no file{near}", field="files")
        found.update(dict.fromkeys(matches))
    return list(found)


def _generated(table: GeneratedInstances, folder: Path, known: Known) -> Iterator[Mission]:
    """Map by map, then by robots, victims and seeds."""
    given = versions()
    base = {
        "versions": {package: given[package] for package in DETERMINING},
        **table.given(*MISSION, *LAYOUT),
    }
    for name in table.maps:
        place = name if name in LAYOUTS or name in named_maps() else folder / name
        map_ = name if name in LAYOUTS else _map_digest(find_map(place))
        for n_robots, n_victims, seed in product(table.robots, table.victims, table.seeds):
            sizes = {"robots": n_robots, "victims": n_victims, "seed": seed}
            recipe = digest_of({**base, "map": map_, **sizes})
            make = partial(_generate, table, place, n_robots, n_victims, seed)
            yield Mission(make, recipe, known.get(recipe))


def _generate(
    table: GeneratedInstances, place: str | Path, n_robots: int, n_victims: int, seed: int
) -> Instance:
    n_cut_off = share_of(table.unreachable or 0.0, n_victims)
    grid = make_map(place, seed=seed, n_cut_off=n_cut_off, **table.given(*LAYOUT))
    return generate_mission(grid, n_robots, n_victims, seed=seed, **table.given(*MISSION))


def _map_digest(grid: GridMap) -> str:
    cells = hashlib.sha256(grid.free.tobytes()).hexdigest()
    return f"{grid.name} {grid.shape} {cells}"
