"""A run is keyed by what determines its result, and by nothing else."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from support.studies import do, write_study

from msmrta_opt.studies.runs import current, runs
from msmrta_opt.studies.specification import Study

TEXT = """
title = "Keys"
[[instances]]
maps = "open.map"
robots = 2
victims = 2
[[planners]]
psi = 0.5
[[planners]]
planner = "mrga"
alpha = 0.25
[[formulations]]
stage = "cluster"
models = ["cluster_one_to_one", "cluster_mine"]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a study's map and a formulation of one's own."""
    shipped = Path(__file__).parents[2] / "models" / "cluster_one_to_one.py"
    (tmp_path / "mine").mkdir()
    shutil.copy(shipped, tmp_path / "mine" / "cluster_mine.py")
    return tmp_path


def keys(folder: Path, text: str) -> dict[str, str]:
    path = write_study(folder, text.replace("[[instances]]", 'models = ["mine"]\n[[instances]]', 1))
    return {run.contender.partition(" by ")[0]: run.key for run in runs(Study.read(path))}


@pytest.mark.parametrize(
    ("change", "touched"),
    [
        (("psi = 0.5", "psi = 0.6"), {"msmrta"}),
        (("alpha = 0.25", "alpha = 0.3"), {"mrga"}),
        (("psi = 0.5", "psi = 0.5\ncluster_model = 'cluster_printed'"), {"msmrta"}),
        (("victims = 2", "victims = 3"), {"msmrta", "mrga", "cluster_one_to_one", "cluster_mine"}),
        (
            ("[[planners]]", "[timing]\nrepetitions = 2\n[[planners]]"),
            {"msmrta", "mrga", "cluster_one_to_one", "cluster_mine"},
        ),
        (("[[planners]]", "[limits]\nseconds = 9\n[[planners]]"), set()),
        (('"Keys"', '"Other words"'), set()),
    ],
)
def test_a_change_touches_the_runs_that_it_may_change(
    folder: Path, change: tuple[str, str], touched: set[str]
) -> None:
    before, after = keys(folder, TEXT), keys(folder, TEXT.replace(*change, 1))
    assert {name for name in before if before[name] != after[name]} == touched


def test_an_edited_formulation_touches_its_own_runs(folder: Path) -> None:
    before = keys(folder, TEXT)
    edited = folder / "mine" / "cluster_mine.py"
    edited.write_text(edited.read_text() + "\n# another thought\n")
    after = keys(folder, TEXT)
    assert {name for name in before if before[name] != after[name]} == {"cluster_mine"}


def test_a_run_of_other_versions_stands_in_until_it_is_done_again(folder: Path) -> None:
    path = write_study(folder, TEXT[: TEXT.index("[[formulations]]")])
    todo = runs(Study.read(path))
    old = [replace(record, key=f"old {record.key}") for record in do(path)]
    assert [record.key for record in current(todo, old)] == [f"old {run.key}" for run in todo]
    newer = replace(old[0], key=todo[0].key)
    assert [record.key for record in current(todo, [*old, newer])] == [
        todo[0].key,
        f"old {todo[1].key}",
    ]
