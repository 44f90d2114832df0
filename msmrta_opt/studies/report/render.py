"""The page of a report, and the files beside it."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib.figure import Figure

from ...mission.files import write_text
from ...plots.lettering import write_plainly
from ...plots.saving import save_figure
from .blocks import Block, HeatMaps, Picture, Section, Table, Words
from .folder import DATA, FIGURES, MARK, PAGE
from .style import svg
from .text import number

if TYPE_CHECKING:
    from ..specification import Study

DPI = 150
MAX_PIXELS = 12_000
"""Along a side of a PNG: a study of many contenders or maps has it in fewer dots."""
RUNS = f"{DATA}/runs.csv"


@dataclass(frozen=True)
class Summary:
    """What is said of the runs as a whole."""

    expected: int
    done: int
    finished: int
    skipped: int
    machines: Sequence[str]
    versions: Sequence[tuple[str, str]]
    """Packages with the versions that runs were made with."""
    first: str
    last: str
    seconds: float
    """Of all timed repetitions together."""

    @property
    def failed(self) -> int:
        """Runs that gave no result, other than those that were skipped."""
        return self.done - self.finished - self.skipped

    @classmethod
    def of(cls, runs: pd.DataFrame, expected: int) -> Summary:
        """Of the runs, as of `table_of`."""
        found: dict[str, dict[str, None]] = {}
        for text in dict.fromkeys(runs["versions_json"]):
            for package, version in json.loads(text).items():
                found.setdefault(package, {})[version] = None
        times = sorted(runs.loc[runs["finished_at"] != "", "finished_at"])
        return cls(
            expected=expected,
            done=len(runs),
            finished=int(runs["finished"].sum()),
            skipped=int((runs["outcome"] == "skipped").sum()),
            machines=[name for name in dict.fromkeys(runs["machine"]) if name],
            versions=[(package, ", ".join(found[package])) for package in sorted(found)],
            first=times[0] if times else "",
            last=times[-1] if times else "",
            seconds=sum(sum(json.loads(text)) for text in runs["seconds_json"]),
        )


def write_page(
    folder: Path, study: Study, runs: pd.DataFrame, sections: Sequence[Section], *, expected: int
) -> None:
    """Write the page into `folder`, with ``figures/*.png`` and ``data/*.csv`` beside it."""
    _write_csv(runs.drop(columns=["finished", "counts"]), folder / RUNS)
    for section in sections:
        for block in section.blocks:
            _write_files(block, folder)
    environment = Environment(
        loader=PackageLoader("msmrta_opt.studies.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["figure"] = figure
    environment.filters["source"] = _source
    page = environment.get_template("report.html.jinja").render(
        mark=MARK,
        study=study,
        summary=Summary.of(runs, expected),
        sections=sections,
        figures=FIGURES,
        data=DATA,
        runs_csv=RUNS,
        numeric=_numeric,
        script=_script(),
    )
    write_text(folder / PAGE, page)


def figure(value: Any) -> str:
    """A value of a table, as it is shown: three significant digits, counts in full."""
    if value is None or value is pd.NA or (isinstance(value, float) and value != value):
        return "–"
    if isinstance(value, bool | str):
        return str(value)
    return number(value) if isinstance(value, float) else f"{value:,}"


def _script() -> tuple[str, str]:
    """The page's own script, and its digest, which alone the page's policy lets run."""
    text = files(__package__).joinpath("report.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
    return text, f"sha256-{digest}"


def _numeric(table: Table) -> list[bool]:
    """Which columns are numbers, and so stand at the right."""
    return [pd.api.types.is_numeric_dtype(kind) for kind in table.data.dtypes]


def _source(picture: Picture) -> str:
    """The picture as a ``data:`` address."""
    text = base64.b64encode(svg(picture.figure).encode()).decode()
    return f"data:image/svg+xml;base64,{text}"


def _write_files(block: Block, folder: Path) -> None:
    if isinstance(block, Words):
        return
    _write_csv(block.data, folder / DATA / f"{block.name}.csv")
    if isinstance(block, Picture):
        _write_png(block.figure, folder / FIGURES / f"{block.name}.png")
        # Laid out by now; working it out again for the page would take as long as drawing.
        block.figure.set_layout_engine("none")
    elif isinstance(block, HeatMaps):
        _write_png(block.sheet, folder / FIGURES / f"{block.name}.png")


def _write_png(picture: Figure, path: Path) -> None:
    write_plainly(picture)
    save_figure(picture, path, dpi=min(DPI, MAX_PIXELS / max(picture.get_size_inches())))


def _write_csv(data: pd.DataFrame, path: Path) -> None:
    data.to_csv(path, index=False, lineterminator="\n", encoding="utf-8")
