"""A formulation's matrix and what it proves, against what its mathematics says."""

from __future__ import annotations

import numpy as np
import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.compile.compiled import program, structure
from msmrta_opt.optimise.data import ClusterData

TWO_BY_THREE = ClusterData(
    np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), np.zeros((2, 3)), np.ones(2, dtype=np.int64)
)


def test_the_program_has_the_variables_and_weights_of_its_mathematics() -> None:
    at_half = program("cluster_printed", TWO_BY_THREE, psi=0.5)
    assert at_half.sense == "max"
    assert at_half.n_columns == 6
    assert sorted(np.abs(at_half.cost)) == [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]


def test_an_assignment_is_recognised_by_its_rows() -> None:
    found = structure("cluster_one_to_one", TWO_BY_THREE)
    assert found is not None
    assert found.kind == "bipartite"


def test_a_row_of_loads_proves_nothing() -> None:
    assert structure("cluster_fair", TWO_BY_THREE) is None


def test_a_parameter_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="psy"):
        structure("cluster_printed", TWO_BY_THREE, psy=0.5)
