"""A run that was tampered with is refused, whatever was changed."""

from __future__ import annotations

import contextlib
import copy
import random
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import pytest
from pydantic import ValidationError
from support import executions
from support.amounts import sample

from msmrta_opt.certify.run import problems
from msmrta_opt.certify.run_figures import figures
from msmrta_opt.execution.execute import execute
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.run import Run
from msmrta_opt.planners import plan as make_plan

PARTS = ("world", "tracks", "services", "events", "decisions", "figures")


@cache
def document(number: int) -> dict[str, Any]:
    plan = executions.plan(number)
    return execute(plan, executions.scenario(number, plan), seed=number).document()


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, (dict, list)):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            yield from leaves(item, (*path, key))
    else:
        yield path


def tampered(chance: random.Random, given: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Another document, in which one value is changed, or one item is gone or there twice."""
    changed = copy.deepcopy(given)
    part = chance.choice([name for name in PARTS if changed[name]])
    if part not in ("world", "figures") and chance.random() < 0.3:
        items = changed[part]
        i = chance.randrange(len(items))
        what = chance.choice(["drop", "twice"])
        items[i : i + 1] = [] if what == "drop" else [items[i], items[i]]
        return f"{what} {part}[{i}]", changed
    path = chance.choice(list(leaves(changed[part])))
    inside = changed[part]
    for key in path[:-1]:
        inside = inside[key]
    old = inside[path[-1]]
    if isinstance(old, bool):
        new: Any = not old
    elif isinstance(old, (int, float)):
        is_small = chance.random() < 0.7 and abs(old) < 1e6  # so that it is more than rounding
        new = old + chance.choice([1, 2, 1000]) if is_small else old * 1.5 + 1
    else:
        new = chance.choice(["Defuser", "lost", "served", None, 3])
    inside[path[-1]] = new
    return f"{part}{list(path)}: {old!r} is {new!r}", changed


@pytest.mark.parametrize("number", sample(range(60), quick=3))
def test_a_run_with_one_thing_changed_is_refused(number: int) -> None:
    chance, given = random.Random(number), document(number)
    assert problems(Run.model_validate(given)) == []
    for _ in range(25):
        what, changed = tampered(chance, given)
        if changed == given:
            continue
        with contextlib.suppress(ValidationError):  # no run at all
            wrong = problems(Run.model_validate(changed))
            # What was drawn and made no difference may be all that can be drawn.
            assert wrong or what.startswith(("world['lost", "world['speeds", "world['services")), (
                what
            )


@pytest.fixture
def corridor() -> dict[str, Any]:
    """A run in which nothing happens: victim 7 is served from 2 to 12, victim 8 from 15 to 25."""
    return execute(make_plan(Instance.from_document(executions.CORRIDOR), planner="ssi")).document()


def figured(changed: dict[str, Any]) -> Run:
    """The run of a document, with the figures that are right for it."""
    run = Run.model_validate(changed)
    return run.model_copy(update={"figures": figures(run)})


def end_after_the_first(changed: dict[str, Any]) -> None:
    """Victim 8 is not served, and nobody says why."""
    track = changed["tracks"][0]
    track["cells"], track["times"] = track["cells"][:3], track["times"][:3]
    del changed["services"][1], changed["events"][1]


def wait_and_end(changed: dict[str, Any]) -> None:
    end_after_the_first(changed)
    changed["options"]["blocked"] = "wait"


def leave_out(changed: dict[str, Any]) -> None:
    end_after_the_first(changed)
    changed["events"].append({"time": 12.0, "what": "skipped", "robot": 4, "victim": 8})


def be_lost_much_later(changed: dict[str, Any]) -> None:
    end_after_the_first(changed)
    changed["scenario"]["lost"] = [{"robot": 4, "time": 1e9}]
    changed["world"]["lost"] = [{"robot": 4, "time": 1e9}]


def stand_still(changed: dict[str, Any]) -> None:
    """All that comes after the start comes 100 later."""
    track = changed["tracks"][0]
    track["times"] = [track["times"][0], *(time + 100 for time in track["times"][1:])]
    for service in changed["services"]:
        service["began"], service["ended"] = service["began"] + 100, service["ended"] + 100
    for event in changed["events"]:
        event["time"] += 100


def wander(changed: dict[str, Any]) -> None:
    """To the next cell and back before it begins, and so 2 later."""
    stand_still(changed)
    for values in (*changed["services"], *changed["events"]):
        for name in {"began", "ended", "time"} & values.keys():
            values[name] -= 98
    track = changed["tracks"][0]
    track["cells"] = [[0, 0], [0, 1], *track["cells"]]
    track["times"] = [0.0, 1.0, 2.0, *(time - 98 for time in track["times"][1:])]


def leave_out_nothing(changed: dict[str, Any]) -> None:
    changed["events"].append({"time": 25.0, "what": "skipped"})


def decide(changed: dict[str, Any]) -> None:
    """A decision that changes nothing, and that nothing has given rise to."""
    queues = [{"robot": 4, "visits": [{"victim": 8, "served": ["Aid"]}]}]
    decision = {"time": 12.0, "before": queues, "after": queues, "changed": 0}
    changed["decisions"] = [decision]
    changed["events"].insert(1, {"time": 12.0, "what": "decided"})


def wait_in_vain(changed: dict[str, Any]) -> None:
    """Where nothing is blocked."""
    wait_and_end(changed)
    changed["events"].append({"time": 12.0, "what": "waiting", "robot": 4, "victim": 8})


def wait_for_what_is_done(changed: dict[str, Any]) -> None:
    """Victim 7, which is served; cell 5 of the corridor is blocked before the robot is near it."""
    end_after_the_first(changed)
    changed["options"]["blocked"] = "wait"
    close(changed, 5)
    changed["events"].append({"time": 12.0, "what": "waiting", "robot": 4, "victim": 7})


def wait_for_longer_than_the_run(changed: dict[str, Any]) -> None:
    end_after_the_first(changed)
    changed["options"]["blocked"] = "wait"
    close(changed, 5)
    changed["events"].append({"time": 99.0, "what": "waiting", "robot": 4, "victim": 8})


def close(changed: dict[str, Any], col: int) -> None:
    changed["scenario"]["corridors"] = [{"cells": [[0, col]], "blocked": 1.5}]
    changed["world"]["changes"] = [{"time": 1.5, "cell": [0, col], "free": False}]
    changed["events"].insert(0, {"time": 1.5, "what": "blocked", "cell": [0, col]})


def blocked_after_all(changed: dict[str, Any]) -> None:
    """A corridor is blocked long after the mission: no reason to wait before."""
    changed["options"]["blocked"] = "wait"
    changed["scenario"]["until"] = 9999.0
    close(changed, 3)
    for item in (changed["world"]["changes"][0], changed["events"][0]):
        item["time"] = 5000.0
    changed["scenario"]["corridors"][0]["blocked"] = 5000.0
    changed["events"].append(changed["events"].pop(0))


def do_nothing_before_a_block(changed: dict[str, Any]) -> None:
    blocked_after_all(changed)
    track = changed["tracks"][0]
    track["cells"], track["times"] = track["cells"][:1], track["times"][:1]
    changed["services"] = []
    changed["events"] = changed["events"][-1:]


def stand_still_before_a_block(changed: dict[str, Any]) -> None:
    stand_still(changed)
    blocked_after_all(changed)


def go_on_after_the_end(changed: dict[str, Any]) -> None:
    changed["scenario"]["until"] = 20.0


def lose_who_is_done(changed: dict[str, Any]) -> None:
    """At a rate, after all is done: nobody would have waited for it."""
    changed["scenario"]["lost"] = [{"rate": 0.001}]
    changed["world"]["lost"] = [{"robot": 4, "time": 77.0}]
    changed["events"].append({"time": 77.0, "what": "lost", "robot": 4, "cell": [0, 5]})


def forget_who_was_lost_before_its_time(changed: dict[str, Any]) -> None:
    """Done at 25; lost at 77 at a rate, where the scenario has it lost at 1000 at the latest."""
    changed["scenario"]["lost"] = [{"robot": 4, "time": 1000.0}, {"rate": 0.001}]
    changed["world"]["lost"] = [{"robot": 4, "time": 77.0}]


FALSE = {
    end_after_the_first: "robot 4 does not do at victim 8 what it is told",
    wait_and_end: "robot 4 does not do at victim 8 what it is told",
    leave_out: "robot 4 leaves out a visit at 12, when nothing is blocked",
    be_lost_much_later: "robot 4 does not do at victim 8 what it is told",
    wait_in_vain: "robot 4 waits until 12, when nothing is blocked",
    wait_for_what_is_done: "robot 4 waits for a way to victim 7, for no reason",
    wait_for_longer_than_the_run: "robot 4 waits until 99, which should be 12",
    go_on_after_the_end: "robot 4 serves Aid at victim 8 until 25, but the run ended at 20",
    lose_who_is_done: "an event did not happen: lost (4, (0, 5)) at 77",
    forget_who_was_lost_before_its_time: "an event is missing: lost (4, (0, 5)) at 77",
    stand_still: "robot 4 stands still from 0 to 100, for no reason",
    wander: "robot 4 goes another way than the plan, for no reason",
    do_nothing_before_a_block: "robot 4 does not do at victim 7 what it is told",
    stand_still_before_a_block: "robot 4 stands still from 0 to 100, for no reason",
    leave_out_nothing: "what is left out at 25 is no visit of a robot to a victim",
    decide: "the policy keep decides nothing, and there are decisions",
}


@pytest.mark.parametrize("change", FALSE, ids=lambda change: change.__name__)
def test_what_a_robot_does_for_no_reason_is_refused(
    change: Callable[[dict[str, Any]], None], corridor: dict[str, Any]
) -> None:
    assert problems(figured(corridor)) == []
    change(corridor)
    assert problems(figured(corridor))[0] == FALSE[change]


def test_a_block_long_after_all_is_done_is_no_fault(corridor: dict[str, Any]) -> None:
    blocked_after_all(corridor)
    assert problems(figured(corridor)) == []


def test_the_checker_counts_what_an_opened_wall_lets_robots_reach() -> None:
    plan = make_plan(Instance.from_document(executions.WALLED), planner="ssi")
    opened = {"notice": "at_once", "corridors": [{"cells": [[0, 3]], "opened": 10.0}]}
    run = execute(plan, opened, "repair")
    assert figures(run)["n_available"] == 2
    false = {**run.figures, "n_available": 1, "served_share": 2.0}
    assert problems(run.model_copy(update={"figures": false})) == [
        "n_available is 1, which should be 2",
        "served_share is 2, which should be 1",
    ]


def test_a_victim_that_needs_what_there_is_not_is_refused_and_no_error(
    corridor: dict[str, Any],
) -> None:
    victim = {"id": 50, "cell": [0, 3], "requirements": ["Water"]}
    corridor["world"]["unknown"] = [{"victim": victim}]
    assert problems(Run.model_validate(corridor)) == [
        "the victims that are unknown are not those of the scenario and of the scouts"
    ]


@pytest.mark.parametrize("factor", [1e-300, 5e-324, 1e-6])
def test_speeds_and_times_that_are_cut_off_pass(factor: float) -> None:
    slow = {**executions.CORRIDOR, "robots": [{**executions.CORRIDOR["robots"][0], "speed": 1e-27}]}
    plan = make_plan(Instance.from_document(slow), planner="ssi")
    assert problems(execute(plan, {"speed": [{"value": factor}]})) == []
