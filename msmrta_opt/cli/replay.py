"""The command replay: a plan or a run, or two in step, as one file that any browser plays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from ..mission.run import Run

MAX_PLANS = 2


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(replay)


def replay(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="A plan or a run, or two to be played in step; and an instance, if they must be "
            "for it.",
            metavar="PLAN|RUN [PLAN|RUN] [INSTANCE]",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write the page here: .html.", metavar="FILE"),
    ] = None,
    gif: Annotated[
        Path | None, typer.Option(help="Write a film here: .gif.", metavar="FILE")
    ] = None,
    mp4: Annotated[
        Path | None, typer.Option(help="Write a film here: .mp4; needs ffmpeg.", metavar="FILE")
    ] = None,
) -> None:
    """Write a replay of a plan or a run that any browser plays, without a network; or a film of it.

    Scouting, then the robots with their trails, victims as they are served, and a timeline to drag; of a
    run what came in between, and what was decided then. What does not hold is not shown.
    """
    from ..mission.errors import InputError
    from ..plots import plot_replay
    from .outputs import check_outputs

    outputs = {".html": output, ".gif": gif, ".mp4": mp4}
    for suffix, file in outputs.items():
        if file is not None and file.suffix.lower() != suffix:
            raise InputError(f"unknown format {file.suffix!r}; give a {suffix} file", file=file)
    asked = [file for file in outputs.values() if file is not None]
    if not asked:
        raise InputError("nothing to write; give -o FILE.html, --gif or --mp4", field="--output")
    check_outputs(*asked, inputs=files)
    if mp4 is not None:
        from ..plots.replay.film import check_ffmpeg

        check_ffmpeg(mp4)
    plans, missions = _read(files)
    if not 1 <= len(plans) <= MAX_PLANS:
        raise InputError(f"{len(plans)} plans; give one or two", field="PLAN")
    for file, plan in plans.items():
        _check(file, plan, missions)
    labels = None if len(plans) == 1 else _labels(plans)
    made = plot_replay(*plans.values(), labels=labels)
    for file in asked:
        made.save(file)
        typer.echo(f"replay written to {file}")


def _read(files: Sequence[Path]) -> tuple[dict[Path, Plan | Run], list[Instance]]:
    from ..mission.errors import InputError
    from ..mission.instance import Instance
    from ..mission.plan import Plan
    from ..mission.run import Run
    from .outputs import document_format

    plans: dict[Path, Plan | Run] = {}
    missions: list[Instance] = []
    for file in files:
        kind = document_format(file).partition("/")[0]
        if kind not in ("msmrta-plan", "msmrta-run"):
            missions.append(Instance.read(file))
        elif file in plans:
            raise InputError("is given twice; give another plan", file=file)
        else:
            plans[file] = Plan.read(file) if kind == "msmrta-plan" else Run.read(file)
    return plans, missions


def _check(file: Path, shown: Plan | Run, missions: Sequence[Instance]) -> None:
    """Refuse a plan or a run that does not hold, or is for none of the missions that are given."""
    from ..certify import plan as of_plans
    from ..certify import run as of_runs
    from ..certify.same_mission import differences
    from ..mission.errors import CheckError
    from ..mission.plan import Plan

    if isinstance(shown, Plan):
        plan, wrong = shown, of_plans.problems(shown)
    else:
        plan, wrong = shown.plan, of_runs.problems(shown)
    if missions:
        closest = min((differences(plan, mission) for mission in missions), key=len)
        wrong += [f"the plan is for another mission: {line}" for line in closest]
    if wrong:
        more = f" (and {len(wrong) - 1} more; see msmrta check)" if len(wrong) > 1 else ""
        raise CheckError(f"{file}: {wrong[0]}{more}")


def _labels(plans: dict[Path, Plan | Run]) -> list[str]:
    """What tells two plans apart: the names of their files."""
    from ..plots.titles import says

    stems = {file.stem for file in plans}
    names = [file.stem if len(stems) == len(plans) else str(file) for file in plans]
    return [f"{name} ({says(plan)})" for name, plan in zip(names, plans.values(), strict=True)]
