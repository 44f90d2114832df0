"""What is numerically dangerous, and that nothing else is called so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from support.programs import INF, program

from msmrta_opt.diagnosis.numerics import Hazard, hazards, hazards_text
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.subject import subject
from msmrta_opt.stages.data import stage_data


def only(found: tuple[Hazard, ...]) -> Hazard:
    (hazard,) = found
    return hazard


def switched(big: float, limit: float | None = None) -> cp.Problem:
    """A load that may be there only if its machine is on."""
    on = cp.Variable(2, boolean=True, name="on")
    load = cp.Variable(2, nonneg=True, bounds=[0, limit], name="load")
    rows = [
        (load <= big * on).set_label("machine {m} has a load only if on"),
        (cp.sum(load) >= 5).set_label("all is done"),
    ]
    return cp.Problem(cp.Minimize(cp.sum(on)), rows)


def test_a_big_m_is_named_with_what_slips_through_it() -> None:
    found = only(hazards(subject(switched(1e9)).described))
    assert (found.kind, found.label) == ("big-M", "machine {m} has a load only if on")
    assert (found.where, found.count) == ("machine 0 has a load only if on", 2)
    assert found.text.startswith(
        "big-M 1e+09 on on[0]: at on[0] = 1e-06, whole to a solver, load[0]"
    )
    assert "may move by 1e+03" in found.text  # 1e9 · 1e-6


def test_where_bounds_say_what_would_do_it_is_said() -> None:
    assert "; 20 would do" in only(hazards(subject(switched(1e9, limit=20)).described)).text


def test_a_big_m_that_is_small_is_none() -> None:
    assert hazards(subject(switched(1e3)).described) == ()


def test_ranges_of_coefficients_and_costs_are_named() -> None:
    trial = program([[1e-3, 1e5], [1, 1]], [1, 1], [1e-2, 1e6], integer=False)
    first, second = hazards(trial)
    assert (first.kind, first.where) == ("range", "row 0")
    assert "from 0.001 to 100000" in first.text
    assert (second.kind, second.label) == ("costs", "objective")


def test_numbers_that_solvers_drop_or_refuse_are_named() -> None:
    trial = program([[1e-10, 1e-10], [1, 1]], [1e-9, 1e16], 1, integer=False)
    assert [(item.kind, item.where) for item in hazards(trial)] == [
        ("dropped", "row 0"),
        ("too large", "row 1"),
    ]


def test_integers_without_bounds_are_named() -> None:
    trial = program([[1, 1, 1]], 3, 1, lower=[0, -INF, 0], upper=[INF, 1, 1e9])
    found = only(hazards(trial))
    assert (found.kind, found.label, found.count) == ("free integer", "x", 3)
    assert hazards(replace(trial, integer=np.zeros(3, bool))) == ()


@pytest.mark.parametrize("stage", ["clustering", "cluster", "victim", "joint"])
def test_in_the_shipped_formulations_nothing_is_dangerous(stage: str, instances_dir: Path) -> None:
    data = stage_data(Instance.read(instances_dir / "corridor.json"), stage)
    for item in registry.listings(stage):
        if item.formulation is not None:
            found = hazards(subject(item.formulation, data).program)
            assert hazards_text(found) == "Numerically, nothing is dangerous.", item.name
