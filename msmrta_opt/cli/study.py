"""The commands study run, status, export and report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .missions import Json

if TYPE_CHECKING:
    from ..studies.study import State

NOTHING = 1
"""The exit status of a study of which every run failed."""
StudyFile = Annotated[Path, typer.Argument(help="A study file.", metavar="STUDY.toml")]


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    group = typer.Typer(
        help="Studies: planners or formulations × instances × options, resumable and parallel."
    )
    for command in (run, status, export, report):
        group.command()(command)
    app.add_typer(group, name="study")


def run(
    study: StudyFile,
    jobs: Annotated[
        int, typer.Option(help="Runs at a time; 1 for comparable times.", min=1, metavar="N")
    ] = 1,
    dask: Annotated[
        str | None, typer.Option(help="Run on this Dask cluster.", metavar="tcp://HOST:PORT")
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Do failed runs again.")] = False,
    json: Json = None,
) -> None:
    """Do all runs of a study that are not done yet; what is finished is kept, whatever happens."""
    from tqdm import tqdm

    from ..studies.study import study as open_study
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, inputs=[study, study.with_suffix(".sqlite")])
    asked = open_study(study)
    execute = None
    if dask is not None:
        from ..studies.cluster import on_cluster

        execute = on_cluster(dask)
    with asked.running(execute=execute, jobs=jobs, retry=retry) as (todo, n_open, results):
        say(f"{len(todo)} runs, {len(todo) - n_open} of them done before; ledger {asked.ledger}")
        n_failed = 0
        bar = tqdm(total=n_open, desc="running", unit="run", disable=None, smoothing=0.05)
        try:
            with bar:
                for record in results:
                    n_failed += record.failed
                    bar.update()
                    bar.set_postfix(failed=n_failed, refresh=False)
        except KeyboardInterrupt:
            results.close()
            kept = asked.state()
            _show(kept, json)
            left = sum(row["open"] for row in kept.rows)
            say(f"interrupted: {len(todo) - left} of {len(todo)} runs are kept.")
            say(f"To go on from there: msmrta study run {study}")
            raise
    kept = asked.state()
    _show(kept, json)
    if kept.runs and all(row["failed"] == row["all"] for row in kept.rows):
        first = next(record.reason for record in kept.records)
        typer.echo(f"error: {study}: every run failed; the first: {first}", err=True)
        raise typer.Exit(NOTHING)


def status(study: StudyFile, json: Json = None) -> None:
    """Show what of a study is done, what failed and why, and what is left."""
    from ..studies.study import study as open_study
    from .console import say
    from .outputs import check_outputs

    check_outputs(json, inputs=[study, study.with_suffix(".sqlite")])
    state = open_study(study).state()
    _show(state, json)
    if state.n_others:
        say(f"{state.n_others} more runs in the ledger are of other settings or versions.")


def export(
    study: StudyFile,
    csv: Annotated[Path | None, typer.Option(help="Write the runs here.")] = None,
    parquet: Annotated[Path | None, typer.Option(help="Write the runs here.")] = None,
    json: Json = None,
) -> None:
    """Write the runs of a study as a table, a row a run."""
    from ..mission.errors import InputError
    from ..studies.record import frame
    from ..studies.study import study as open_study
    from .console import write_json
    from .outputs import check_outputs, check_parquet, write_table

    if csv is None and parquet is None and json is None:
        raise InputError("nothing to write; give --csv, --parquet or --json", field="export")
    check_outputs(csv, parquet, json, inputs=[study, study.with_suffix(".sqlite")])
    check_parquet(parquet)
    records = open_study(study).state().records
    table = frame(records).convert_dtypes()
    what = f"{len(records)} runs"
    write_table(table, csv, parquet, what=what)
    write_json(json, table.astype(object).where(table.notna(), None).to_dict("records"), what=what)


def report(
    study: StudyFile,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The folder.  [default: STUDY-report]"),
    ] = None,
) -> None:
    """Write the report of a study: one HTML file, with its pictures and their data beside it."""
    from ..studies.study import study as open_study
    from .console import say

    asked = open_study(study)
    page = asked.report(output)
    state = asked.state()
    say(f"report of {len(state.records)} of {len(state.runs)} runs written to {page}")


def _show(state: State, json: Path | None) -> None:
    from .console import say, table, write_json

    write_json(json, {"runs": state.rows, "failures": state.failures, "others": state.n_others})
    table(
        "Runs",
        ["contender", "all", "finished", "failed", "open"],
        [tuple(row.values()) for row in state.rows],
    )
    if failures := state.failures:
        table("Failures", list(failures[0]), [tuple(row.values()) for row in failures])
        say("Failed runs are kept as they are; --retry does them again.")
