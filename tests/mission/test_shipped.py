"""Shipped instances by name: a file of the name comes first, and a misspelt one is told."""

from __future__ import annotations

from pathlib import Path

import pytest

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.shipped import find_instance, shipped_instances
from msmrta_opt.mission.suggestions import meant


def test_every_shipped_file_has_a_name_and_is_read_by_it(
    instances_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {*instances_dir.glob("*.json"), *instances_dir.glob("suite/*.json")}
    assert set(shipped_instances().values()) == files
    assert mo.examples() == list(shipped_instances())
    assert mo.read("paper") == mo.example() == Instance.read(instances_dir / "paper.json")
    assert mo.example("suite/rooms") == Instance.read(instances_dir / "suite" / "rooms.json")


def test_a_file_of_the_name_comes_first_and_a_folder_does_not(
    instances_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper").mkdir()
    assert mo.read("paper") == mo.example("paper")
    (tmp_path / "split").write_bytes((instances_dir / "corridor.json").read_bytes())
    assert mo.read("split") == mo.example("corridor")
    assert find_instance("-") == Path("-")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("papr", r"papr: no such file, nor a shipped instance \(did you mean 'paper'\?\)"),
        ("suite/roms", r"no such file, nor a shipped instance \(did you mean 'suite/rooms'\?\)"),
        ("quite else", "quite else: no such file, nor a shipped instance$"),
        ("min.jsn", r"min.jsn: no such file \(did you mean 'mine.json'\?\)"),
        ("quite.json", "quite.json: no such file$"),
    ],
)
def test_a_misspelt_name_is_told_what_was_meant(
    name: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for there in ("mine.json", "min.png", "quite.png"):  # a picture is not what was meant
        (tmp_path / there).write_text("{}")
    with pytest.raises(InputError, match=said):
        mo.read(name)


def test_an_example_is_never_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").write_text("{}")
    with pytest.raises(InputError, match=r"example: 'mine'.*; give one of corridor, no_victims, "):
        mo.example("mine")


def test_the_nearest_name_is_meant_whatever_its_case_and_hyphens() -> None:
    known = ["cluster_one_to_one", "cluster_fair", "psi"]
    assert meant("cluster-one-to-on", known) == " (did you mean 'cluster_one_to_one'?)"
    assert meant("PSI", known) == " (did you mean 'psi'?)"
    assert meant("budget", known) == ""
    assert meant("psi", []) == ""
