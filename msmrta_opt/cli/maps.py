"""Commands about maps: what became of a floor, and a mission on it to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..mission.counting import counted, rows_by_columns
from .console import Json

CellSize = Annotated[
    float | None, typer.Option(help="Side of a cell in metres; a floor needs one.")
]
RobotRadius = Annotated[float, typer.Option(help="Of the robots, in metres.")]
Unknown = Annotated[str, typer.Option(help="How unknown space counts: blocked or free.")]
Resolution = Annotated[
    float | None, typer.Option(help="Metres per pixel of an image; a map.yaml has its own.")
]
Seed = Annotated[int, typer.Option(help="Of all random choices.")]


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    app.command("map")(show_map)
    app.command()(new_mission)


def show_map(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A map.yaml, an image, or a .map.")],
    cell_size: CellSize = None,
    robot_radius: RobotRadius = 0.0,
    unknown: Unknown = "blocked",
    resolution: Resolution = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write the cells here, as a .map file.")
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(help="Write a picture here, before and after: .png, .svg or .pdf."),
    ] = None,
    json: Json = None,
) -> None:
    """Show what cells a map has, and what became of the floor that they were made of.

    A floor is a map.yaml of ROS or an image; white is free. A cell is free if a robot of the given
    radius fits into it and can go to each of its free neighbours.
    """
    from ..mission.map_files import is_floor, read_floor_map, read_map_file
    from ..mission.maps import write_map
    from .console import say, table, write_json
    from .outputs import check_outputs, write_picture

    check_outputs(output, json, figure=figure, inputs=[file])
    options = _floor_options(cell_size, robot_radius, unknown, resolution)
    rows: list[tuple[Any, ...]] = []
    facts: dict[str, Any] = {}
    if is_floor(file):
        made = read_floor_map(file, **options)
        floor, grid = made.floor, made.grid
        n_rows, n_cols = floor.state.shape
        off_centre = grid.frame.off_centre if grid.frame is not None else ()
        rows += [
            ("pixels", f"{rows_by_columns((n_rows, n_cols))} of {floor.resolution:g} m"),
            (
                "height × width",
                f"{n_rows * floor.resolution:g} × {n_cols * floor.resolution:g} m",
            ),
            *((f"{name} pixels", f"{share:.1%}") for name, share in floor.share.items()),
            (
                "the robot fits on",
                f"{made.area:.2f} m² in {made.n_regions} region{'s' * (made.n_regions != 1)}",
            ),
            ("left out by the cells", f"{made.left_out:.2f} m²"),
            ("cells with poses off the centre", str(len(off_centre))),
        ]
        facts = {
            "pixels": [n_rows, n_cols],
            "resolution": floor.resolution,
            "shares": dict(floor.share),
            "area": made.area,
            "area_regions": made.n_regions,
            "left_out": made.left_out,
            "off_centre": len(off_centre),
        }
    else:
        grid = read_map_file(file, **options)
    sizes = sorted(_sizes(grid.component), reverse=True)
    rows += [
        ("cells", rows_by_columns(grid.shape)),
        ("free cells", f"{int(grid.free.sum())} ({grid.free.mean():.1%})"),
        ("regions", f"{len(sizes)}, of {', '.join(map(str, sizes[:5]))}{', …' * (len(sizes) > 5)}"),
    ]
    facts |= {
        "name": grid.name,
        "cells": list(grid.shape),
        "free_cells": int(grid.free.sum()),
        "regions": sizes,
    }
    write_json(json, facts)
    if output is not None:
        write_map(grid, output)
        say(f"map written to {output}")
    if figure is not None:
        from ..plots import plot_floor, plot_map

        write_picture(figure, lambda: plot_floor(made) if is_floor(file) else plot_map(grid))
    table(f"Map {grid.name}", ["what", "value"], rows)


def new_mission(
    map_: Annotated[
        str,
        typer.Option(
            "--map", metavar="MAP", help="A map.yaml, an image, a .map file, or map0 to map3."
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Write the mission here.")],
    robots: Annotated[
        str | None,
        typer.Option(
            metavar="N or FILE.csv",
            help="Robots at random, or those of a file: x, y (or row, col), id, speed, capabilities."
            "  [default: 1]",
        ),
    ] = None,
    victims: Annotated[
        str | None,
        typer.Option(
            metavar="N or FILE.csv",
            help="Victims at random, or those of a file: x, y (or row, col), id, requirements, "
            "priority.  [default: 0]",
        ),
    ] = None,
    robot: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE,…",
            help="A robot, such as x=1.5,y=2,speed=0.4,capabilities=FirstAids+Defuser.",
        ),
    ] = None,
    victim: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE,…", help="A victim, such as row=3,col=7,requirements=Defuser."
        ),
    ] = None,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=TIME", help="A kind of help and its service time.  [default: the paper's]"
        ),
    ] = None,
    snap: Annotated[
        float, typer.Option(help="Metres by which a place in a wall may be moved.")
    ] = 0.0,
    cell_size: CellSize = None,
    robot_radius: RobotRadius = 0.0,
    unknown: Unknown = "blocked",
    resolution: Resolution = None,
    name: Annotated[str, typer.Option(help="Of the mission.  [default: the map's]")] = "",
    seed: Seed = 0,
) -> None:
    """Write a mission on a map, to edit.

    Places are given by x and y in metres, on maps that have them, or by row and col. A robot without
    capabilities has all kinds; a victim without requirements needs the first.
    """
    import json

    from ..mission.draft import ROBOT_FIELDS, VICTIM_FIELDS, draft_mission
    from ..mission.files import write_text
    from ..mission.generate import SERVICE_TIME
    from ..mission.named_maps import find_map
    from .outputs import check_outputs

    n_robots = _count(robots, "--robots", 1)
    n_victims = _count(victims, "--victims", 0)
    files = [robots] * (n_robots is None) + [victims] * (n_victims is None)
    check_outputs(output, inputs=[Path(x) for x in (map_, *files) if x is not None])
    mission = draft_mission(
        find_map(map_, **_floor_options(cell_size, robot_radius, unknown, resolution)),
        _members(robots, robot, ROBOT_FIELDS, "robot", 1),
        _members(victims, victim, VICTIM_FIELDS, "victim", 0),
        service_time=_kinds(kind) if kind else SERVICE_TIME,
        snap=snap,
        seed=seed,
        name=name,
    )
    write_text(output, json.dumps(mission.document(), indent=1) + "\n")
    print(
        f"mission written to {output}: {counted(mission.n_robots, 'robot')}, "
        f"{counted(mission.n_victims, 'victim')}"
    )


def _floor_options(
    cell_size: float | None, robot_radius: float, unknown: str, resolution: float | None
) -> dict[str, Any]:
    given = {"cell_size": cell_size, "resolution": resolution}
    options: dict[str, Any] = {key: x for key, x in given.items() if x is not None}
    if robot_radius:
        options["robot_radius"] = robot_radius
    if unknown != "blocked":
        options["unknown"] = unknown
    return options


def _members(
    given: str | None, typed: list[str] | None, fields: tuple[str, ...], what: str, default: int
) -> int | list[dict[str, str]]:
    """How many to draw, or the rows of a file and those typed."""
    from ..mission.errors import InputError
    from ..mission.places import read_places, typed_place

    rows: list[dict[str, str]] = []
    for text in typed or ():
        try:
            rows.append(typed_place(text, fields))
        except InputError as error:
            raise InputError(error.problem, field=f"--{what}") from None
    count = _count(given, f"--{what}s", default)
    if given is not None and count is None:
        return [*read_places(given, fields), *rows]
    if given is not None and rows:
        raise InputError(
            f"a number beside --{what}; give a file, or leave it out", field=f"--{what}s"
        )
    return rows or (default if count is None else count)


def _count(given: str | None, option: str, least: int) -> int | None:
    """The number given, `least` or more; none if it is a file or nothing."""
    from ..mission.errors import InputError

    if given is None:
        return None
    try:
        number = float(given)
    except ValueError:
        return None
    if not (given.isascii() and given.isdigit() and least <= number < 1e9):
        raise InputError(
            f"{given}; give a whole number, {least} or more, or a CSV file", field=option
        )
    return int(given)


def _kinds(texts: list[str]) -> dict[str, float]:
    from ..mission.errors import InputError
    from ..mission.places import number

    found: dict[str, float] = {}
    for text in texts:
        name, equals, time = (part.strip() for part in text.partition("="))
        if not equals or not name or name in found:
            problem = "is given twice" if name in found else "give NAME=TIME, such as Defuser=10"
            raise InputError(f"{text!r}; {problem}", field="--kind")
        found[name] = number({"--kind": time}, "--kind")
    return found


def _sizes(component: Any) -> list[int]:
    """The cells of each region."""
    import numpy as np

    sizes: list[int] = np.bincount(component.ravel())[1:].tolist()
    return sizes
