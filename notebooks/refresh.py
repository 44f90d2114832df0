"""Run the notebooks of this folder and keep them with their outputs: what `make notebooks` does.

Each runs from top to bottom in a fresh kernel of this Python, with this folder as its working
directory. What is kept is what a reader needs, and the same on every machine: ids of cells, tags and
outputs stay; timings, paths, states of widgets and other metadata do not. The tests run the same
functions and compare (`words`), so that what a reader sees is what the package says today.
"""

from __future__ import annotations

import argparse
import base64
import copy
import io
import os
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import nbformat
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.output_widget import OutputWidget

FOLDER = Path(__file__).resolve().parent
VARIES = "varies"
"""Tag of a cell whose words need not be the same in the next run, as a table of timings."""
MAX_BYTES = 400_000
PATIENCE_SECONDS = 3600
"""For a kernel that starts, or sends what it has, on however busy a machine; cells have no limit."""
WIDGET = "application/vnd.jupyter.widget-view+json"
IN_PLACE_OF_A_WIDGET = "(controls to move: shown while the notebook runs)"
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
KEPT = ("mystnb", "tags")
"""Metadata of a cell."""
OF_THIS_MACHINE = re.compile(r"/home/|/Users/|/tmp/|site-packages|[A-Za-z]:\\\\|\b0x[0-9a-f]{6,}")

Notebook: TypeAlias = nbformat.NotebookNode


class _ThisPython(KernelSpecManager):  # type: ignore[misc]  # its package is taken as it comes
    """Kernels run in the Python that runs this file, whatever a user has registered or set up."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """The same kernel whatever it is called."""
        # Without its history, in which kernels that run side by side would wait for one another.
        launch = ["-m", "ipykernel_launcher", "--HistoryManager.enabled=False", "-f"]
        programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        return KernelSpec(
            argv=[sys.executable, *launch, "{connection_file}"],
            display_name="Python 3",
            language="python",
            env={"PATH": programs, "COLUMNS": "100", "IPYTHONDIR": self.data_dir},
        )


class _Listening(OutputWidget):  # type: ignore[misc]
    """Keeps what an output widget shows, and does not tell the kernel, which has no use for it.

    What is sent while a cell's reply is waited for can swallow the wake-up of the reply, and the run
    waits for ever (github.com/jupyter/nbclient, issue 312).
    """

    def sync_state(self) -> None:
        """Nothing."""


def read(path: Path) -> Notebook:
    """The notebook in a file."""
    return nbformat.read(path, as_version=4)


def executed(notebook: Notebook, folder: Path = FOLDER) -> Notebook:
    """A copy of `notebook` with the outputs of a run in `folder`, ready to be kept.

    Raises
    ------
    CellExecutionError
        If a cell raises.
    RuntimeError
        If what a widget shows is an error, which a cell does not notice.
    """
    run = copy.deepcopy(notebook)
    with tempfile.TemporaryDirectory(prefix="nb") as scratch:
        kernels = AsyncKernelManager(
            kernel_spec_manager=_ThisPython(data_dir=scratch),
            connection_file=str(Path(scratch) / "kernel.json"),
        )
        if os.name == "posix":
            kernels.transport = "ipc"  # sockets of its own, which no other run can have taken
        client = NotebookClient(
            run,
            km=kernels,
            timeout=None,
            startup_timeout=PATIENCE_SECONDS,
            iopub_timeout=PATIENCE_SECONDS,
            resources={"metadata": {"path": str(folder)}},
        )
        client.widget_registry = {"@jupyter-widgets/output": {"OutputModel": _Listening}}
        client.execute(cleanup_kc=True)  # the kernel ends with the run
    for error in _errors_in_widgets(run):
        raise RuntimeError(f"a widget shows {error['ename']}: {error['evalue']}")
    return cleaned(run)


def _errors_in_widgets(notebook: Notebook) -> list[dict[str, Any]]:
    states = notebook.metadata.get("widgets", {}).values()
    models = [model for group in states for model in group["state"].values()]
    shown = [output for model in models for output in model["state"].get("outputs", ())]
    return [output for output in shown if output["output_type"] == "error"]


# What is kept


def cleaned(notebook: Notebook) -> Notebook:
    """A copy without what differs from run to run or from machine to machine."""
    kept = copy.deepcopy(notebook)
    kept.metadata = nbformat.from_dict(METADATA)
    for cell in kept.cells:
        cell.metadata = nbformat.from_dict(
            {key: cell.metadata[key] for key in KEPT if cell.metadata.get(key)}
        )
        if cell.cell_type == "code":
            alt = alternative(cell)
            cell.outputs = _joined([_cleaned_output(output, alt) for output in cell.outputs])
    return kept


def alternative(cell: Notebook) -> str:
    """What a cell's picture shows, in words: kept where the documentation site looks for it."""
    return str(cell.metadata.get("mystnb", {}).get("image", {}).get("alt", ""))


def _cleaned_output(output: Notebook, alt: str) -> Notebook:
    """An output as it is kept; a picture of a widget stands for the widget, words for a picture."""
    if "data" not in output:
        return output
    output.metadata = nbformat.from_dict({})
    if output.data.pop(WIDGET, None) and "image/png" not in output.data:
        output.data = nbformat.from_dict({"text/plain": IN_PLACE_OF_A_WIDGET})
    if "image/png" in output.data:
        output.data["image/png"] = _smaller(output.data["image/png"])
        if alt:
            output.metadata = nbformat.from_dict({"image/png": {"alt": alt}})
            output.data["text/plain"] = alt
    return output


def _joined(outputs: list[Notebook]) -> list[Notebook]:
    """The outputs, with what was printed bit by bit in one piece: the bits depend on the clock."""
    joined: list[Notebook] = []
    for output in outputs:
        last = joined[-1] if joined else None
        if last is not None and output.get("name") == last.get("name") == "stdout":
            last.text += output.text
        else:
            joined.append(output)
    return joined


def _smaller(png: str) -> str:
    """The picture in 256 colours, which is plenty for maps and charts, if that is smaller."""
    from PIL import Image

    before = base64.b64decode(png)
    picture = Image.open(io.BytesIO(before))
    if picture.mode == "P":
        return png
    after = io.BytesIO()
    few = picture.convert("RGB").quantize(256, kmeans=3, dither=Image.Dither.NONE)
    few.save(after, format="png", optimize=True)
    best = min(before, after.getvalue(), key=len)
    return base64.b64encode(best).decode()


def write(path: Path, notebook: Notebook) -> None:
    """Keep `notebook` in a file."""
    nbformat.write(notebook, path)


# What is checked


def words(notebook: Notebook) -> dict[str, list[str]]:
    """By cell, all it shows but its pictures; cells tagged `VARIES` are left out."""
    return {
        cell.id: [_words(output) for output in cell.outputs]
        for cell in notebook.cells
        if cell.cell_type == "code" and VARIES not in cell.metadata.get("tags", [])
    }


def _words(output: Notebook) -> str:
    if "data" not in output:
        return str(output.get("text", ""))
    shown = {kind: text for kind, text in output.data.items() if not kind.startswith("image/")}
    return "\n".join(f"{kind}: {text}" for kind, text in sorted(shown.items()))


def lengths(notebook: Notebook) -> tuple[int, int]:
    """Characters of prose and of code."""
    of = {"markdown": 0, "code": 0}
    for cell in notebook.cells:
        of[cell.cell_type] += len(cell.source)
    return of["markdown"], of["code"]


def faults(path: Path) -> list[str]:
    """What is wrong with a kept notebook, as far as can be seen without running it."""
    text, notebook = path.read_text(encoding="utf-8"), read(path)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code" and cell.source.strip()]
    outputs = [(cell.id, output) for cell in cells for output in cell.outputs]
    found = []
    if not outputs:
        found.append("kept without outputs")
    if [cell.execution_count for cell in cells] != list(range(1, len(cells) + 1)):
        found.append("cells were not run once each, from top to bottom")
    for name, output in outputs:
        if output.output_type == "error":
            found.append(f"cell {name} was kept with {output.ename}: {output.evalue}")
        if "image/png" in output.get("data", {}) and "image/png" not in output.metadata:
            found.append(f"cell {name} shows a picture without words for who cannot see it")
        if output.get("name") == "stderr":
            found.append(f"cell {name} shows a warning or log: {output.text.strip()[:200]}")
    if notebook != cleaned(notebook):
        found.append("kept with what differs from run to run")
    if len(text.encode()) > MAX_BYTES:
        found.append(f"{len(text.encode())} bytes; keep it to {MAX_BYTES}")
    found += [f"names this machine: {match!r}" for match in _of_this_machine(notebook)]
    return found


def _of_this_machine(notebook: Notebook) -> list[str]:
    shown = [cell.source for cell in notebook.cells]
    for cell in notebook.cells:
        shown += [_words(output) for output in cell.get("outputs", ())]
    names = re.compile(f"{re.escape(str(FOLDER.parent))}|{OF_THIS_MACHINE.pattern}")
    return [match.group() for text in shown for match in names.finditer(text)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Refresh the notebooks that are named, or all."""
    parser = argparse.ArgumentParser(description="Run notebooks, and keep them with their outputs.")
    parser.add_argument("notebooks", nargs="*", type=Path, help="by default all of this folder")
    for path in parser.parse_args(arguments).notebooks or sorted(FOLDER.glob("*.ipynb")):
        write(path, executed(read(path)))
        print(f"{path.name}: {path.stat().st_size / 1000:.0f} kB")
        for fault in faults(path):
            print(f"  {fault}")


if __name__ == "__main__":
    main()
