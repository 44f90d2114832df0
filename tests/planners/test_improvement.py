"""Improvement by local search: for any planner, never worse, and repeatable."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt.certify.plan import problems
from msmrta_opt.interruption import interruptible
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan, Reason
from msmrta_opt.planners import plan, planners
from msmrta_opt.planners.support.improvement import improve_plan
from msmrta_opt.routing.objectives import OBJECTIVES

PLANNERS = ("greedy", "mrga", "msmrta", "random", "ssi")
ROOMS = grid_from_rows(["...@....", ".@.@.@..", ".@...@..", ".@@@.@@.", "........"])


# Enough iterations for small missions.
BRIEFLY: dict[str, Any] = {
    "improve": True,
    "parameters": {"heuristics": {"default_iterations": 300}},
}


@pytest.fixture
def twice() -> Instance:
    """A robot at 0 with A (1) and B (100); victim 0 at 1 needs both, victim 1 at 2 needs A.

    MRGA takes A of 0; then B of 0 would cost 0.25 · 101 + 0.2 · 100, and A of 1 next to nothing: so
    it visits victims 0, 1 and again 0.
    """
    return Instance(
        map=grid_from_rows(["..."]),
        capabilities=("A", "B"),
        service_time={"A": 1, "B": 100},
        robots=(Robot(id=0, start=(0, 0), speed=1, capabilities=("A", "B")),),
        victims=(
            Victim(id=0, cell=(0, 1), requirements=("A", "B")),
            Victim(id=1, cell=(0, 2), requirements=("A",)),
        ),
    )


def worth(made: Plan, objective: str) -> float:
    return float(getattr(made.metrics, objective))


def visits(made: Plan) -> list[int]:
    return [visit.victim for route in made.routes for visit in route.visits]


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("planner", PLANNERS)
def test_an_improved_plan_holds_serves_the_same_and_is_never_worse(
    planner: str, objective: str
) -> None:
    for seed in range(4):
        mission = generate_mission(ROOMS, 3, 7, seed=seed, solvable=False)
        before = planners()[planner].run(mission)
        after = plan(mission, planner=planner, **BRIEFLY, objective=objective)
        assert problems(after) == []
        assert worth(after, objective) <= worth(before, objective) + 1e-9
        assert after.unserved == before.unserved
        assert after.metrics.n_served == before.metrics.n_served
        assert after.planner == planner


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_same_seed_improves_to_the_same_plan(planner: str, paper: Instance) -> None:
    first, again = (plan(paper, planner=planner, **BRIEFLY, seed=2) for _ in range(2))
    assert first.same_as(again)
    assert plan(paper, planner=planner, **first.options).same_as(first)


def test_a_random_plan_is_much_improved_on_the_papers_mission(paper: Instance) -> None:
    before = plan(paper, planner="random")
    after = plan(paper, planner="random", **BRIEFLY)
    assert worth(after, "total_time") < 0.9 * worth(before, "total_time")


def test_a_robots_repeated_visits_are_joined(twice: Instance) -> None:
    # 0 to 1 to 2 to 1 and 102 of service; joined, the last move is saved.
    before = plan(twice, planner="mrga")
    assert visits(before) == [0, 1, 0]
    assert worth(before, "total_time") == 105
    after = plan(twice, planner="mrga", **BRIEFLY)
    assert sorted(visits(after)) == [0, 1]
    assert worth(after, "total_time") == 104


def test_joining_visits_is_undone_where_it_would_be_worse(twice: Instance) -> None:
    # Victim 1 done at 4 and victim 0 at 105 in MRGA's order; joined, 102 and 104. The best is
    # victim 1 first, at 3, then victim 0 at 105.
    before = plan(twice, planner="mrga")
    assert worth(before, "latency") == 109
    unchanged = plan(twice, planner="mrga", improve=0.0, objective="latency")
    assert unchanged.routes == before.routes
    after = plan(twice, planner="mrga", **BRIEFLY, objective="latency")
    assert visits(after) == [1, 0]
    assert worth(after, "latency") == 108


def test_seconds_may_be_given(paper: Instance) -> None:
    made = plan(paper, improve=0.2, objective="makespan")
    assert problems(made) == []
    assert worth(made, "makespan") <= worth(plan(paper), "makespan")
    assert made.options["objective"] == "makespan"


def test_victims_that_the_scouts_do_not_find_stay_unserved(instances_dir: Path) -> None:
    mission = Instance.read(instances_dir / "scouted.json")
    for planner in PLANNERS:
        made = plan(mission, planner=planner, **BRIEFLY)
        assert problems(made) == []
        assert visits(made) == [0]
        assert [(item.victim, item.reason) for item in made.unserved] == [(1, Reason.NOT_FOUND)]
        assert made.metrics.total_time == 5


def test_a_plan_without_visits_stays_as_it_is(instances_dir: Path) -> None:
    nobody = plan(Instance.read(instances_dir / "no_victims.json"))
    assert improve_plan(nobody) is nobody


def test_improved_visits_say_so_and_the_record_says_how(paper: Instance) -> None:
    made = plan(paper, planner="random", **BRIEFLY, objective="latency")
    assert {visit.stage for route in made.routes for visit in route.visits} == {"improved"}
    assert (made.options["improve"], made.options["objective"]) == (True, "latency")
    assert "improvement" in made.planning_seconds


def test_a_plan_that_keeps_to_limits_is_left_to_its_planner(instances_dir: Path) -> None:
    mission = Instance.read(instances_dir / "two_rooms.json")
    limited = plan(mission, planner="exact", return_to_start=True)
    with pytest.raises(InputError, match="improve: the plan keeps to return_to_start"):
        improve_plan(limited)


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send on Windows")
@pytest.mark.parametrize("planner", ["msmrta", "random"])
@pytest.mark.parametrize("improve", [True, 1e6])
def test_ctrl_c_ends_the_improvement_with_the_best_plan_there_is(
    planner: str, improve: float, paper: Instance
) -> None:
    """Whoever waits for days of search does not get past the call below."""
    with interruptible():
        os.kill(os.getpid(), signal.SIGINT)
        made = plan(paper, planner=planner, improve=improve)
    assert problems(made) == []
    assert made.metrics.total_time <= plan(paper, planner=planner).metrics.total_time


def test_an_improvement_that_is_interrupted_keeps_the_plan(
    paper: Instance, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the distances of a large mission are not worked out yet."""
    monkeypatch.setattr("msmrta_opt.planners.support.improvement.interrupted", lambda: True)
    before = plan(paper, planner="greedy")
    assert improve_plan(before, seconds=3600) is before
