"""Scouting: find the victims (Algorithm 1, line ``Scouting``).

Scouts move over the map in discrete steps, each by the same kind of walk (`walks`), and look around
them (`visibility`). A victim is found when a scout sees its cell.

In a step, every scout makes one 4-connected move, then every scout looks; before the first move
they look too, which is step 0. Where order matters (a shared table of visits, two scouts that see a
victim in the same step), scouts act in document order. A scout without a free neighbour stays where
it is; scouts do not block each other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Literal

import numpy as np

from ..mission.errors import InputError
from ..mission.grid import Cell, GridMap
from ..mission.instance import Instance
from ..mission.plan import Find, ScoutingReport, Track
from ..mission.suggestions import meant
from ..mission.visibility import FieldOfView
from .options import StagedOptions
from .walks import WALKS, Ground

STOPS = ("covered_or_found", "covered")
"""When scouts may stop: once all is seen or all victims are found, or only once all is seen."""

STEPS_PER_CELL = 50
"""The default step limit, per free cell of the map."""

Ended = Literal["covered", "all victims found", "step limit"]


def scouting(
    instance: Instance,
    *,
    walk: str = "ant_colony",
    shared_table: bool = True,
    seed: int = 0,
    max_steps: int | None = None,
    stop: str = "covered_or_found",
) -> ScoutingReport:
    """Send out the scouts of `instance` and report what they find.

    They stop after the first step at which one of these holds, in this order of precedence:

    1. ``"all victims found"``: there are victims and each has been seen (not with
       ``stop="covered"``, for scouts who cannot know how many victims there are);
    2. ``"covered"``: every cell that can be seen from cells the scouts can reach has been seen;
    3. ``"step limit"``: `max_steps` steps have been made.

    So with the default `stop`, ``"covered"`` means that somebody cannot be seen at all, or that
    there is nobody to find.

    Parameters
    ----------
    instance : Instance
        The map, the scouts and the victims that they do not know of yet.
    walk : str
        One of `walks.WALKS`.
    shared_table : bool
        Whether the scouts share one table of visits or keep one each (ant colony only).
    seed : int
        Determines everything that is random; from 0 to 2**32 − 1.
    max_steps : int, optional
        The step limit; by default 50 per free cell of the map.
    stop : str
        One of `STOPS`: what ends the search before the limit.

    Returns
    -------
    ScoutingReport
        Tracks in document order; finds in the order in which they were made (within a step by
        scout, then by victim, in document order); coverage per step, step 0 included.

    Raises
    ------
    InputError
        If the instance has no scouts, or an option is not one of those above.
    """
    if not instance.scouts:
        raise InputError(
            f"instance {instance.name!r} has no scouts; give at least one", field="scouts"
        )
    _check_options(walk, seed, max_steps, stop)
    if max_steps is None:
        max_steps = STEPS_PER_CELL * int(instance.map.free.sum())

    neighbours = _neighbours(instance.map)
    starts = [scout.start for scout in instance.scouts]
    move = WALKS[walk](Ground(neighbours, starts, shared_table, np.random.RandomState(seed)))
    tracks = [[start] for start in starts]
    watch = _Watch(instance)
    watch.look(starts)
    while (ended := watch.verdict(max_steps, stop)) is None:
        for scout, track in enumerate(tracks):
            here = track[-1]
            track.append(move(scout, here) if neighbours(here) else here)
        watch.look([track[-1] for track in tracks])

    return ScoutingReport(
        walk=walk,
        shared_table=shared_table,
        seed=seed,
        tracks=tuple(
            Track(scout=scout.id, visual_field_depth=scout.visual_field_depth, cells=tuple(track))
            for scout, track in zip(instance.scouts, tracks, strict=True)
        ),
        finds=tuple(watch.finds),
        not_found=tuple(watch.hidden),
        coverage=tuple(watch.coverage),
        ended=ended,
    )


def scout_mission(
    instance: Instance, options: StagedOptions
) -> tuple[Instance, ScoutingReport | None]:
    """The mission with the victims that its scouts find, and their report.

    Without scouts all victims are known, and there is no report.
    """
    if not instance.scouts:
        return instance, None
    report = scouting(
        instance, walk=options.walk, shared_table=options.shared_table, seed=options.seed
    )
    if not report.not_found:
        return instance, report
    hidden = set(report.not_found)
    found = [v for v, victim in enumerate(instance.victims) if victim.id not in hidden]
    return instance.with_victims(found), report


class _Watch:
    """What the scouts have seen so far, and whom they have found."""

    def __init__(self, instance: Instance) -> None:
        grid, self.scouts = instance.map, instance.scouts
        depths = {scout.visual_field_depth for scout in self.scouts}
        self._views = {depth: FieldOfView(grid, depth) for depth in depths}
        self._looked_from: set[tuple[int, Cell]] = set()
        self._seen = np.zeros(grid.shape, dtype=bool)
        # Sight passes only where walking does, so what can be seen is what can be reached.
        reachable = {int(grid.component[scout.start]) for scout in self.scouts}
        self._n_seeable = int(np.isin(grid.component, list(reachable)).sum())
        self.hidden = {victim.id: victim.cell for victim in instance.victims}
        self.finds: list[Find] = []
        self.coverage: list[float] = []

    def look(self, cells: Sequence[Cell]) -> None:
        """Let the scouts, now at `cells`, look around them, one after the other."""
        for scout, cell in zip(self.scouts, cells, strict=True):
            # A second look from the same place shows nothing new: each field is computed once.
            view = (scout.visual_field_depth, cell)
            if view not in self._looked_from:
                self._looked_from.add(view)
                self._seen |= self._views[scout.visual_field_depth](cell)
                self._take_note(scout.id)
        self.coverage.append(int(np.count_nonzero(self._seen)) / self._n_seeable)

    def _take_note(self, scout: int) -> None:
        step = len(self.coverage)
        found = [victim for victim, cell in self.hidden.items() if self._seen[cell]]
        for victim in found:
            del self.hidden[victim]
            self.finds.append(Find(victim=victim, scout=scout, step=step))

    def verdict(self, max_steps: int, stop: str) -> Ended | None:
        """Why the search ends after the last look, or `None` if it goes on."""
        if stop == "covered_or_found" and self.finds and not self.hidden:
            return "all victims found"
        if self.coverage[-1] == 1:
            return "covered"
        if len(self.coverage) > max_steps:
            return "step limit"
        return None


def _neighbours(grid: GridMap) -> Callable[[Cell], tuple[Cell, ...]]:
    """Look up the free neighbours of a cell: up, down, left, right."""

    @cache
    def neighbours(cell: Cell) -> tuple[Cell, ...]:
        row, col = cell
        around = ((row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1))
        return tuple(beside for beside in around if grid.is_free(beside))

    return neighbours


def _check_options(walk: str, seed: int, max_steps: int | None, stop: str) -> None:
    if walk not in WALKS:
        raise InputError(
            f"unknown walk {walk!r}{meant(walk, WALKS)}; there are {', '.join(WALKS)}", field="walk"
        )
    if stop not in STOPS:
        raise InputError(
            f"unknown condition {stop!r}{meant(stop, STOPS)}; there are {', '.join(STOPS)}",
            field="stop",
        )
    if not 0 <= seed < 2**32:
        raise InputError(f"{seed}; give an integer from 0 to 2**32 - 1", field="seed")
    if max_steps is not None and max_steps < 0:
        raise InputError(f"{max_steps}; give no fewer than 0 steps", field="max_steps")
