from __future__ import annotations

import copy
from pathlib import Path
from typing import Annotated, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field, ValidationError

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.scenario import Scenario
from msmrta_opt.mission.validation import at, first_problem
from msmrta_opt.studies.specification import Study

printable = st.text(st.characters(exclude_categories=("C", "Z")), max_size=8)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | printable,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(printable, inner, max_size=3),
    max_leaves=5,
)


def places(document: Any, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """The path of every value in a document, the document itself first."""
    inner = (
        document.items()
        if isinstance(document, dict)
        else enumerate(document)
        if isinstance(document, list)
        else ()
    )
    return [path, *(place for key, value in inner for place in places(value, (*path, key)))]


def refusal(document: dict[str, Any]) -> str | None:
    """What is wrong with a document, or `None` if it is right."""
    try:
        Instance.from_document(document)
    except InputError as error:
        return str(error)
    return None


def test_a_path_into_a_document_reads_as_in_python() -> None:
    assert at("robots", 2, "speed") == "robots[2].speed"
    assert at("rows", 0, 4) == "rows[0][4]"
    assert at() == ""


def test_a_field_name_with_a_line_break_does_not_break_the_line() -> None:
    assert at("robots", 0, "a\nb") == r"robots[0].'a\nb'"


@given(data=st.data())
def test_whatever_stands_in_a_field_is_accepted_or_refused_in_one_line(
    data: st.DataObject, mission: Instance
) -> None:
    document = copy.deepcopy(mission.document())
    *path, last = data.draw(st.sampled_from(places(document)[1:]))
    holder: Any = document
    for key in path:
        holder = holder[key]
    holder[last] = data.draw(json_values)
    problem = refusal(document)
    assert problem is None or (problem and problem.isprintable())


def test_a_long_value_is_cut_so_that_the_line_stays_readable(mission: Instance) -> None:
    cut, whole = ({"clusters": "x" * length} for length in (59, 58))
    assert refusal(mission.document() | cut) == f"clusters: '{'x' * 58}…; give a list, […]"
    assert refusal(mission.document() | whole) == f"clusters: '{'x' * 58}'; give a list, […]"


def test_a_long_value_is_cut_where_a_map_should_be(mission: Instance) -> None:
    problem = refusal(mission.document() | {"map": [0] * 1000})
    assert problem is not None
    assert problem.startswith("map: [0, 0, 0")
    assert "…; give a .map file's path" in problem
    assert len(problem) < 180


def test_a_finding_without_words_of_our_own_is_told_in_pydantics() -> None:
    class Pair(BaseModel):
        size: Annotated[int, Field(multiple_of=2)]

    with pytest.raises(ValidationError) as caught:
        Pair(size=3)
    assert str(first_problem(caught.value)) == "size: 3; input should be a multiple of 2"


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"name": 3}, "name: 3; give a text in quotes"),
        ({"robots": []}, "robots: []; give a list of 1 or more"),
        ({"clusters": [0.5, 0, 0, 0]}, "clusters[0]: 0.5; give a whole number"),
        ({"clusters": ["x", 0, 0, 0]}, "clusters[0]: 'x'; give a whole number"),
        ({"service_time": {"A": "x"}}, "service_time.A: 'x'; give a finite number"),
        ({"service_time": 5}, 'service_time: 5; give an object, {"name": value, …}'),
        ({"robots": 5}, "robots: 5; give a list, […]"),
        ({"robots": [5]}, 'robots[0]: 5; give an object, {"name": value, …}'),
        ({"format": None}, "format: null; give 'msmrta-instance/1'"),
        ({"format": ["ö\u2028"]}, r"""format: ["ö\u2028"]; give 'msmrta-instance/1'"""),
        ({"format": ["ö"]}, "format: [\"ö\"]; give 'msmrta-instance/1'"),
    ],
)
def test_a_change_in_python_is_refused_in_the_same_words_as_a_file(
    mission: Instance, change: dict[str, Any], problem: str
) -> None:
    with pytest.raises(InputError) as caught:
        mission.replace(**change)
    assert str(caught.value) == problem


def test_one_table_where_there_may_be_several_is_told_how_they_are_written(tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text("[lost]\nrobot = 1\ntime = 3\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        Scenario.read(path)
    assert str(refused.value) == (
        f'{path}: lost: {{"robot": 1, "time": 3}}; write [[lost]], for there may be several'
    )
    for name in ("instances", "planners", "formulations", "scenarios", "policies"):
        tables: dict[str, Any] = {"title": "", "instances": [{"files": "paper"}], name: {}}
        with pytest.raises(InputError) as refused:
            Study.of(tables, path)
        assert (
            str(refused.value)
            == f"{path}: {name}: {{}}; write [[{name}]], for there may be several"
        )
