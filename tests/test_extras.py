"""Without a library that an extra brings, what needs it says which extra that is."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt import cli
from msmrta_opt.optimise.solvers import base, solvers

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LIBRARIES = ("distributed", "ortools", "pyarrow", "pyscipopt", "swiglpk")
Run = Callable[..., tuple[int, str]]


@pytest.fixture
def bare(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Run:
    """Run a command where no library of an extra can be imported; its exit status and its error."""
    for name in LIBRARIES:
        monkeypatch.setitem(sys.modules, name, None)
    base._importable.cache_clear()
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> tuple[int, str]:
        capsys.readouterr()
        status = cli.run([*words])
        return status, capsys.readouterr().err

    yield run
    base._importable.cache_clear()


def test_each_library_is_of_one_extra() -> None:
    extras = PROJECT["optional-dependencies"]
    users = {name: extras[name] for name in extras if name not in ("dev", "docs", "notebooks")}
    named = {line.partition(">")[0] for lines in users.values() for line in lines}
    assert named == set(LIBRARIES)


@pytest.mark.parametrize("solver", ["scip", "cpsat", "glpk"])
def test_a_solver_that_is_missing_names_its_extra(solver: str, bare: Run) -> None:
    package = solvers()[solver].package.lower()
    assert any(line.startswith(package) for line in PROJECT["optional-dependencies"]["solvers"])
    status, said = bare("solve", "cluster_one_to_one", "corridor", "--solver", solver)
    assert status == 2
    assert said == (f"error: solver {solver} is not installed; pip install 'msmrta_opt[solvers]'\n")


@pytest.mark.parametrize(
    ("words", "extra"),
    [
        (("compare", "corridor", "--parquet", "rows.parquet"), "parquet"),
        (("study", "export", "study.toml", "--parquet", "rows.parquet"), "parquet"),
        (("study", "run", "study.toml", "--dask", "tcp://127.0.0.1:9"), "dask"),
    ],
)
def test_an_option_that_needs_a_library_names_its_extra(
    words: tuple[str, ...], extra: str, bare: Run
) -> None:
    Path("study.toml").write_text(
        'title = "one"\ninstances = [{ files = ["corridor"] }]\nplanners = [{ planner = "random" }]\n'
    )
    status, said = bare(*words)
    assert (status, f"pip install 'msmrta_opt[{extra}]'" in said) == (2, True), said


@pytest.mark.parametrize(
    "words",
    [
        ("solve", "victim_balanced", "two_rooms"),
        ("exact", "corridor", "--time-limit", "20"),
        ("explain", "cluster_one_to_one", "corridor"),
        ("diff", "cluster_printed", "cluster_one_to_one", "corridor"),
        ("export", "victim_covering", "corridor", "-o", "program.mps"),
    ],
    ids=lambda words: words[0],
)
def test_what_needs_none_goes_without(words: tuple[str, ...], bare: Run) -> None:
    status, said = bare(*words)
    assert status == 0, said
