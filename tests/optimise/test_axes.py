"""A stage's data declares its axes: shapes follow from them, and so do ids."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.small_cases import dense_case

from msmrta_opt.optimise.data import ClusterData, JointAssignmentData, VictimData

POSTS = ClusterData(np.ones((2, 3)), np.zeros((2, 3)), np.ones(2, dtype=np.int64))


def test_data_made_by_hand_has_positions_for_ids() -> None:
    assert POSTS.ids == {"r": (0, 1), "c": (0, 1, 2)}


def test_ids_that_are_given_are_kept_and_the_others_are_positions() -> None:
    data = replace(POSTS, ids={"r": [7, 3]})
    assert data.along("r") == (7, 3)
    assert data.along("c") == (0, 1, 2)


def test_an_axis_with_a_place_more_has_a_name_for_it() -> None:
    joint = dense_case("joint", 0)
    assert isinstance(joint, JointAssignmentData)
    named = replace(joint, ids={"r": [5, 6, 8]})
    assert named.along("h") == (5, 6, 8, "nobody")
    assert named.along("p") == (0, 1, 2, "none")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"w_full": np.ones((3, 2))}, r"w_full has shape \(3, 2\); give \(2, 3\)"),
        ({"budget": np.ones(3, dtype=np.int64)}, r"budget has shape \(3,\); give \(2,\)"),
        ({"budget": np.ones((2, 1), dtype=np.int64)}, r"budget has shape \(2, 1\); give axes r"),
        ({"w": np.full((2, 3), np.inf)}, "w holds values that are not finite"),
        ({"w": np.full((2, 3), np.nan)}, "w holds values that are not finite"),
        ({"ids": {"v": [1]}}, "ids of v; there are axes c, r"),
        ({"ids": {"r": [1]}}, r"ids of r: \(1,\); give 2 different ones"),
        ({"ids": {"r": [1, 1]}}, r"ids of r: \(1, 1\); give 2 different ones"),
    ],
)
def test_what_does_not_fit_the_axes_is_refused_by_its_field(
    changes: dict[str, Any], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        replace(POSTS, **changes)


def test_where_no_limit_has_a_meaning_a_value_may_be_infinite_but_not_undefined() -> None:
    data = dense_case("victim", 0)
    assert isinstance(data, VictimData)
    assert np.isinf(replace(data, endurance=np.full(3, np.inf)).endurance).all()


def test_what_models_share_is_a_property_of_the_data() -> None:
    """Robot 0 is busy until 2, serves victims 0 and 1 in 3 and 5 more; victim 2 nobody can serve."""
    data = VictimData(
        success=np.array([[5.0, 7, 0], [4, 0, 0]]),
        failure=np.zeros((2, 3)),
        can_serve=np.array([[True, True, False], [True, False, False]]),
        busy=np.array([2.0, 1]),
        budget=np.array([2, 2]),
        endurance=np.array([np.inf, 3]),
    )
    assert data.coverable.tolist() == [1, 1, 0]
    assert data.extra.tolist() == [[3, 5, 0], [3, 0, 0]]
    assert data.time_left.tolist() == [8, 2]
    assert data.matching_size == 2
