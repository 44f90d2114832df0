from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.stages.joint_routing import limits_of
from msmrta_opt.stages.options import PRESETS, RoutingOptions, StagedOptions, options_type


def test_the_paper_is_the_default_and_reads_the_text() -> None:
    options = StagedOptions.of()
    assert options == StagedOptions.of("paper") == StagedOptions()
    assert (options.psi, options.cluster_model) == (0.95, "cluster_one_to_one")
    assert options.victim_model == "victim_one_to_one"
    assert (options.weights, options.members) == ("text", "all")
    assert (options.performance, options.award) == ("pair", "sealed")
    assert options.through_centre
    assert options.pinned_clusters


def test_the_authors_follow_their_program_with_the_published_clusters() -> None:
    changed = {
        field.name
        for field in dataclasses.fields(StagedOptions)
        if getattr(StagedOptions.of("authors"), field.name)
        != getattr(StagedOptions.of("paper"), field.name)
    }
    assert changed == {"weights", "members", "performance"}
    authors = StagedOptions.of("authors")
    assert (authors.weights, authors.members) == ("authors", "partial")
    assert authors.performance == "robot"
    assert authors.pinned_clusters


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_an_option_given_goes_before_the_presets(preset: str) -> None:
    options = StagedOptions.of(preset, members="all", performance="robot", psi=0.0, seed=7)
    assert (options.members, options.performance) == ("all", "robot")
    assert (options.psi, options.seed) == (0.0, 7)


def test_options_make_themselves_again_from_their_record() -> None:
    options = StagedOptions.of("authors", psi=0.2, endurance=600.0, budget=3)
    assert StagedOptions(**options.as_dict()) == options


def test_options_cannot_be_changed_in_place() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        StagedOptions().psi = 0.1  # type: ignore[misc]


@pytest.mark.parametrize(
    "option",
    [
        {"psi": 0},
        {"psi": 1},
        {"beta": 0.0},
        {"beta": 1.0},
        {"budget": 1},
        {"endurance": 0},
        {"endurance": None},
        {"seed": 0},
        {"seed": 2**32 - 1},
    ],
)
def test_the_ends_of_a_range_belong_to_it(option: dict[str, Any]) -> None:
    assert StagedOptions.of(**option).as_dict() == StagedOptions().as_dict() | option


@pytest.mark.parametrize(
    ("option", "value", "right"),
    [
        ("psi", 1.01, "a number from 0 to 1"),
        ("psi", -0.01, "a number from 0 to 1"),
        ("psi", float("nan"), "a number from 0 to 1"),
        ("psi", "0.5", "a number from 0 to 1"),
        ("psi", True, "a number from 0 to 1"),
        ("beta", 2, "a number from 0 to 1"),
        ("beta", None, "a number from 0 to 1"),
        ("weights", "paper", "one of text, authors"),
        ("members", "full", "one of all, partial"),
        ("performance", "victim", "one of pair, robot"),
        ("award", "", "one of sealed, sequential"),
        ("award", ["sealed"], "one of sealed, sequential"),
        ("budget", 0, "a whole number, 1 or more"),
        ("budget", 1.5, "a whole number, 1 or more"),
        ("budget", True, "a whole number, 1 or more"),
        ("endurance", -1, "time units, 0 or more"),
        ("endurance", float("nan"), "time units, 0 or more"),
        ("endurance", "long", "time units, 0 or more"),
        ("seed", -1, "a whole number, 0 to 2**32 - 1"),
        ("seed", 2**32, "a whole number, 0 to 2**32 - 1"),
        ("seed", 0.5, "a whole number, 0 to 2**32 - 1"),
        ("seed", True, "a whole number, 0 to 2**32 - 1"),
    ],
)
def test_a_value_out_of_range_is_refused_by_name_with_what_would_be_right(
    option: str, value: object, right: str
) -> None:
    with pytest.raises(InputError) as error:
        StagedOptions(**{option: value})  # type: ignore[arg-type]
    assert error.value.field == option
    assert repr(value) in str(error.value)
    assert right in str(error.value)


@pytest.mark.parametrize("option", ["through_centre", "pinned_clusters", "shared_table"])
@pytest.mark.parametrize("value", ["no", 0, None])
def test_a_switch_is_true_or_false_and_nothing_that_passes_for_it(
    option: str, value: object
) -> None:
    with pytest.raises(InputError) as error:
        StagedOptions(**{option: value})  # type: ignore[arg-type]
    assert error.value.field == option
    assert repr(value) in str(error.value)


def test_an_unknown_option_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match="through_centre") as error:
        StagedOptions.of(phi=0.5)
    assert error.value.field == "phi"


def test_an_unknown_preset_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(
        InputError, match=r"did you mean 'authors'\?\); give one of paper, authors"
    ) as error:
        StagedOptions.of("author")
    assert error.value.field == "preset"


def test_only_the_joint_problem_has_limits_on_whole_routes() -> None:
    assert options_type("cluster") is StagedOptions
    limited = options_type("routing").of(endurance=9, longest_walk=5, return_to_start=True)
    assert isinstance(limited, RoutingOptions)
    assert limits_of(limited) == {"endurance": 9.0, "longest_walk": 5.0, "return_to_start": True}
    assert limits_of(StagedOptions(endurance=9)) == {"endurance": 9.0}
    with pytest.raises(InputError, match="longest_walk: no such option"):
        options_type("victim").of(longest_walk=5)


def test_limits_that_are_not_set_are_not_listed() -> None:
    assert RoutingOptions().as_dict() == StagedOptions().as_dict()
    assert RoutingOptions(longest_walk=3).as_dict()["longest_walk"] == 3


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("longest_walk", -1),
        ("longest_walk", "far"),
        ("longest_walk", math.inf),
        ("return_to_start", 1),
    ],
)
def test_a_limit_out_of_range_is_refused(option: str, value: object) -> None:
    with pytest.raises(InputError, match=option):
        RoutingOptions(**{option: value})  # type: ignore[arg-type]
