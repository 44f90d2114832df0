"""What is wrong in Python is an error of the package's own types, in a line."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import msmrta_opt as mo

WRONG: dict[str, Callable[[], object]] = {
    "a name for a mission, planned": lambda: mo.plan("paper"),  # type: ignore[arg-type]
    "a name for a mission, its data": lambda: mo.stage_data("paper", "cluster"),  # type: ignore[arg-type]
    "a name for a mission, compared": lambda: mo.compare(["paper"]),  # type: ignore[list-item]
    "a name for a mission, traded off": lambda: mo.tradeoff("paper"),  # type: ignore[call-overload]
    "an unknown planner": lambda: mo.plan(mo.example("corridor"), planner="best"),
    "an unknown option": lambda: mo.plan(mo.example("corridor"), colour="red"),
    "an unknown stage": lambda: mo.stage_data(mo.example("corridor"), "lunch"),
    "an unknown example": lambda: mo.example("mine"),
    "a map without cells": lambda: mo.GridMap(np.zeros((0, 3), dtype=bool)),
    "an unknown parameter over which to trade off": lambda: mo.tradeoff(
        mo.example("corridor"),
        "phi",  # type: ignore[call-overload]
    ),
    "a number over which to trade off": lambda: mo.tradeoff(mo.example("corridor"), 3),  # type: ignore[call-overload]
    "a text for a count": lambda: mo.generate_mission("map0", "2", 3, seed=1),  # type: ignore[arg-type]
    "a text for a floor's resolution": lambda: mo.Occupancy(np.zeros((2, 2)), "x"),  # type: ignore[arg-type]
    "a floor's origin without a yaw": lambda: mo.Occupancy(np.zeros((2, 2)), 1, (0, 0)),  # type: ignore[arg-type]
    "a floor's origin that is not finite": lambda: mo.Occupancy(
        np.zeros((2, 2)), 1, (0, float("nan"), 0)
    ),
    "a list for a floor": lambda: mo.coarsen([[0]], 1),  # type: ignore[arg-type]
    "percent beyond 100": lambda: mo.Occupancy.from_percent([[101]], 1),
    "an unknown map": lambda: mo.generate_mission("map9", 2, 3, seed=1),
    "a mission for a plan, executed": lambda: mo.execute(mo.example("corridor")),  # type: ignore[arg-type]
    "a plan for a run": lambda: mo.hindsight(mo.plan(mo.example("corridor"), planner="ssi")),  # type: ignore[arg-type]
    "a number for a plan": lambda: mo.plan(mo.example("corridor"), planner="ssi").diff(3),  # type: ignore[arg-type]
    "a study that is none": lambda: mo.study({}, "mine.toml"),
    "a baseline that is none": lambda: mo.against_baseline("none.json", ["corridor"]),
    "a robot that is none": lambda: mo.plan(mo.example("corridor"), planner="greedy").route(99),
    "a table that is none": lambda: mo.plan(mo.example("corridor"), planner="greedy").to_frame("x"),
}


@pytest.mark.parametrize("what", WRONG)
def test_an_error_is_the_packages_own_and_a_line(what: str) -> None:
    with pytest.raises(mo.MsmrtaError) as caught:
        WRONG[what]()
    assert str(caught.value).isprintable()
