"""Every notebook runs, and what is kept of it is what a run shows."""

from __future__ import annotations

import copy
import importlib
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import nbformat
import pytest
from nbclient.exceptions import CellExecutionError

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.fixture(scope="module")
def refresh() -> Iterator[ModuleType]:
    """The script that keeps notebooks, as a module."""
    sys.path.insert(0, str(FOLDER))
    yield importlib.import_module("refresh")
    sys.path.remove(str(FOLDER))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_what_is_kept(path: Path, refresh: ModuleType) -> None:
    assert refresh.faults(path) == []
    kept = refresh.read(path)
    assert refresh.words(refresh.executed(kept)) == refresh.words(kept), (
        "what is kept is out of date; `make notebooks` refreshes it"
    )


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_explains_at_least_as_long_as_it_computes(
    path: Path, refresh: ModuleType
) -> None:
    notebook = refresh.read(path)
    prose, code = refresh.lengths(notebook)
    assert prose >= code
    assert "$$" in "".join(cell.source for cell in notebook.cells), "no equation stands in it"
    claims = [cell.id for cell in notebook.cells if re.search(r"^\s*assert ", cell.source, re.M)]
    assert claims == [], "what a notebook claims stands in its outputs, or is tested elsewhere"


def test_every_notebook_has_its_line_in_the_readme() -> None:
    assert NOTEBOOKS
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in NOTEBOOKS if path.name not in readme] == []


# The machinery itself, on a notebook of a few lines

DOT = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABAQAAAAA3bvkkAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg=="
"""A picture of one pixel."""


def of(*sources: str) -> Any:
    """A notebook of code cells a, b, …"""
    cells = [
        nbformat.v4.new_code_cell(source, id=name)
        for name, source in zip("abcdef", sources, strict=False)
    ]
    return nbformat.v4.new_notebook(cells=cells)


@pytest.fixture(scope="module")
def ran(refresh: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A small notebook after its run."""
    small = of("x = 2", "print(x + 1)\nprint('!')", "import ipywidgets as w\nw.IntSlider(2)", "x")
    return refresh.executed(small, tmp_path_factory.mktemp("run"))


@pytest.fixture
def kept(ran: Any, tmp_path: Path, refresh: ModuleType) -> Callable[..., Path]:
    """The file of the small notebook, kept with a change or without."""

    def keep(change: Callable[[Any], None] = lambda notebook: None) -> Path:
        notebook = copy.deepcopy(ran)
        change(notebook)
        refresh.write(tmp_path / "kept.ipynb", notebook)
        return tmp_path / "kept.ipynb"

    return keep


def test_a_cell_that_raises_stops_the_run(tmp_path: Path, refresh: ModuleType) -> None:
    with pytest.raises(CellExecutionError, match="division by zero"):
        refresh.executed(of("1", "1 / 0"), tmp_path)


def test_an_error_inside_a_widget_stops_the_run(tmp_path: Path, refresh: ModuleType) -> None:
    show = "import ipywidgets as w\nw.interactive(lambda t: 1 / t, t=w.IntSlider(0)).update()"
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        refresh.executed(of(show), tmp_path)


def test_a_kernel_is_told_nothing_while_its_reply_is_waited_for(
    tmp_path: Path, refresh: ModuleType
) -> None:
    """Else the reply can be missed, and the run never ends."""
    ran = refresh.executed(
        of("import ipywidgets as w\nout = w.Output()", "with out:\n    print('x')", "out.outputs"),
        tmp_path,
    )
    assert refresh.words(ran)["c"] == ["text/plain: ()"]


def test_a_notebook_kept_as_it_was_run_has_no_faults(
    kept: Callable[..., Path], refresh: ModuleType
) -> None:
    assert refresh.faults(kept()) == []


def test_what_is_compared_is_all_that_cells_say_but_those_that_vary(
    kept: Callable[..., Path], refresh: ModuleType
) -> None:
    def tag(notebook: Any) -> None:
        notebook.cells[3].metadata["tags"] = [refresh.VARIES]

    words = {
        "a": [],
        "b": ["3\n!\n"],
        "c": [f"text/plain: {refresh.IN_PLACE_OF_A_WIDGET}"],
        "d": ["text/plain: 2"],
    }
    assert refresh.words(refresh.read(kept())) == words
    del words["d"]
    tagged = kept(tag)
    assert refresh.faults(tagged) == []
    assert refresh.words(refresh.read(tagged)) == words


def drop_outputs(notebook: Any) -> None:
    for cell in notebook.cells:
        cell.outputs = []


def swap_counts(notebook: Any) -> None:
    first, second, *_ = notebook.cells
    first.execution_count, second.execution_count = 2, 1


def forget_counts(notebook: Any) -> None:
    for cell in notebook.cells:
        cell.execution_count = None


def add_error(notebook: Any) -> None:
    error = nbformat.v4.new_output("error", ename="InputError", evalue="psi: 2", traceback=[])
    notebook.cells[1].outputs = [error]


def add_metadata(notebook: Any) -> None:
    notebook.cells[0].metadata["execution"] = {"iopub.execute_input": "2024-01-01T00:00:00Z"}


def add_picture(notebook: Any) -> None:
    picture = nbformat.v4.new_output("display_data", data={"image/png": DOT, "text/plain": "dot"})
    notebook.cells[0].outputs = [picture]


def add_words(words: str, stream: str = "stdout") -> Callable[[Any], None]:
    def add(notebook: Any) -> None:
        notebook.cells[0].outputs = [nbformat.v4.new_output("stream", name=stream, text=words)]

    return add


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (drop_outputs, "kept without outputs"),
        (swap_counts, "cells were not run once each, from top to bottom"),
        (forget_counts, "cells were not run once each, from top to bottom"),
        (add_error, "cell b was kept with InputError: psi: 2"),
        (add_metadata, "kept with what differs from run to run"),
        (add_picture, "cell a shows a picture without words for who cannot see it"),
        (add_words("careful\n", stream="stderr"), "cell a shows a warning or log: careful"),
        (add_words("in /home/someone"), "names this machine: '/home/'"),
        (add_words(f"in {FOLDER}"), f"names this machine: '{FOLDER.parent}'"),
        (add_words("<object at 0x7f3a5c0b2d90>"), "names this machine: '0x7f3a5c0b2d90'"),
    ],
)
def test_a_notebook_kept_in_another_way_has_a_fault(
    change: Callable[[Any], None], fault: str, kept: Callable[..., Path], refresh: ModuleType
) -> None:
    assert refresh.faults(kept(change)) == [fault]


def test_a_picture_keeps_its_words_and_stands_for_its_widget(refresh: ModuleType) -> None:
    data = {"image/png": DOT, "text/plain": "Explorer()", refresh.WIDGET: {"model_id": "1"}}
    cell = nbformat.v4.new_code_cell(
        "x", id="a", outputs=[nbformat.v4.new_output("display_data", data=data)]
    )
    cell.metadata["mystnb"] = {"image": {"alt": "a dot"}}
    (kept,) = refresh.cleaned(nbformat.v4.new_notebook(cells=[cell])).cells
    (output,) = kept.outputs
    assert set(output.data) == {"image/png", "text/plain"}
    assert output.data["text/plain"] == "a dot"
    assert output.metadata == {"image/png": {"alt": "a dot"}}
    assert refresh.alternative(kept) == "a dot"


def test_prose_and_code_are_measured(refresh: ModuleType) -> None:
    notebook = of("1 + 1", "2")
    notebook.cells.append(nbformat.v4.new_markdown_cell("Two sums."))
    assert refresh.lengths(notebook) == (9, 6)


def test_a_notebook_that_is_too_large_has_a_fault(
    kept: Callable[..., Path], refresh: ModuleType
) -> None:
    (fault,) = refresh.faults(kept(add_words("x" * 400_000)))
    assert fault.endswith("bytes; keep it to 400000")
