"""Files that commands read and write: looked at before any work is done, so nothing is half-written."""

from __future__ import annotations

import contextlib
import importlib.util
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..mission.errors import InputError, shown
from ..mission.files import parse_json, read_json, write_with
from ..mission.shipped import find_instance

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..mission.instance import Instance
    from ..mission.plan import Plan, ScoutingReport
    from ..mission.run import Run


def check_outputs(
    *files: Path | None, figure: Path | None = None, inputs: Iterable[Path | None] = ()
) -> None:
    """Refuse outputs that could not be written, before there is anything to write.

    Raises
    ------
    InputError
        If a folder does not exist, a file is a folder, one of the `inputs` or given twice, or a
        picture's format is unknown.
    """
    outputs = [file for file in (*files, figure) if file not in (None, Path("-"))]
    for number, file in enumerate(outputs):
        if file.is_dir():
            raise InputError("is a folder; give a file", file=file)
        if not file.parent.is_dir():
            raise InputError(f"no folder {str(file.parent)!r} to write it in", file=file)
        if any(_is_same(file, other) for other in outputs[:number]):
            raise InputError("is given for two outputs; give two files", file=file)
        if file.is_file() and any(_is_same(file, other) for other in _all_read(inputs)):
            raise InputError("would overwrite what is read; give another file", file=file)
    if figure is not None:
        from ..plots import FORMATS

        if figure.suffix.lower().removeprefix(".") not in FORMATS:
            known = ", ".join(f".{name}" for name in FORMATS)
            raise InputError(
                f"unknown picture format {figure.suffix!r}; the suffix is one of {known}",
                file=figure,
            )


def _is_same(file: Path, other: Path) -> bool:
    """Whether both are one file, by whatever links; devices are shared by all."""
    return file.resolve() == other.resolve() and (file.is_file() or not file.exists())


def _all_read(inputs: Iterable[Path | None]) -> Iterator[Path]:
    """The `inputs`, and the map files to which those that are missions refer."""
    for given in inputs:
        if given is None:
            continue
        yield given
        with contextlib.suppress(InputError):  # it will be said when the file is read
            file = find_instance(given)
            yield file
            document = read_json(file)
            name = document.get("map") if isinstance(document, dict) else None
            if isinstance(name, str) and (file.parent / name).is_file():
                yield file.parent / name


def check_parquet(path: Path | None) -> None:
    """Refuse a Parquet file that nothing here could write.

    Raises
    ------
    InputError
        If pyarrow is not installed.
    """
    if path is not None and importlib.util.find_spec("pyarrow") is None:
        raise InputError("needs pyarrow; pip install 'msmrta_opt[parquet]'", field="--parquet")


def write_table(
    table: pd.DataFrame, csv: Path | None, parquet: Path | None, what: str = ""
) -> None:
    """Write a table where it is asked for, without its index, and say so of `what`."""
    from .console import writing

    if csv is not None:
        with writing(what, csv):
            write_with(csv, lambda path: table.to_csv(path, index=False))
    if parquet is not None:
        with writing(what, parquet):
            write_with(parquet, lambda path: table.to_parquet(path, index=False))


def write_plan(plan: Plan, json: Path | None, figure: Path | None) -> None:
    """Write a plan's document and its picture where they are asked for, and say so."""
    write_document("plan", plan, json)
    if figure is not None:
        write_picture(figure, plan.plot)


def write_document(what: str, made: Plan | Run, path: Path | None) -> None:
    """Write the document of a plan or a run where it is asked for, and say so of a file."""
    from .console import STANDARD_OUTPUT, write_json, writing

    if path == STANDARD_OUTPUT:
        write_json(path, made.document())
    elif path is not None:
        with writing(what, path):
            made.save(path)


def write_picture(path: Path, draw: Callable[[], Figure | Axes]) -> None:
    """Write a picture, and say so."""
    from ..plots import save_figure
    from .console import writing

    with writing("picture", path):
        save_figure(draw(), path)


KINDS = ("msmrta-instance", "msmrta-plan", "msmrta-run")
"""Formats of the documents that commands read, without their versions."""


def document_format(path: Path) -> str:
    """The ``format`` of a JSON document, or of a shipped instance; empty if it has none.

    Raises
    ------
    InputError
        If the file cannot be read, or is neither an instance nor a plan nor a run.
    """
    document = read_json(find_instance(path))
    if not isinstance(document, dict):
        raise InputError("not a JSON object; give an instance or a plan", file=path)
    written = document.get("format", "")
    if written == "" and not {"map", "robots"} & document.keys():
        problem = "has no format, map or robots; give an instance, a plan or a run"
        raise InputError(problem, file=path)
    if written != "" and str(written).partition("/")[0] not in KINDS:
        problem = f"{shown(written)}; give {', '.join(f'{kind}/1' for kind in KINDS)}"
        raise InputError(problem, field="format", file=path)
    return str(written)


def scouting_figure(instance: Instance, report: ScoutingReport) -> Figure:
    """The picture of a scouting: where the scouts went, and coverage over time."""
    from matplotlib.figure import Figure

    from ..plots import plot_coverage, plot_scouting

    figure = Figure(figsize=(12, 6), layout="constrained")
    left, right = figure.subplots(1, 2)
    plot_scouting(instance, left, report=report)
    plot_coverage(report, ax=right)
    return figure


def named_values(texts: Iterable[str] | None) -> dict[str, Any]:
    """The options written as ``NAME=VALUE``, each value read as JSON where it is, else as text.

    Raises
    ------
    InputError
        If one has no name or no ``=``, is given twice, or is a list or an object, which no option is.
    """
    values: dict[str, Any] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        name = name.strip().replace("-", "_")
        if not (equals and name):
            raise InputError(f"{text!r}; give NAME=VALUE", field="--option")
        if name in values:
            raise InputError(f"{name!r} is given twice; give it once", field="--option")
        try:
            values[name] = parse_json(value)
        except InputError:
            values[name] = value
        if isinstance(values[name], (list, dict)):
            raise InputError(
                f"{text!r}; give a number, a word, true, false or null", field="--option"
            )
    return values
