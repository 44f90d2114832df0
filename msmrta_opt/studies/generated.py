"""Instances that a study asks the generator for."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from ..mission.generate import generate_mission
from ..mission.instance import Instance
from ..mission.layouts import share_of
from ..mission.named_maps import LAYOUTS, make_map, named_maps
from .specification import GeneratedInstances

MISSION = (
    *("kinds", "per_robot", "per_victim", "speeds", "priorities"),
    *("unreachable", "unmeetable"),
)
LAYOUT = ("size", "room", "density", "openings")


def generated_instances(table: GeneratedInstances, *, folder: Path) -> Iterator[Instance]:
    """The instances of `table`, map by map, then by robots, victims and seeds.

    Raises
    ------
    InputError
        If a map is unknown, or the generator refuses what it is asked for.
    """
    for name in table.maps:
        place = name if name in LAYOUTS or name in named_maps() else folder / name
        for n_robots, n_victims, seed in product(table.robots, table.victims, table.seeds):
            n_cut_off = share_of(table.unreachable or 0.0, n_victims)
            grid = make_map(place, seed=seed, n_cut_off=n_cut_off, **table.given(*LAYOUT))
            yield generate_mission(grid, n_robots, n_victims, seed=seed, **table.given(*MISSION))
