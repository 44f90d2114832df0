"""Stopping criteria: each by itself, composed, and what they leave to those within them."""

from __future__ import annotations

import math

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.routing import stop as module
from msmrta_opt.routing.stop import (
    AnyOf,
    Interruption,
    MaximumIterations,
    MaximumRuntime,
    RelativeGap,
    StoppingCriterion,
    relative_gap,
)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """A clock that goes only when told to."""
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_without_a_criterion_a_search_never_stops() -> None:
    never = StoppingCriterion()
    assert not never.met(gap=0.0, iterations=10**9)
    assert never.seconds_left() == never.maximum_iterations == math.inf


def test_a_runtime_counts_from_when_it_was_made(clock: list[float]) -> None:
    limit = MaximumRuntime(3)
    clock[0] += 2
    assert limit.seconds_left() == 1
    assert not limit.met()
    clock[0] += 2
    assert limit.seconds_left() == 0
    assert limit.met()


def test_iterations_and_gaps_are_asked_for_by_value() -> None:
    assert not MaximumIterations(5).met(iterations=4)
    assert MaximumIterations(5).met(iterations=5)
    assert MaximumIterations(0).met()
    assert not RelativeGap(0.1).met(gap=0.11)
    assert RelativeGap(0.1).met(gap=0.1)


def test_an_interruption_leaves_no_seconds() -> None:
    asked = False
    criterion = Interruption(lambda: asked)
    assert criterion.seconds_left() == math.inf
    asked = True
    assert criterion.seconds_left() == 0
    assert criterion.met()


def test_composed_the_first_that_is_met_decides(clock: list[float]) -> None:
    asked = False
    both = MaximumRuntime(60) | RelativeGap(0.01) | Interruption(lambda: asked)
    assert not both.met(gap=0.5)
    assert both.met(gap=0.005)
    assert both.seconds_left() == 60
    asked = True
    assert both.met(gap=0.5)
    asked = False
    clock[0] += 60
    assert both.met(gap=0.5)
    counted = both | MaximumIterations(7)
    assert counted.maximum_iterations == 7
    assert both.maximum_iterations == math.inf
    assert AnyOf().seconds_left() == math.inf


def test_what_is_within_a_criterion_ends_with_it_or_sooner(clock: list[float]) -> None:
    outer = MaximumRuntime(10)
    inner, longer = outer.within(4), outer.within(40)
    assert (inner.seconds_left(), longer.seconds_left()) == (4, 10)
    clock[0] += 4
    assert inner.met()
    assert not outer.met()
    clock[0] += 6
    assert longer.met()


@pytest.mark.parametrize("criterion", [MaximumRuntime, MaximumIterations, RelativeGap])
@pytest.mark.parametrize("number", [-1, math.nan])
def test_what_is_no_limit_is_refused(criterion: type, number: float) -> None:
    with pytest.raises(InputError, match="give 0 or more"):
        criterion(number)


def test_a_gap_is_the_share_of_the_value_that_is_open() -> None:
    assert relative_gap(10.0, 8.0) == pytest.approx(0.2)
    assert relative_gap(0.0, 0.0) == 0
    assert relative_gap(10.0, 11.0) == 0
    assert relative_gap(10.0, -math.inf) == math.inf
