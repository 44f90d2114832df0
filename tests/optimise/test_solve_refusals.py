"""What is asked of `solve` wrongly is refused in words that name it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from optimise.test_solve import cluster_data

from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.optimise.solve import solve


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (
            {"solver": "hihgs"},
            r"solver: no solver 'hihgs' \(did you mean 'highs'\?\); there are auto, ",
        ),
        ({"phi": 0.5}, r"phi: .* no such parameter \(did you mean 'psi'\?\); it has psi"),
        ({"psi": 1.5}, "psi: 1.5; give a number from 0 to 1"),
        ({"psi": -0.01}, "psi: "),
        ({"psi": float("nan")}, "psi: nan"),
        ({"psi": "0.5"}, "psi: "),
        ({"time_limit": -1}, "time_limit: -1"),
        ({"time_limit": float("nan")}, "time_limit: nan"),
        ({"gap": -0.1}, "gap: -0.1"),
        ({"threads": 0}, "threads: 0"),
        ({"threads": 1.5}, "threads: 1.5; give a whole number"),
        ({"seed": 0.5}, "seed: 0.5; give a whole number"),
        ({"seed": -1}, "seed: -1"),
        ({"seed": 2**31}, "seed: "),
        ({"start": {"y": np.zeros((2, 2))}}, "start: no variable 'y'; there are x"),
        ({"start": {"x": np.zeros(4)}}, r"start\.x: shape \(4,\) where x has \(2, 2\)"),
    ],
)
def test_what_is_asked_for_wrongly_is_an_input_error_that_names_it(
    asked: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        solve("cluster_one_to_one", cluster_data(), **asked)


def test_an_unknown_formulation_is_refused_with_the_known_ones() -> None:
    with pytest.raises(
        InputError, match=r"^model: no formulation 'cluster_two' .*there are .*cluster_printed"
    ):
        solve("cluster_two", cluster_data())


def test_data_of_another_stage_is_a_model_error_that_names_the_formulation() -> None:
    zeros = np.zeros((1, 1))
    victims = VictimData(zeros, zeros, zeros == 0, np.zeros(1), np.ones(1, int), np.ones(1))
    with pytest.raises(ModelError, match=r"^cluster_printed: "):
        solve("cluster_printed", victims)
