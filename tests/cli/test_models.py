"""The commands models, show, new-model and solvers, as a user types them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.optimise import registry
from msmrta_opt.optimise.solvers import solvers

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A folder of one's own models with a broken file."""
    folder = tmp_path / "own"
    folder.mkdir()
    (folder / "cluster_broken.py").write_text(
        "import nothing_of_that_name\n\nSPEC = build = None\n"
    )
    return folder


def line_of(text: str, name: str) -> str:
    """The table's row of `name`."""
    return next(line for line in text.splitlines() if line.split()[:1] == [name])


def test_models_lists_every_formulation_and_says_what_is_broken(
    msmrta: Run, own: Path, capsys: Capture
) -> None:
    assert msmrta("models", "--models", own) == 0
    told = capsys.readouterr().out
    for item in registry.listings():
        assert line_of(told, item.name)
    assert "psi in [0,1]" in line_of(told, "cluster_one_to_one")
    assert "broken: " in told
    assert "No module named 'nothing_of_that_name'" in told


def test_models_of_a_stage_are_only_those(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("models", "--stage", "victim") == 0
    told = capsys.readouterr().out
    assert "victim_one_to_one" in told
    assert "cluster_one_to_one" not in told


def test_models_shows_sizes_on_an_instance(msmrta: Run, paper_file: Path, capsys: Capture) -> None:
    # Eq. 1 as printed: a variable for each of 4 robots and 4 clusters, a row per cluster.
    assert msmrta("models", paper_file, "--stage", "cluster") == 0
    told = capsys.readouterr().out
    assert line_of(told, "cluster_printed").split()[-2:] == ["16", "4"]


def test_show_prints_the_mathematics(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("show", "cluster_printed") == 0
    told = capsys.readouterr().out
    formulation = registry.get("cluster_printed")
    for line in formulation.mathematics.splitlines():
        assert line[:100].rstrip() in told
    assert "psi: " in told
    assert f"{formulation.path}" in "".join(told.splitlines())


def test_show_prints_the_size_and_structure_on_an_instance(
    msmrta: Run, paper_file: Path, capsys: Capture
) -> None:
    assert msmrta("show", "cluster_printed", paper_file) == 0
    told = capsys.readouterr().out
    assert line_of(told, "variables").split()[-1] == "16"
    assert line_of(told, "sense").split()[-1] == "max"
    assert line_of(told, "structure").split()[1:] != ["none", "recognised"]


def test_new_model_copies_a_formulation_that_is_then_found(
    msmrta: Run, tmp_path: Path, capsys: Capture
) -> None:
    given = ["--from", "cluster_printed", "--to", tmp_path]
    assert msmrta("new-model", "cluster_mine", *given) == 0
    told = capsys.readouterr().out
    assert "cluster_mine.py is a copy of cluster_printed" in told
    assert f"--models {tmp_path}" in "".join(told.splitlines())
    source = registry.get("cluster_printed").path
    assert (tmp_path / "cluster_mine.py").read_text() == source.read_text()
    assert msmrta("show", "cluster_mine", "--models", tmp_path) == 0


def test_solvers_lists_each_with_its_version_or_how_to_install_it(
    msmrta: Run, capsys: Capture
) -> None:
    assert msmrta("solvers") == 0
    told = capsys.readouterr().out
    for solver in solvers().values():
        row = line_of(told, solver.name)
        assert (solver.version if solver.installed else solver.install.split()[0]) in row


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["models", "none.json"], "none.json: no such file"),
        (["models", "--models", "none"], "none: no such folder of models"),
        (["models", "--stage", "lunch"], "'lunch'; give one of "),
        (["show"], "Missing argument"),
        (["show", "nothing"], "no formulation 'nothing'"),
        (["show", "cluster_broken", "--models", "own"], "nothing_of_that_name"),
        (["show", "cluster_printed", "none.json", "--models", "own"], "none.json: no such file"),
        (["new-model", "mine"], "give either --from MODEL or --blank STAGE"),
        (["new-model", "mine", "--blank", "rooting"], "'rooting' (did you mean 'routing'?)"),
        (["new-model", "mine", "--blank", "victim", "--to", "none"], "no such folder"),
        (["show", "cluster_printed", "--data"], "--data: is of an instance; give one"),
        (["new-model", "mine", "--from", "nothing", "--to", "own"], "no formulation 'nothing'"),
        (["new-model", "my-model", "--from", "cluster_printed"], "give a Python name"),
        (["new-model", "_mine", "--from", "cluster_printed"], "give a Python name"),
        (["new-model", "class", "--from", "cluster_printed"], "give a Python name"),
        (["new-model", "victim_printed", "--from", "cluster_printed"], "is already the name of"),
        (["new-model", "mine", "--from", "cluster_printed", "--to", "none"], "no such folder"),
    ],
)
def test_bad_input_gets_one_line_and_status_2_and_writes_nothing(
    arguments: list[str],
    problem: str,
    msmrta: Run,
    own: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.chdir(own.parent)
    shipped = registry.get("cluster_printed").path.parent
    before = sorted(shipped.glob("*.py")), sorted(own.iterdir())
    status = msmrta(*arguments)
    told = capsys.readouterr()
    assert status == 2
    assert told.err.startswith("error: ")
    assert told.err.count("\n") == 1
    assert problem in told.err
    assert (sorted(shipped.glob("*.py")), sorted(own.iterdir())) == before
