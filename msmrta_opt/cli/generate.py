"""The command generate: missions on known maps, files, and generated buildings, rubble and mazes."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from ..mission.counting import counted


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(generate)


def generate(
    map_: Annotated[
        str,
        typer.Option(
            "--map",
            metavar="MAP",
            help="A map's name (map0 to map3), a .map file, or one to generate: rooms, rubble or maze.",
        ),
    ],
    robots: Annotated[int, typer.Option(help="How many robots.")],
    victims: Annotated[int, typer.Option(help="How many victims.")],
    kinds: Annotated[
        int, typer.Option(help="How many kinds of help: the paper's six, then kind7, kind8, ….")
    ] = 6,
    per_robot: Annotated[
        str, typer.Option(metavar="LOW-HIGH", help="Kinds that a robot has.")
    ] = "1-3",
    per_victim: Annotated[
        str, typer.Option(metavar="LOW-HIGH", help="Kinds that a victim needs.")
    ] = "2-2",
    speeds: Annotated[
        str, typer.Option(metavar="SPEED,…", help="Cells per time unit, to draw from.")
    ] = "0.2,0.3,0.4",
    priorities: Annotated[
        str | None,
        typer.Option(metavar="LOW-HIGH", help="Priorities, whole numbers.  [default: all 1]"),
    ] = None,
    unreachable: Annotated[
        float, typer.Option(help="Share of the victims that no robot can reach.")
    ] = 0.0,
    unmeetable: Annotated[
        float, typer.Option(help="Share of the requirements of kinds that no robot has.")
    ] = 0.0,
    size: Annotated[
        str | None,
        typer.Option(
            metavar="ROWSxCOLS", help="Of a generated map, in cells; for a maze, odd numbers."
        ),
    ] = None,
    room: Annotated[
        int | None,
        typer.Option(
            help="rooms: minimum side of a room in cells; the maximum is twice that.  [default: 4]"
        ),
    ] = None,
    density: Annotated[
        float | None, typer.Option(help="rubble: share of blocked cells.  [default: 0.2]")
    ] = None,
    openings: Annotated[
        float | None,
        typer.Option(
            help="rooms, maze: share of neighbouring places, closed to each other once all are "
            "connected, that get an opening.  [default: rooms 0.1, maze 0]"
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of all random choices.")] = 0,
    name: Annotated[
        str | None, typer.Option(help="Of the mission.  [default: made of map, sizes and seed]")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write the mission here, not to standard output."),
    ] = None,
) -> None:
    """Generate a mission that can be solved, up to the shares asked not to be.

    Robots and victims stand on cells of their own in the largest connected region of the map, and
    every kind is had by some robot. Shares count exactly, to the nearest whole number. The same
    options give the same file on every machine.
    """
    import json

    from ..mission.files import write_text
    from ..mission.generate import generate_mission
    from ..mission.layouts import check_share, share_of
    from ..mission.named_maps import make_map
    from .outputs import check_outputs

    check_outputs(output, inputs=[Path(map_)])
    check_share(unreachable, "unreachable")
    layout: dict[str, Any] = {"room": room, "density": density, "openings": openings}
    if size is not None:
        layout["size"] = _numbers(r"(\d+)x(\d+)", size, "--size", "ROWSxCOLS")
    grid = make_map(
        map_,
        seed=seed,
        # Negative counts are refused with the mission.
        n_cut_off=share_of(unreachable, max(victims, 0)),
        **{option: value for option, value in layout.items() if value is not None},
    )
    mission = generate_mission(
        grid,
        robots,
        victims,
        seed=seed,
        kinds=kinds,
        per_robot=_range(per_robot, "--per-robot"),
        per_victim=_range(per_victim, "--per-victim"),
        speeds=_speeds(speeds),
        priorities=None if priorities is None else _range(priorities, "--priorities"),
        unreachable=unreachable,
        unmeetable=unmeetable,
    )
    given = {
        "map": map_,
        "size": size,
        "room": room,
        "density": density,
        "openings": openings,
        "robots": robots,
        "victims": victims,
        "kinds": kinds,
        "per-robot": per_robot,
        "per-victim": per_victim,
        "speeds": speeds,
        "priorities": priorities,
        "unreachable": unreachable,
        "unmeetable": unmeetable,
        "seed": seed,
        "name": name,
    }
    words = [word for key, x in given.items() if x is not None for word in (f"--{key}", str(x))]
    mission = mission.replace(
        name=mission.name if name is None else name,
        source=shlex.join(["msmrta", "generate", *words]),
    )
    # The map is written out, so that the file is the same wherever it lies.
    text = json.dumps(mission.document(), indent=1) + "\n"
    if output is None:
        print(text, end="")
        return
    write_text(output, text)
    print(
        f"mission written to {output}: {counted(mission.n_robots, 'robot')}, "
        f"{counted(mission.n_victims, 'victim')}; "
        f"{mission.description}"
    )


def _range(text: str, field: str) -> tuple[int, int]:
    return _numbers(r"(\d+)-(\d+)", text, field, "LOW-HIGH, such as 1-3")


def _numbers(pattern: str, text: str, field: str, right: str) -> tuple[int, int]:
    from ..mission.errors import InputError

    # More digits than any number here can have would not be read.
    found = re.fullmatch(pattern, text, flags=re.ASCII)
    if not found or len(text) > 40:
        raise InputError(f"{text!r}; give {right}", field=field)
    first, second = found.groups()
    return int(first), int(second)


def _speeds(text: str) -> list[float]:
    from ..mission.errors import InputError

    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"{text!r}; give numbers, such as 0.2,0.3", field="--speeds") from None
