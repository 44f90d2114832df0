"""The command convergence: how the searches behind plans closed in."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import Json

Picture = Annotated[
    Path | None,
    typer.Option("--figure", "-o", help="Write the picture here: .png, .svg or .pdf."),
]


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(convergence)


def convergence(
    plans: Annotated[
        list[Path],
        typer.Argument(metavar="PLAN…", help="Plan files, as exact --json writes them."),
    ],
    json: Json = None,
    figure: Picture = None,
) -> None:
    """Show incumbent and bound of exact plans over time, several in one picture."""
    from ..mission.convergence import Convergence
    from ..mission.plan import Plan
    from .console import number, say, table, write_json
    from .outputs import check_outputs, write_picture

    check_outputs(json, figure=figure, inputs=plans)
    short = {file.stem for file in plans}
    names = [file.stem if len(short) == len(plans) else str(file) for file in plans]
    found = Convergence({name: Plan.read(file) for name, file in zip(names, plans, strict=True)})
    write_json(json, {"searches": found.summary, "steps": found.rows}, what="searches")
    if figure is not None:
        write_picture(figure, found.plot)
    for name, search in found.searches.items():
        table(
            f"{name}: {search.objective} over time",
            ["seconds", "incumbent", "bound", "gap", "what happened"],
            [
                (f"{x.seconds:.3f}", x.incumbent, x.bound, _share(x.gap), x.event)
                for x in search.steps
            ],
        )
    for row in found.summary:
        bound = "no bound" if row["bound"] is None else f"bound {number(row['bound'])}"
        say(
            f"{row['plan']}: {number(row['incumbent'])} after {row['best after (s)']:.2f} s, "
            f"{bound}, gap {_share(row['gap'])} after {row['seconds']:.2f} s."
        )


def _share(gap: float | None) -> str:
    return "–" if gap is None else f"{gap:.2%}"
