"""What is unbounded is told by the variables along which it is."""

from __future__ import annotations

import pytest
from support.programs import INF, program

from msmrta_opt.optimise.ray import unbounded_along


@pytest.mark.parametrize("worth", [1e-9, 1.0, 1e7, 1e12])
def test_the_variables_of_a_ray_are_named_whatever_the_unit_of_the_costs(worth: float) -> None:
    """Of x ≤ y and z ≤ 1, x and y can grow together without end; x alone is worth something."""
    trial = program(
        [[1, -1, 0], [0, 0, 1]], [0, 1], [worth, 0, worth], upper=INF, integer=False, sense="max"
    )
    assert unbounded_along(trial).startswith(
        "the objective improves without end by more x[0], more x[1]; "
    )


def test_what_is_bounded_has_no_ray() -> None:
    assert unbounded_along(program([[1, 1]], [4], [1, 1], upper=INF, sense="max")) == ""
