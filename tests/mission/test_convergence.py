"""Convergence: steps of a search by hand, what is worked out of them, and plans without any."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import msmrta_opt as mo
from msmrta_opt.mission.convergence import SearchRecord, SearchStep
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners.support.improvement import improve_plan

STEPS = (
    SearchStep(seconds=0.5, incumbent=100, bound=None, event="better routes"),
    SearchStep(seconds=1, incumbent=100, bound=60, event="combinatorial"),
    SearchStep(seconds=2, incumbent=80, bound=60, event="better routes"),
    SearchStep(seconds=4, incumbent=80, bound=76, event="root LP"),
    SearchStep(seconds=5, incumbent=80, bound=76, event="end"),
)
RECORD = SearchRecord(objective="makespan", unit="time units", steps=STEPS)


def searched(plan: Plan, record: SearchRecord = RECORD) -> Plan:
    return plan.model_copy(update={"search": record})


def test_gaps_are_shares_of_the_incumbent_and_the_best_is_there_when_it_was_found(
    plan: Plan,
) -> None:
    found = searched(plan).convergence()
    # (100 − 60) / 100, (80 − 60) / 80, (80 − 76) / 80
    assert [row["gap"] for row in found.rows] == [None, 0.4, 0.25, 0.05, 0.05]
    assert found.summary == [
        {
            "plan": "by hand",
            "incumbent": 80,
            "bound": 76,
            "gap": 0.05,
            "best after (s)": 2,
            "seconds": 5,
        }
    ]
    frame = found.to_frame()
    assert list(frame["event"]) == [step.event for step in STEPS]


def test_the_record_is_kept_in_the_file_and_files_without_one_are_read(
    plan: Plan, tmp_path: Path
) -> None:
    file = tmp_path / "plan.json"
    searched(plan).save(file)
    assert Plan.read(file).search == RECORD
    document = plan.document()
    del document["search"]
    file.write_text(json.dumps(document), encoding="utf-8")
    assert Plan.read(file) == plan


def test_plans_are_the_same_whatever_their_search_took(plan: Plan) -> None:
    assert searched(plan).same_as(plan)


def test_a_plan_without_a_record_is_refused_by_name(plan: Plan) -> None:
    with pytest.raises(
        InputError, match=r"^search: 'other' of the planner 'by hand' has no record"
    ):
        searched(plan).convergence(other=plan)


def test_searches_of_two_objectives_are_refused(plan: Plan) -> None:
    latency = RECORD.model_copy(update={"objective": "latency"})
    with pytest.raises(InputError, match="'by hand' minimises makespan, 'b' minimises latency"):
        searched(plan).convergence(b=searched(plan, latency))


@pytest.mark.parametrize("objective", ["total_time", "latency"])
def test_the_exact_planner_keeps_how_it_closed_in(objective: str) -> None:
    made = mo.plan(mo.example("two_rooms"), planner="exact", objective=objective)
    assert made.search is not None
    steps, (certificate,) = made.search.steps, made.certificates
    assert made.search.objective == objective
    assert (steps[-1].incumbent, steps[-1].bound) == (certificate.objective, certificate.bound)
    assert [step.seconds for step in steps] == sorted(step.seconds for step in steps)
    worth = [step.incumbent for step in steps]
    bounds = [step.bound for step in steps if step.bound is not None]
    assert worth == sorted(worth, reverse=True)
    assert bounds == sorted(bounds)


def test_better_routes_on_an_old_search_leave_no_record_of_it() -> None:
    made = mo.plan(mo.example("paper"), planner="greedy").model_copy(update={"search": RECORD})
    better = improve_plan(made, iterations=500)
    assert better.metrics.total_time < made.metrics.total_time
    assert better.search is None
