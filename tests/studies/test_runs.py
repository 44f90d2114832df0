"""A run is keyed by what determines its result, and by nothing else."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from support.studies import do, write_study

from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.maps import write_map
from msmrta_opt.optimise import registry
from msmrta_opt.studies import missions
from msmrta_opt.studies.ledger import Ledger
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


@pytest.mark.parametrize(
    ("edited", "touched"),
    [
        ("joint_routing_flow", {"exact within limits"}),
        ("cluster_one_to_one", {"msmrta"}),
        ("victim_one_to_one", {"msmrta"}),
    ],
)
def test_an_edited_formulation_touches_the_planners_whose_options_make_them_use_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, edited: str, touched: set[str]
) -> None:
    text = (
        'title = "Keys"\n[[instances]]\nmaps = "open.map"\nrobots = 2\nvictims = 2\n'
        '[[planners]]\n[[planners]]\nplanner = "exact"\n[[planners]]\nplanner = "exact"\n'
        'name = "exact within limits"\nendurance = 100\n'
    )
    before = keys(folder, text)
    path_of = registry.path_of
    copy = folder / f"{edited}.py"
    copy.write_bytes(path_of(edited).read_bytes() + b"# another thought\n")
    monkeypatch.setattr(registry, "path_of", lambda n: copy if n == edited else path_of(n))
    after = keys(folder, text)
    assert {name for name in before if before[name] != after[name]} == touched


def test_to_look_at_a_study_makes_no_mission_anew(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (
        'title = "Seen"\n[[instances]]\nmaps = "open.map"\nrobots = 2\nvictims = 2\n'
        'seeds = [0, 1]\n[[planners]]\nplanner = "greedy"\n'
    )
    path = write_study(folder, text)
    todo = runs(Study.read(path))
    with Ledger(Study.read(path).ledger) as ledger:
        ledger.keep_missions(run.mission for run in todo)
    with Ledger(Study.read(path).ledger, read_only=True) as ledger:
        known = ledger.missions()
    monkeypatch.setattr(missions, "generate_mission", lambda *_, **__: 1 / 0)
    seen = runs(Study.read(path), known)
    assert [(run.key, run.mission.name) for run in seen] == [
        (run.key, run.mission.name) for run in todo
    ]
    # What it does not know it makes: another seed, and the same on another map.
    for changed in (text.replace("[0, 1]", "[2]"), text):
        write_study(folder, changed)
        if changed is text:
            write_map(GridMap([[True] * 5] * 5, name="open"), folder / "open.map")  # type: ignore[arg-type]
        with pytest.raises(ZeroDivisionError):
            runs(Study.read(path), known)


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
