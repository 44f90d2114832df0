"""Plans as tables, and two beside each other, on the mission worked out by hand."""

from __future__ import annotations

from typing import Any

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan


def changed(plan: Plan, visits: dict[int, list[dict[str, Any]]]) -> Plan:
    """The plan with other visits of some robots."""
    document = plan.document()
    for route in document["routes"]:
        route["visits"] = visits.get(route["robot"], route["visits"])
    return Plan.model_validate(document | {"instance": plan.instance})


def visits_of(plan: Plan, robot: int) -> list[dict[str, Any]]:
    routes = plan.document()["routes"]
    return next(list(route["visits"]) for route in routes if route["robot"] == robot)


def test_visits_are_a_row_each_with_ids_cells_and_times(plan: Plan) -> None:
    rows = plan.to_frame("visits").to_dict("records")
    assert [tuple(row.values()) for row in rows] == [
        (7, 1, 20, "A, B", "first", 2, 2.0, 8.0),
        (7, 2, 10, "A", "second", 4, 12.0, 14.0),
        (3, 1, 10, "C", "first", 3, 6.0, 7.0),
    ]


def test_robots_are_a_row_each_with_travel_and_service(plan: Plan) -> None:
    # Robot 7 serves 6 + 2 and walks 6 cells at speed 1; robot 3 serves 1 and walks 3 at 0.5.
    rows = plan.to_frame("robots").set_index("robot").to_dict("index")
    assert rows[7] == {
        "visits": 2, "requirements": 3, "cells": 6, "service": 8.0, "travel": 6.0, "finished": 14.0,
    }  # fmt: skip
    assert rows[3] == {
        "visits": 1, "requirements": 1, "cells": 3, "service": 1.0, "travel": 6.0, "finished": 7.0,
    }  # fmt: skip


def test_metrics_are_a_row_each_with_their_units(plan: Plan) -> None:
    table = plan.to_frame("metrics").set_index("metric")
    assert table.loc["total_time", "value"] == 21
    assert table.loc["total_time", "unit"] == "time units"
    assert table.loc["distance", "value"] == 9
    assert table.loc["served_share", "value"] == 100  # in percent, as everywhere it is shown


def test_an_unknown_table_is_told_what_was_meant(plan: Plan) -> None:
    with pytest.raises(InputError, match=r"what: 'visit' \(did you mean 'visits'\?\); give one of"):
        plan.to_frame("visit")


def test_a_plan_without_visits_has_the_same_columns(mission: Instance, plan: Plan) -> None:
    idle = changed(plan, {7: [], 3: []})
    assert list(idle.to_frame().columns) == list(plan.to_frame().columns)
    assert len(idle.to_frame()) == 0


def test_nothing_moves_between_a_plan_and_itself(plan: Plan) -> None:
    same = plan.diff(plan)
    assert same.moved == []
    assert same.moved_requirements == []
    assert same.same_mission
    assert {row["difference"] for row in same.metrics} == {0}
    assert same.summary == "the plans serve the same alike"
    assert same.to_frame().empty


def test_what_another_robot_serves_and_what_is_no_longer_served_is_told(plan: Plan) -> None:
    # Robot 7 leaves out victim 10; robot 3 serves B of victim 20 after it, and A stays with 7.
    first = visits_of(plan, 7)[0] | {"served": ["A"], "departure": 4.0}
    moved = {
        "victim": 20, "served": ["B"], "stage": "second", "arrival": 15, "departure": 19.0,
        "cells": [[2, 2], [2, 3], [1, 3], [0, 3], [0, 2]],
    }  # fmt: skip
    other = changed(plan, {7: [first], 3: [*visits_of(plan, 3), moved]})
    found = plan.diff(other)
    rows = [tuple(row.values()) for row in found.moved]
    assert rows == [
        (10, "A", "no longer served", 7, 2, 14.0, None, None, None),
        (20, "A", "another time", 7, 1, 8.0, 7, 1, 4.0),
        (20, "B", "another robot", 7, 1, 8.0, 3, 2, 19.0),
    ]
    assert found.moved_requirements == [(10, "A"), (20, "B")]
    assert found.summary == (
        "3 requirements moved: another robot 1, another time 1, no longer served 1"
    )
    metrics = {row["metric"]: row for row in found.metrics}
    # 7: 2 + 2; 3: 6 + 1 + 8 + 4, where it was 14 and 7.
    assert metrics["total time (time units)"]["before"] == 21
    assert metrics["total time (time units)"]["after"] == 23
    assert metrics["total time (time units)"]["difference"] == 2
    back = other.diff(plan)
    assert [row["change"] for row in back.moved] == [
        "newly served", "another time", "another robot",
    ]  # fmt: skip


def test_kinds_that_move_together_are_one_row_and_a_frame_has_whole_ids(plan: Plan) -> None:
    later = [visit | {"departure": visit["departure"] + 1} for visit in visits_of(plan, 7)]
    table = plan.diff(changed(plan, {7: later})).to_frame()
    assert list(table["requirements"]) == ["A", "A, B"]
    assert list(table["robot before"]) == [7, 7]
    assert str(table["robot before"].dtype) == "Int64"


def test_plans_for_different_missions_say_so(plan: Plan) -> None:
    mission = plan.instance.replace(victims=plan.instance.victims[:-1])
    other = Plan.model_validate(plan.document() | {"instance": mission, "scouting": None})
    assert not plan.diff(other).same_mission
    assert "different missions" in plan.diff(other)._repr_html_()


def test_a_picture_of_both_plans_shows_a_panel_each(plan: Plan) -> None:
    figure = plan.diff(changed(plan, {3: []})).plot()
    titles = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert [title.split("\n")[0] for title in titles] == ["by hand", "by hand"]
    assert [title.split(", ")[1] for title in titles] == ["9 cells walked", "6 cells walked"]


@pytest.mark.parametrize("what", ["mission", "plan", "diff"])
def test_what_is_shown_in_a_notebook_is_short_and_escaped(what: str, plan: Plan) -> None:
    named = plan.instance.replace(name="<b>", description="a & b")
    odd = Plan.model_validate(plan.document() | {"instance": named})
    shown: Any = {"mission": named, "plan": odd, "diff": odd.diff(plan)}[what]
    assert len(repr(shown).splitlines()) == 1
    assert len(repr(shown)) < 200
    html = shown._repr_html_()
    assert "<b>" not in html
    assert html.count("<table>") == html.count("</table>") >= 1
