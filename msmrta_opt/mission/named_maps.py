"""Maps by name: those of `instances/maps`, files, and layouts to generate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import InputError
from .grid import GridMap
from .layouts import cells_out_of_reach, maze, rooms, rubble, with_pocket
from .map_files import read_map_file
from .maps import read_map
from .shipped import shipped_folder
from .suggestions import meant

LAYOUTS = {
    "rooms": ("size", "room", "openings"),
    "rubble": ("size", "density"),
    "maze": ("size", "openings"),
}
"""Maps to generate, and their options."""


def named_maps() -> dict[str, Path]:
    """The map files that come with the package, by name."""
    return {path.stem: path for path in sorted((shipped_folder() / "maps").glob("*.map"))}


def find_map(name_or_file: str | Path, **floor: Any) -> GridMap:
    """The map of a name in `named_maps`, or of a file.

    Parameters
    ----------
    name_or_file : str or path
        A file is a ``.map``, a ``map.yaml`` or an image.
    **floor
        How the floor in a ``map.yaml`` or an image becomes cells, see `read_floor_map`.

    Raises
    ------
    InputError
        If it is neither, or the file is not a map.
    """
    known = named_maps()
    if str(name_or_file) in known:
        return read_map(known[str(name_or_file)])
    if not Path(name_or_file).exists():
        raise InputError(
            f"{str(name_or_file)!r} is no file and no known map{meant(name_or_file, known)};"
            f" known: {', '.join(known)}",
            field="map",
        )
    return read_map_file(name_or_file, **floor)


def make_map(
    name_or_file: str | Path,
    *,
    seed: int,
    n_cut_off: int = 0,
    size: tuple[int, int] | None = None,
    **options: float,
) -> GridMap:
    """The map of a layout's name, generated; or of a name in `named_maps`, or of a file.

    Parameters
    ----------
    name_or_file : str or path
        A layout is one of `LAYOUTS`.
    seed : int
        Determines a generated map.
    n_cut_off : int
        Free cells out of reach that a generated map has at least.
    size : (n_rows, n_cols), optional
        Of a generated map, in cells.
    **options
        Of the layout, see `LAYOUTS`.

    Raises
    ------
    InputError
        If there is no such map, or an option is not for it, missing, or out of range.
    """
    layout = str(name_or_file)
    given = dict(options) if size is None else {"size": size, **options}
    for option in given:
        if option not in LAYOUTS.get(layout, ()):
            users = " or ".join(name for name, has in LAYOUTS.items() if option in has)
            raise InputError(f"not for map {layout}; it is for {users}", field=option)
    if layout not in LAYOUTS:
        return find_map(name_or_file)
    if size is None:
        raise InputError(f"missing; map {layout} needs one, rows and columns", field="size")
    makers: dict[str, Callable[..., GridMap]] = {"rooms": rooms, "rubble": rubble, "maze": maze}
    grid = makers[layout](*size, seed=seed, **options)
    short = n_cut_off - cells_out_of_reach(grid)
    return with_pocket(grid, short, seed=seed) if short > 0 else grid
