"""Programs read from texts, or refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.export import read_program
from msmrta_opt.optimise.program import Program


def read(text: str, path: Path) -> Program:
    path.write_bytes(text.encode())
    return read_program(path)


def assert_refused(text: str, path: Path, field: str, problem: str) -> None:
    with pytest.raises(InputError) as caught:
        read(text, path)
    assert str(caught.value).isprintable()
    assert (caught.value.file, caught.value.field) == (str(path), field)
    assert problem in caught.value.problem, caught.value.problem


def mps(
    columns: str = "x c 1 d 1\ny c 1\nx obj 3\ny obj 2",
    rhs: str = "RHS c 4\nRHS d 3.5",
    *,
    rows: str = "N obj\nL c\nL d",
    rest: str = "",
    first: str = "NAME t",
) -> str:
    """A program; lines of data are indented here. Maximise 3 x + 2 y, x + y ≤ 4, x ≤ 3.5: 11.5."""
    sections = {"ROWS": rows, "COLUMNS": columns, "RHS": rhs}
    text = "".join(f"{name}\n" + _indented(lines) for name, lines in sections.items())
    for line in rest.splitlines():
        text += f"{line}\n" if line.isalpha() else f" {line}\n"
    return f"{first}\nOBJSENSE\n    MAX\n{text}ENDATA\n"


def _indented(lines: str) -> str:
    return "".join(f"    {line}\n" for line in lines.splitlines())
