"""The command compare: formulations × solvers × instances."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .missions import Figure, Json
from .outputs import named_values
from .subjects import Options, Parameters, values_of

if TYPE_CHECKING:
    from ..mission.instance import Instance
    from ..stages.options import StagedOptions
    from ..studies.analysis.score import Score
    from ..studies.proving import Verdict
    from ..studies.record import Record


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(compare)


def compare(
    instances: Annotated[
        list[Path], typer.Argument(metavar="INSTANCE…", help="Instances, by file or name.")
    ],
    stage: Annotated[str, typer.Option(help="clustering, cluster, victim or joint.")] = "cluster",
    models: Annotated[
        list[str] | None,
        typer.Option(help="Formulations, and folders of them.  [default: all of the stage]"),
    ] = None,
    solvers: Annotated[
        list[str] | None, typer.Option(help="Solvers.  [default: auto and all installed]")
    ] = None,
    seeds: Annotated[list[str] | None, typer.Option(help="The solvers' seeds.")] = None,
    psi: Annotated[float, typer.Option(help="ψ of Eq. 1, 0 to 1.")] = 0.95,
    beta: Annotated[float, typer.Option(help="β of Eq. 2, 0 to 1.")] = 0.5,
    parameters: Parameters = None,
    option: Options = None,
    time_limit: Annotated[float, typer.Option(help="Seconds per solve.")] = 60.0,
    memory_limit: Annotated[float, typer.Option(help="MiB per solve.", min=1)] = 4096.0,
    gap: Annotated[float | None, typer.Option(help="Relative gap to stop at.")] = None,
    structure: Annotated[
        bool,
        typer.Option("--structure/--no-structure", help="Whether auto may use what is proven."),
    ] = True,
    jobs: Annotated[int, typer.Option(help="Solves at a time; 1 for comparable times.", min=1)] = 1,
    scores: Annotated[
        bool, typer.Option("--scores/--no-scores", help="Measure the plans that come of each.")
    ] = True,
    prove: Annotated[
        bool,
        typer.Option(
            "--prove", help="Prove each program's optimum; a solver that claims another is wrong."
        ),
    ] = False,
    csv: Annotated[Path | None, typer.Option(help="Write the rows here.")] = None,
    parquet: Annotated[Path | None, typer.Option(help="Write the rows here.")] = None,
    json: Json = None,
    figure: Figure = None,
    save: Annotated[Path | None, typer.Option(help="Write a baseline here.")] = None,
    against: Annotated[
        Path | None, typer.Option(help="Compare with this baseline; a change exits with 1.")
    ] = None,
    slower: Annotated[
        float | None, typer.Option(help="With --against: times beyond this ratio are a change.")
    ] = None,
    update: Annotated[
        bool,
        typer.Option("--update", help="With --against: show the changes, then write them to it."),
    ] = False,
    junit: Annotated[
        Path | None, typer.Option(help="Write the solves here as JUnit's XML, a test case each.")
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option(help="Write what is wrong, what changed and all solves here.")
    ] = None,
) -> None:
    """Compare formulations and solvers on instances, each solve in a process of its own."""
    from tqdm import tqdm

    from ..stages.options import StagedOptions
    from ..studies import comparison as study
    from ..studies.analysis.agreement import disagreements
    from ..studies.analysis.regression import read_baseline, regression
    from ..studies.missions import read_instances
    from ..studies.proving import verdicts
    from . import regression as baselines
    from .console import console
    from .outputs import check_outputs, check_parquet
    from .proofs import held_against, show_verdicts

    outputs = (csv, parquet, json, save, junit, markdown)
    check_outputs(*outputs, figure=figure, inputs=[*instances, against])
    check_parquet(parquet)
    baselines.check_options(against, save, slower, update=update)
    baseline = None if against is None else read_baseline(against)
    names = _names(models, stage)
    options = StagedOptions.of(**{"psi": psi, "beta": beta, **named_values(option)})
    values = values_of(parameters)
    missions = read_instances(instances)
    todo = study.cases(
        missions,
        stage=stage,
        models=names,
        solver_names=_split(solvers),
        seeds=_whole_numbers(seeds),
        options=options,
        parameters=values,
        time_limit=time_limit,
        gap=gap,
        structure=structure,
    )
    rows: list[Record] = []
    measured: list[Score] = []
    proofs: list[Verdict] = []
    is_whole = False
    try:
        with closing(study.compare(todo, jobs=jobs, memory_limit=memory_limit)) as finished:
            bar = tqdm(finished, total=len(todo), desc="solving", unit="solve", disable=None)
            for row in bar:
                rows.append(row)  # noqa: PERF402 - what is finished stays if Ctrl-C ends the loop
        if scores:
            for item in _scores(missions, stage, rows, options, values, time_limit, memory_limit):
                measured.append(item)  # noqa: PERF402
        if prove:
            for verdict in verdicts(todo, rows, time_limit=time_limit):
                proofs.append(verdict)  # noqa: PERF402
        is_whole = True
    except KeyboardInterrupt:
        pass
    rows = held_against(proofs, study.in_order(todo, rows))
    # Files first: whatever becomes of the screen, what was found is kept. A part is no baseline.
    _write(rows, csv, parquet, json, figure, save if is_whole else None)
    wrong = disagreements(rows)
    found = None if baseline is None else regression(baseline, rows, slower=slower)
    if is_whole:
        baselines.write_reports(rows, found, wrong, junit, markdown)
    _show(rows, measured)
    show_verdicts(proofs)
    if not is_whole:
        console().print(f"interrupted: {len(rows)} of {len(todo)} solves are shown", style="yellow")
        raise KeyboardInterrupt
    for line in wrong:
        console().print(f"disagreement: {line}", style="bold red", markup=False)
    changed = found is not None and bool(found.changes)
    if found is not None and against is not None:
        baselines.show(found, against)
    is_sound = _all_solved(rows, agree=not wrong and not changed) and not wrong
    if update and found is not None and against is not None:
        changed = not (is_sound and baselines.update_baseline(found, against)) and changed
    if not is_sound or changed:
        raise typer.Exit(1)


def _all_solved(rows: Sequence[Record], *, agree: bool) -> bool:
    """Whether some solve gave a solution and none failed its check; says so either way."""
    from .console import console

    silent = [row for row in rows if row.verdict in ("error", "skipped")]
    failed = [row for row in rows if row.check not in (None, "", "passed")]
    if silent:
        console().print(f"{len(silent)} of {len(rows)} solves gave no solution", style="yellow")
    if failed:
        console().print(f"{len(failed)} solves failed their check", style="bold red")
    is_sound = len(silent) < len(rows) and not failed
    if is_sound and all(row.objective is None for row in rows):
        said = ", ".join(dict.fromkeys(row.verdict for row in rows if row not in silent))
        console().print(f"no program has a solution: {said}", style="yellow")
        return False
    if is_sound and agree:
        console().print("all solutions agree", style="green")
    return is_sound


def _split(entries: list[str] | None) -> list[str]:
    return [name for entry in entries or [] for name in entry.split(",")]


def _whole_numbers(entries: list[str] | None) -> list[int]:
    from ..mission.errors import InputError

    try:
        return [int(text) for text in _split(entries)]
    except ValueError:
        raise InputError(
            f"{', '.join(entries or [])}; give whole numbers", field="--seeds"
        ) from None


def _names(entries: list[str] | None, stage: str) -> list[str]:
    """The formulations that `entries` name, those of their folders included; empty for all.

    Raises
    ------
    InputError
        If the folders have none of the stage, or one whose name is taken.
    """
    from ..mission.errors import InputError
    from ..optimise import registry

    folders = [entry for entry in entries or [] if Path(entry).is_dir()]
    for folder in folders:
        registry.add_models(folder)
    names = _split([entry for entry in entries or [] if entry not in folders])
    places = {Path(folder).resolve() for folder in folders}
    taken: dict[str, Path] = {}
    for item in registry.listings():
        first = taken.setdefault(item.name, item.path)
        if item.path != first and item.path.parent in places:
            raise InputError(item.error, field="--models", file=item.path)
    inside = [item for item in registry.listings(stage) if item.path.parent in places]
    if folders and not names and not inside:
        raise InputError(f"no formulation of stage {stage!r}", field="--models", file=folders[0])
    return list(dict.fromkeys([*names, *(item.name for item in inside)]))


def _scores(
    missions: list[Instance],
    stage: str,
    rows: list[Record],
    options: StagedOptions,
    values: dict[str, float],
    time: float,
    memory: float,
) -> Iterator[Score]:
    from ..studies.analysis.score import scores

    sound = dict.fromkeys(row.model or "" for row in rows if row.verdict in ("optimal", "feasible"))
    return scores(
        missions,
        stage=stage,
        models=list(sound),
        options=options,
        parameters=values,
        time_limit=time + 20,
        memory_limit=memory,
    )


def _show(rows: Sequence[Record], measured: Sequence[Score]) -> None:
    from ..studies.analysis.times import shifted_geometric_means
    from .console import table
    from .scores import show_scores

    table(
        "Solves (times in ms: canonicalise, solve, all from data to checked solution)",
        [
            *("instance", "model", "solver", "seed", "status", "objective", "bound", "gap"),
            *("check", "canon.", "solve", "all", "nodes", "vars", "rows", "message"),
        ],
        [
            (
                row.instance,
                row.model,
                row.solver,
                row.solver_seed,
                row.verdict,
                row.objective,
                row.bound,
                row.gap,
                row.check,
                *(_milliseconds(row.stage_seconds.get(s)) for s in ("canonicalise", "solve")),
                _milliseconds(row.seconds),
                row.nodes,
                row.n_variables,
                row.n_rows,
                row.reason if row.verdict != "optimal" else "",
            )
            for row in rows
        ],
    )
    table(
        "Shifted geometric mean times of solves to optimality (ms, shift 10 ms)",
        ["model", "solver", "mean", "optimal", "tried"],
        [
            (model, solver, _milliseconds(mean), solved, tried)
            for (model, solver), (mean, solved, tried) in shifted_geometric_means(rows).items()
        ],
    )
    show_scores(rows, measured)


def _milliseconds(value: float | None) -> str:
    return "" if value is None or value != value else f"{value * 1e3:.1f}"


def _write(
    rows: Sequence[Record],
    csv: Path | None,
    parquet: Path | None,
    json: Path | None,
    figure: Path | None,
    save: Path | None,
) -> None:
    from ..studies.analysis.regression import save_baseline
    from ..studies.solves import documents_of, table_of
    from .console import write_json, writing
    from .outputs import write_table

    if csv is not None or parquet is not None:
        write_table(table_of(rows), csv, parquet)
    write_json(json, documents_of(rows))
    if figure is not None:
        from ..plots import save_figure
        from ..studies.analysis.profile import performance_profile

        with writing("", figure):
            save_figure(performance_profile(rows), figure)
    if save is not None:
        with writing("", save):
            save_baseline(rows, save)
