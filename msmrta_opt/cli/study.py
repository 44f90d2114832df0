"""The commands study run, status, export and report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .missions import Json

if TYPE_CHECKING:
    from ..studies.record import Record
    from ..studies.runs import Run
    from ..studies.specification import Study

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
) -> None:
    """Do all runs of a study that are not done yet; what is finished is kept, whatever happens."""
    from contextlib import closing

    from tqdm import tqdm

    from ..studies.ledger import Ledger
    from ..studies.runner import pending, run_study
    from ..studies.runs import runs
    from ..studies.specification import Study
    from .console import say

    asked = Study.read(study)
    todo = runs(asked)
    execute = None
    if dask is not None:
        from ..studies.cluster import on_cluster

        execute = on_cluster(dask)
    with Ledger(asked.ledger) as ledger:
        n_open = len(pending(asked, todo, ledger, retry=retry))
        say(f"{len(todo)} runs, {len(todo) - n_open} of them done before; ledger {asked.ledger}")
        n_failed = 0
        results = run_study(asked, todo, ledger, execute=execute, jobs=jobs, retry=retry)
        bar = tqdm(total=n_open, desc="running", unit="run", disable=None, smoothing=0.05)
        try:
            with closing(results), bar:
                for record in results:
                    n_failed += record.failed
                    bar.update()
                    bar.set_postfix(failed=n_failed, refresh=False)
        except KeyboardInterrupt:
            left = len(pending(asked, todo, ledger, retry=retry))
            say(f"interrupted: {len(todo) - left} of {len(todo)} runs are kept.")
            say(f"To go on from there: msmrta study run {study}")
            raise
        _show_status(todo, {record.key: record for record in ledger.records()})


def status(study: StudyFile) -> None:
    """Show what of a study is done, what failed and why, and what is left."""
    from ..studies.ledger import Ledger
    from ..studies.runs import runs
    from ..studies.specification import Study
    from .console import say

    asked = Study.read(study)
    with Ledger(asked.ledger, read_only=True) as ledger:
        todo = runs(asked, ledger.missions())
        known = {record.key: record for record in ledger.records()}
    _show_status(todo, known)
    others = len(known) - sum(run.key in known for run in todo)
    if others:
        say(f"{others} more runs in the ledger are of other settings or versions.")


def export(
    study: StudyFile,
    csv: Annotated[Path | None, typer.Option(help="Write the runs here.")] = None,
    parquet: Annotated[Path | None, typer.Option(help="Write the runs here.")] = None,
    json: Json = None,
) -> None:
    """Write the runs of a study as a table, a row a run."""
    from ..mission.errors import InputError
    from ..mission.files import write_with
    from ..studies.record import frame
    from .console import say
    from .outputs import check_outputs, check_parquet, write_table

    if csv is None and parquet is None and json is None:
        raise InputError("nothing to write; give --csv, --parquet or --json", field="export")
    check_outputs(csv, parquet, json, inputs=[study, study.with_suffix(".sqlite")])
    check_parquet(parquet)
    _, _, records = _read(study)
    table = frame(records).convert_dtypes()
    write_table(table, csv, parquet)
    if json is not None:
        write_with(json, lambda path: table.to_json(path, orient="records", indent=1))
    for path in (csv, parquet, json):
        if path is not None:
            say(f"{len(records)} runs written to {path}")


def report(
    study: StudyFile,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The folder.  [default: STUDY-report]"),
    ] = None,
) -> None:
    """Write the report of a study: one HTML file, with its pictures and their data beside it."""
    from ..studies.report import write_report
    from .console import say

    asked, todo, records = _read(study)
    folder = output or asked.path.with_name(f"{asked.path.stem}-report")
    page = write_report(asked, records, folder, expected=len(todo))
    say(f"report of {len(records)} of {len(todo)} runs written to {page}")


def _read(study: Path) -> tuple[Study, list[Run], list[Record]]:
    """A study, its runs, and the records there are of them, in the order of the runs."""
    from ..studies.ledger import Ledger
    from ..studies.runs import current, runs
    from ..studies.specification import Study

    asked = Study.read(study)
    with Ledger(asked.ledger, read_only=True) as ledger:
        todo = runs(asked, ledger.missions())
        return asked, todo, current(todo, ledger.records())


def _show_status(todo: Sequence[Run], known: dict[str, Record]) -> None:
    from .console import say, table

    contenders = dict.fromkeys(run.contender for run in todo)
    rows = []
    for contender in contenders:
        mine = [run.key for run in todo if run.contender == contender]
        done = [known[key] for key in mine if key in known]
        n_failed = sum(record.failed for record in done)
        rows.append((contender, len(mine), len(done) - n_failed, n_failed, len(mine) - len(done)))
    table("Runs", ["contender", "all", "finished", "failed", "open"], rows)
    failures: dict[tuple[str, str, str], int] = {}
    for run in todo:
        record = known.get(run.key)
        if record is not None and record.failed:
            what = (run.contender, record.outcome, record.error)
            failures[what] = failures.get(what, 0) + 1
    if failures:
        table(
            "Failures",
            ["contender", "runs", "outcome", "error"],
            [(who, count, outcome, error) for (who, outcome, error), count in failures.items()],
        )
        say("Failed runs are kept as they are; --retry does them again.")
