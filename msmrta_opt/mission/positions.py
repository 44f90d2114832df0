"""Places in metres in documents of missions and scenarios, made cells of their map."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from .errors import InputError, at, shown
from .grid import Cell, GridMap
from .map_field import load_map, validated
from .ros_map import Coordinate
from .validation import said_of


class _Position(BaseModel):
    """A place in metres."""

    model_config = ConfigDict(extra="forbid")

    x: Coordinate
    y: Coordinate


def cells_of_positions(document: Any, context: dict[str, Any]) -> Any:
    """`document`, an instance's, with each place in metres replaced by the cell in which it lies.

    Parameters
    ----------
    document : object
        As JSON holds it; itself, if no place is in metres.
    context : dict
        Its ``folder`` is where the document lies; the map, if it is needed, is kept in ``map``.

    Raises
    ------
    InputError
        If the map has no frame, or a place is not on it.
    """
    if not isinstance(document, Mapping):
        return document
    places = [
        (group, i, field)
        for group, field in (("robots", "start"), ("victims", "cell"), ("scouts", "start"))
        if isinstance(document.get(group), (list, tuple))
        for i, member in enumerate(document[group])
        if isinstance(member, Mapping) and isinstance(member.get(field), Mapping)
    ]
    if not places:
        return document
    changed = dict(document)
    try:
        grid = context["map"] = load_map(changed.get("map"), Path(context.get("folder", ".")))
    except InputError as error:
        raise said_of("map", error) from None
    except ValueError as error:
        raise InputError(str(error), field="map") from None
    for group, i, field in places:
        members = changed[group] = list(changed[group])
        cell = _cell_of(members[i][field], grid, at(group, i, field))
        members[i] = {**members[i], field: cell}
    return changed


def cells_of_a_scenario(document: Any, grid: GridMap | None) -> Any:
    """`document`, a scenario's, with each place in metres replaced by the cell in which it lies.

    Parameters
    ----------
    document : object
        As TOML holds it; itself, if no place is in metres.
    grid : GridMap, optional
        The map of the mission that the scenario is for.

    Raises
    ------
    InputError
        If there is a place in metres and no map, or the map has no frame, or the place is not on it; or
        if it is a victim's and not free.
    """
    if not isinstance(document, Mapping):
        return document
    changed = dict(document)
    for i, victim in _tables(document, "victims"):
        if isinstance(place := victim.get("cell"), Mapping):
            victims = changed["victims"] = list(changed["victims"])
            victims[i] = {**victim, "cell": _cell_of(place, grid, at("victims", i, "cell"))}
    for i, corridor in _tables(document, "corridors"):
        places = corridor.get("cells")
        if isinstance(places, list) and any(isinstance(place, Mapping) for place in places):
            cells = [
                _cell_of(place, grid, at("corridors", i, "cells", j), free=False)
                if isinstance(place, Mapping)
                else place
                for j, place in enumerate(places)
            ]
            corridors = changed["corridors"] = list(changed["corridors"])
            corridors[i] = {**corridor, "cells": cells}
    return changed


def _tables(document: Mapping[str, Any], group: str) -> list[tuple[int, Mapping[str, Any]]]:
    """The tables of a group, each with its position; what is no table is left to be refused."""
    members = document.get(group)
    if not isinstance(members, (list, tuple)):
        return []
    return [(i, member) for i, member in enumerate(members) if isinstance(member, Mapping)]


def _cell_of(place: Any, grid: GridMap | None, where: str, *, free: bool = True) -> Cell:
    """The cell of a place in metres, named `where`; if so asked, a free one."""
    position: _Position = validated(_Position, place, where)
    if grid is None:
        raise InputError(
            f"{shown(place)}; metres need the map of one mission, so give a cell, [row, col]",
            field=where,
        )
    if grid.frame is None:
        raise InputError(
            f"{shown(place)}; this map has no frame, so give a cell, [row, col]", field=where
        )
    cell = grid.frame.cell(position.x, position.y)
    if not (grid.is_free(cell) if free else grid.contains(cell)):
        trouble = grid.trouble(cell, grid.frame.spot(position.x, position.y))
        raise InputError(f"x {position.x:g}, y {position.y:g} is {trouble}", field=where)
    return cell
