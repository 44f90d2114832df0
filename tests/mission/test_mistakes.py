"""All mistakes of a mission's file are told at once, up to ten, each with what was meant."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.by_hand import MISSION

from msmrta_opt import cli
from msmrta_opt.mission.errors import InputError, MistakesError
from msmrta_opt.mission.instance import Instance


def told(change: Callable[[dict[str, Any]], None]) -> list[str]:
    """What is said of the mission worked out by hand, after a change."""
    document = copy.deepcopy(MISSION)
    change(document)
    with pytest.raises(InputError) as caught:
        Instance.from_document(document)
    error = caught.value
    return [str(each) for each in error.each] if isinstance(error, MistakesError) else [str(error)]


def test_all_wrong_types_are_told_in_their_order() -> None:
    def change(document: dict[str, Any]) -> None:
        document["robots"][0]["speed"] = "fast"
        document["robots"][1]["id"] = -1
        document["victims"][2]["colour"] = "red"

    assert told(change) == [
        "robots[0].speed: 'fast'; give a finite number",
        "robots[1].id: -1; give 0 or more",
        "victims[2].colour: 'red'; there is no such field; correct its name or remove it",
    ]


def test_all_that_refers_to_nothing_is_told_in_its_order() -> None:
    def change(document: dict[str, Any]) -> None:
        document["robots"][1]["id"] = 7
        document["robots"][0]["start"] = [0, 4]
        document["victims"][0]["cell"] = [9, 9]
        document["victims"][3]["requirements"] = ["B", "E"]

    assert told(change) == [
        "robots[1].id: 7 is repeated; ids differ within a group",
        "robots[0].start: [0, 4] is in a wall; give a free cell",
        "victims[0].cell: [9, 9] is outside the map; rows are 0 to 2, columns 0 to 5",
        "victims[3].requirements: unknown kind 'E'; known here: A, B, C, D",
    ]


def test_no_more_than_ten_are_told() -> None:
    def change(document: dict[str, Any]) -> None:
        for victim in document["victims"]:
            victim["requirements"] = ["W", "X", "Y", "Z"]

    found = told(change)
    assert len(found) == 10
    # Four, four and a time for what victim 10 does not need, and one.
    assert found[9] == "victims[2].requirements: unknown kind 'W'; known here: A, B, C, D"


@pytest.mark.parametrize(
    ("where", "wrong", "meant"),
    [
        ((), "capabilites", "capabilities"),
        (("victims", 1), "serviceTime", "service_time"),
        (("robots", 0), "sped", "speed"),
        (("scouts", 1), "visual-field-depth", "visual_field_depth"),
    ],
)
def test_a_misspelt_field_is_told_what_was_meant(
    where: tuple[str | int, ...], wrong: str, meant: str
) -> None:
    def change(document: Any) -> None:
        for part in where:
            document = document[part]
        document[wrong] = 1

    (line,) = told(change)
    assert line.endswith(f"(did you mean {meant!r}?)")


def test_a_misspelt_kind_is_told_what_was_meant() -> None:
    def change(document: dict[str, Any]) -> None:
        text = json.dumps(document).replace('"A"', '"FirstAids"')
        document.update(json.loads(text))
        document["robots"][0]["capabilities"] = ["FirstAid"]

    (line,) = told(change)
    assert "unknown kind 'FirstAid' (did you mean 'FirstAids'?); known here: " in line


def test_a_time_of_a_kind_that_the_victim_does_not_need_is_told_so() -> None:
    assert told(lambda document: document["victims"][1]["service_time"].update(B=3)) == [
        "victims[1].service_time: a time for 'B', which victim 10 does not need (it needs A, C); "
        "remove it, or add the kind to its requirements"
    ]


def test_as_one_error_the_first_is_told_with_how_many_more() -> None:
    document = {**MISSION, "name": 1, "source": 2, "description": 3}
    with pytest.raises(MistakesError) as caught:
        Instance.from_document(document, file="mine.json")
    assert str(caught.value) == ("mine.json: name: 1; give a text in quotes (and 2 more mistakes)")
    assert {each.file for each in caught.value.each} == {"mine.json"}
    from_another_process = pickle.loads(pickle.dumps(caught.value))
    assert str(from_another_process) == str(caught.value)
    assert len(from_another_process.each) == 3


def test_the_command_line_has_a_line_for_each(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({**MISSION, "name": 1, "colour": 2}))
    assert cli.run(["check", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        f"error: {path}: name: 1; give a text in quotes",
        f"error: {path}: colour: 2; there is no such field; correct its name or remove it",
    ]


def test_a_variant_with_a_misspelt_field_is_told_what_was_meant() -> None:
    mission = Instance.from_document(MISSION)
    with pytest.raises(InputError, match=r"robot: no such field \(did you mean 'robots'\?\)"):
        mission.replace(robot=())
