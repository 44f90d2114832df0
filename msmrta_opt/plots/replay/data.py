"""A plan as the page of a replay reads it: small, and in whole words where they cost little.

Walls are runs along the rows, free cells first, and walks are moves with their counts, ``"R3D"`` for
three to the right and one down: 100 robots and 1,000 victims on 256 × 256 cells take half a megabyte.
Kinds, stages and victims are referred to by position; all times are the plan's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise
from typing import Any

import numpy as np

from ...mission.errors import InputError, at
from ...mission.grid import Cell, GridMap
from ...mission.plan import Plan, ScoutingReport, Visit
from ..style import STAGES, RobotStyle, robot_styles

MOVES = {(0, 1): "R", (1, 0): "D", (0, -1): "L", (-1, 0): "U", (0, 0): "S"}
"""By rows and columns moved; a scout without a free neighbour stays."""


def document(plan: Plan) -> dict[str, Any]:
    """What the page shows of `plan`, JSON-ready.

    Raises
    ------
    InputError
        If a robot or a scout jumps, or visits begin elsewhere than where it is.
    """
    mission, figures = plan.instance, plan.metrics
    kinds = {kind: k for k, kind in enumerate(mission.capabilities)}
    stages = list(dict.fromkeys(visit.stage for route in plan.routes for visit in route.visits))
    # The paper's stages in their order; those of others in the order in which they are met.
    stages.sort(key=lambda name: list(STAGES).index(name) if name in STAGES else len(STAGES))
    return {
        "name": mission.name or "unnamed mission",
        "shape": list(mission.map.shape),
        "walls": wall_runs(mission.map),
        "kinds": list(kinds),
        "stages": [{"name": name, "title": STAGES.get(name, name)} for name in stages],
        "robots": _robots(plan, kinds, stages),
        "victims": _victims(plan, kinds),
        "clusters": [
            {"centre": cluster.centre, "victims": cluster.victims, "robots": cluster.robots}
            for cluster in plan.clusters
        ],
        "scouting": None if plan.scouting is None else _scouting(plan.scouting),
        "makespan": figures.makespan,
        "totalTime": figures.total_time,
        "distance": figures.distance,
        "available": figures.n_available,
    }


def wall_runs(grid: GridMap) -> list[int]:
    """Cells in a row of the same sort, along the rows one after the other; the first run is free."""
    blocked = ~grid.free.ravel()
    edges = np.flatnonzero(np.diff(blocked)) + 1
    runs = np.diff(np.concatenate([[0], edges, [blocked.size]])).tolist()
    return [0, *runs] if blocked[0] else list(runs)


def walk_code(cells: Sequence[Cell], field: str = "cells") -> str:
    """The moves of a walk, as letters with their counts where they are more than one.

    Raises
    ------
    InputError
        If two cells that follow each other do not share a side.
    """
    letters = []
    for here, there in pairwise(cells):
        move = MOVES.get((there[0] - here[0], there[1] - here[1]))
        if move is None:
            raise InputError(
                f"from {list(here)} to {list(there)} is not one move; give neighbours", field=field
            )
        letters.append(move)
    runs = ((letter, len(list(run))) for letter, run in groupby(letters))
    return "".join(letter if count == 1 else f"{letter}{count}" for letter, count in runs)


def _robots(plan: Plan, kinds: dict[str, int], stages: list[str]) -> list[dict[str, Any]]:
    styles = robot_styles(plan.instance)
    position = {victim.id: v for v, victim in enumerate(plan.instance.victims)}
    numbers = {route.robot: number for number, route in enumerate(plan.routes)}
    robots = []
    for robot in plan.instance.robots:
        number = numbers.get(robot.id)
        here, visits, back, home = robot.start, [], "", 0.0
        for i, visit in enumerate(plan.routes[number].visits if number is not None else ()):
            field = at("routes", number or 0, "visits", i, "cells")
            visits.append(
                {
                    "victim": position[visit.victim],
                    "kinds": [kinds[kind] for kind in visit.served],
                    "stage": stages.index(visit.stage),
                    "walk": walk_code(_from(here, visit, field), field),
                    "arrival": visit.arrival,
                    "departure": visit.departure,
                }
            )
            here, home = visit.cells[-1], visit.departure
        if number is not None and plan.routes[number].back:
            cells = plan.routes[number].back
            back = walk_code((here, *cells[1:]), at("routes", number, "back"))
            home += (len(cells) - 1) / robot.speed
        robots.append(
            {
                "id": robot.id,
                "start": list(robot.start),
                "speed": robot.speed,
                "can": [kinds[kind] for kind in robot.capabilities],
                **look(styles[robot.id]),
                "visits": visits,
                "back": back,
                "home": home,
            }
        )
    return robots


def _from(here: Cell, visit: Visit, field: str) -> tuple[Cell, ...]:
    if visit.cells[0] != here:
        raise InputError(
            f"begins at {list(visit.cells[0])}, not where the robot is, {list(here)}", field=field
        )
    return visit.cells


def look(style: RobotStyle) -> dict[str, Any]:
    """How a robot looks: its colour, that of letters on it, the dashes of its line."""
    dash = [] if isinstance(style.line, str) else list(style.line[1])
    return {"colour": style.colour, "ink": style.ink, "dash": dash}


def _victims(plan: Plan, kinds: dict[str, int]) -> list[dict[str, Any]]:
    unserved: dict[int, dict[int, str]] = {}
    for item in plan.unserved:
        unserved.setdefault(item.victim, {})[kinds[item.kind]] = str(item.reason)
    return [
        {
            "id": victim.id,
            "cell": list(victim.cell),
            "priority": victim.priority,
            "needs": [kinds[kind] for kind in victim.requirements],
            "unserved": unserved.get(victim.id, {}),
        }
        for victim in plan.instance.victims
    ]


def _scouting(report: ScoutingReport) -> dict[str, Any]:
    return {
        "scouts": [
            {
                "id": track.scout,
                "depth": track.visual_field_depth,
                "start": list(track.cells[0]),
                "walk": walk_code(track.cells, at("scouting", "tracks", i, "cells")),
            }
            for i, track in enumerate(report.tracks)
            if track.cells
        ],
        "finds": [[find.victim, find.scout, find.step] for find in report.finds],
        "missed": list(report.not_found),
        "coverage": [round(share, 4) for share in report.coverage],
        "ended": report.ended,
    }
