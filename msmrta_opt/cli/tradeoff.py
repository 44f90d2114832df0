"""The command tradeoff: what a parameter does to a mission, piece by piece."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import Json
from .missions import Figure, InstanceFile, Seed
from .outputs import named_values
from .subjects import Folders, Options, Parameters, add_folders, values_of

if TYPE_CHECKING:
    from ..mission.metrics import Metrics
    from ..studies.analysis.tradeoff_results import Regions, Tradeoff


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(tradeoff)


def tradeoff(
    instance: InstanceFile,
    over: Annotated[
        str, typer.Option(help="A parameter: psi, beta, or a formulation's own; or psi,beta.")
    ] = "psi",
    model: Annotated[
        str | None, typer.Option(help="The formulation whose parameter it is, of Eq. 1 or Eq. 2.")
    ] = None,
    psi: Annotated[float | None, typer.Option(help="ψ while β runs.  [default: 0.95]")] = None,
    parameters: Parameters = None,
    options: Options = None,
    folders: Folders = None,
    seed: Seed = None,
    csv: Annotated[Path | None, typer.Option(help="Write the pieces here.")] = None,
    json: Json = None,
    figure: Figure = None,
    explore: Annotated[
        Path | None,
        typer.Option(
            help="Write a page on all plans over psi,beta here, to look around in.",
            metavar="FILE.html",
        ),
    ] = None,
) -> None:
    """Find every optimum over a parameter, or every plan over ψ and β, with exact values of change."""
    from ..interruption import interrupted, interruptible
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..studies.analysis import tradeoff as study
    from .console import say, write_json, writing
    from .outputs import check_outputs, write_picture

    check_outputs(csv, json, explore, figure=figure, inputs=[instance])
    add_folders(folders)
    given = {"psi": psi, "seed": seed, **named_values(options), **values_of(parameters)}
    chosen: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    mission = Instance.read(instance)
    names = sorted(name.strip() for name in over.split(","))
    if len(names) > 1 and names != ["beta", "psi"]:
        raise InputError(f"{over!r}; give one parameter, or psi,beta", field="--over")
    if len(names) > 1 and model is not None:
        raise InputError("goes with one parameter", field="--model")
    if explore is not None:
        if len(names) == 1:
            raise InputError("is of two parameters; give --over psi,beta", field="--explore")
        if explore.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"unknown format {explore.suffix!r}; give .html", file=explore)
    with interruptible():
        if len(names) > 1:
            regions = study.tradeoff_regions(mission, **chosen)
            rows = _region_rows(regions)
        else:
            result = study.tradeoff(mission, names[0], model=model, **chosen)
            rows = _segment_rows(result)
        # Files first: whatever becomes of the screen, what was found is kept.
        if csv is not None:
            _write_csv(rows, csv)
        write_json(json, regions.document() if len(names) > 1 else result.document(), what="pieces")
        if figure is not None:
            from ..studies.analysis.tradeoff_pages import regions_figure, tradeoff_figure

            write_picture(
                figure,
                lambda: regions_figure(regions) if len(names) > 1 else tradeoff_figure(result),
            )
        if explore is not None:
            from ..studies.analysis.plan_space import PlanSpace

            with writing("page", explore):
                PlanSpace(regions).save(explore)
        if len(names) > 1:
            _show_regions(regions, rows)
        else:
            _show_segments(result, rows)
        if interrupted():
            say(f"interrupted: what is shown of {over} is not all there is")
            raise KeyboardInterrupt


def _segment_rows(result: Tradeoff) -> list[dict[str, object]]:
    return [
        {
            "from": _short(segment.low),
            "to": _short(segment.high),
            "value": f"{float(segment.value(segment.low)):.6g} … "
            f"{float(segment.value(segment.high)):.6g}",
            "slope": _short(segment.slope),
            f"at {_short(result.span[0])}": _short(segment.objectives[0]),
            f"at {_short(result.span[1])}": _short(segment.objectives[1]),
            "robots take": ", ".join(name or "∅" for name in result.named(segment.assignment)),
            "optimum": "unique" if segment.unique else "one of several",
            **_figures(segment.metrics),
        }
        for segment in result.segments
    ]


def _region_rows(regions: Regions) -> list[dict[str, object]]:
    number = {plan.routes: n + 1 for n, plan in enumerate(regions.plans)}
    return [
        {
            "psi": f"{_short(region.psi[0])} … {_short(region.psi[1])}",
            "beta": f"{_short(region.beta[0])} … {_short(region.beta[1])}",
            "plan": number[region.plan.routes],
            "optimum": "unique" if region.unique else "one of several",
            **_figures(region.plan.metrics),
        }
        for region in regions.regions
    ]


def _figures(metrics: Metrics) -> dict[str, object]:
    from ..mission.metrics import metrics_of

    return {metric.heading: metric.of(metrics) for metric in metrics_of("plans")}


def _show_segments(result: Tradeoff, rows: list[dict[str, object]]) -> None:
    from ..mission.counting import counted
    from .console import say, table

    columns = list(rows[0])
    title = f"{result.model} over {result.over}: {counted(len(rows), 'piece')}, {result.sense}"
    table(title, columns, [tuple(row.values()) for row in rows])
    for t, assignments in result.ties.items():
        more = " or more" if t in result.more_ties else ""
        say(f"At {result.over} = {_short(t)}, {len(assignments)}{more} assignments are optimal:")
        for assignment in assignments:
            say(f"  {', '.join(name or '∅' for name in result.named(assignment))}")
    points = [
        (
            _short(point.line.at_zero),
            _short(point.line.at_one),
            "yes" if point.supported else "no: no weight reaches it",
            ", ".join(name or "∅" for name in result.named(assignment)),
        )
        for point, assignment in zip(
            result.frontier.points, result.frontier_assignments, strict=True
        )
    ]
    table(
        "Points that nothing dominates" + ("" if result.frontier.complete else " (not all)"),
        [*(f"at {_short(end)}" for end in result.span), "supported", "robots take"],
        points,
    )
    exact = "exact fractions" if result.exact else "to a relative 1e-9: the data are not rational"
    say(f"Breakpoints are {exact}; {result.n_solves} solves found and closed the pieces.")


def _show_regions(regions: Regions, rows: list[dict[str, object]]) -> None:
    from .console import say, table

    table("Regions of the square of ψ and β", list(rows[0]), [tuple(r.values()) for r in rows])
    exact = "exact" if regions.exact else "to a relative 1e-9"
    say(
        f"{len(rows)} regions, {len(regions.plans)} different plans; borders are {exact};"
        f" {regions.n_solves} solves."
    )


def _write_csv(rows: list[dict[str, object]], path: Path) -> None:
    import pandas as pd

    from ..mission.files import write_with
    from .console import writing

    with writing("table", path):
        write_with(path, lambda file: pd.DataFrame(rows).to_csv(file, index=False))


def _short(number: Fraction) -> str:
    """A fraction with its decimal where the fraction is short, else the decimal."""
    if number.denominator == 1:
        return str(number)
    decimal = f"{float(number):.6g}"
    return f"{number} ({decimal})" if number.denominator < 10_000 else decimal
