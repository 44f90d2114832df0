"""What the pages in `docs` show is run here."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.studies import solved_here

from msmrta_opt import cli, formulations

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "solver_regression.md").read_text(encoding="utf-8")
WORKFLOW = (DOCS / "ci" / "solver_regression.yml").read_text(encoding="utf-8")


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)


def commands(page: str) -> list[str]:
    return [line for block in blocks(page, "sh") for line in block.splitlines()]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    with solved_here():
        yield tmp_path


def test_the_commands_and_the_python_of_solver_regression_work_in_their_order(here: Path) -> None:
    for command in commands(PAGE):
        program, *words = shlex.split(command)
        assert program == "msmrta"
        assert cli.run(words) == 0, command
    assert {"cluster.json", "solves.xml", "solves.md"} <= {path.name for path in here.iterdir()}
    _, code = blocks(PAGE, "python")
    # A part of the baseline alone is solved: it is written again as that part.
    exec(compile(code, "solver_regression.md", "exec"), {})


def test_the_fixture_of_solver_regression_is_used_as_it_is_shown() -> None:
    called: list[tuple[Any, ...]] = []
    code, _ = blocks(PAGE, "python")
    names: dict[str, Callable[..., None]] = {}
    exec(compile(code, "solver_regression.md", "exec"), names)
    names["test_solvers_give_what_they_gave"](lambda *given, **more: called.append((given, more)))
    assert called == [(("cluster.json", ["paper", "two_rooms"]), {"solvers": ["auto", "highs"]})]


def test_the_command_of_the_workflow_works(here: Path) -> None:
    (line,) = [line.strip() for line in WORKFLOW.splitlines() if "msmrta compare" in line]
    words = shlex.split(line)[1:]
    models = here / "models"
    models.mkdir()
    shipped = Path(__file__).parents[1] / "models" / "cluster_printed.py"
    (models / "cluster_mine.py").write_bytes(shipped.read_bytes())
    (here / "baselines").mkdir()
    baseline = "baselines/cluster.json"
    first = words[: words.index("--against")]
    assert cli.run([*first, "--save", baseline]) == 0
    assert cli.run(words) == 0
    for file in re.findall(r"solves\.\w+", WORKFLOW):
        assert (here / file).is_file()


def test_the_code_of_maps_prints_what_the_page_shows(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "maps.md").read_text(encoding="utf-8")
    (code,) = blocks(page, "python")
    exec(compile(code, "maps.md", "exec"), {})
    assert blocks(page, "text") == [capsys.readouterr().out]
