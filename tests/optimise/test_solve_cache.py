"""What is canonicalised once is used again: with the same data, and with nothing else."""

from __future__ import annotations

import gc
import weakref

import cvxpy as cp
import numpy as np
import pytest
from support.programs import formulation

from msmrta_opt.optimise.data import ClusterData
from msmrta_opt.optimise.formulation import Parameter
from msmrta_opt.optimise.solve import solve


def cluster_data(best: float = 4.0) -> ClusterData:
    return ClusterData(np.array([[best, 1.0], [2.0, 2.0]]), np.zeros((2, 2)), np.full(2, 2))


class Builds:
    """A formulation that counts how often it is built, and remembers its problems weakly."""

    def __init__(self) -> None:
        self.count = 0
        self.problems: list[weakref.ref[cp.Problem]] = []
        self.formulation = formulation(self.build, psi=Parameter(0, 1, 0.5, "share"))

    def build(self, data: ClusterData) -> cp.Problem:
        self.count += 1
        psi = cp.Parameter(nonneg=True, name="psi")
        x = cp.Variable(data.w.shape, boolean=True, name="x")
        worth = cp.sum(cp.multiply(data.w, x))
        built = cp.Problem(cp.Maximize(psi * worth), [cp.sum(x, axis=0) <= 1])
        self.problems.append(weakref.ref(built))
        return built


def test_the_same_data_is_built_once_for_all_parameters_and_solvers() -> None:
    builds, data = Builds(), cluster_data()
    worth = [
        solve(builds.formulation, data, psi=psi, solver=solver).objective
        for psi in (0.25, 0.5, 1)
        for solver in ("auto", "highs")
    ]
    assert worth == pytest.approx([1.5, 1.5, 3, 3, 6, 6])
    assert builds.count == 1


def test_other_data_is_built_anew_even_if_it_is_equal() -> None:
    builds = Builds()
    kept = [cluster_data(), cluster_data(), cluster_data(best=9)]
    assert [solve(builds.formulation, data, psi=1).objective for data in kept] == [6, 6, 11]
    assert builds.count == 3


def test_what_was_built_goes_with_its_data() -> None:
    builds, data = Builds(), cluster_data()
    solve(builds.formulation, data)
    gc.collect()
    assert builds.problems[0]() is not None
    del data
    gc.collect()
    assert builds.problems[0]() is None


def test_data_that_cannot_be_kept_is_built_each_time() -> None:
    x = cp.Variable(boolean=True, name="x")
    built: list[object] = []

    def build(data: dict[str, float]) -> cp.Problem:
        built.append(data)
        return cp.Problem(cp.Maximize(data["worth"] * x))

    data = {"worth": 1.0}
    assert solve(formulation(build), data).objective == 1
    data["worth"] = 2.0
    assert solve(formulation(build), data).objective == 2
    assert len(built) == 2


@pytest.mark.parametrize("name", ["w", "w_full", "budget"])
def test_data_cannot_be_changed_behind_the_cache(name: str) -> None:
    data = cluster_data()
    solve("cluster_budgeted", data)
    with pytest.raises(ValueError, match="read-only"):
        getattr(data, name)[0] = 0


def test_the_arrays_that_data_was_made_of_can_still_be_changed_and_change_nothing() -> None:
    w = np.array([[4.0, 1.0], [2.0, 2.0]])
    data = ClusterData(w, np.zeros((2, 2)), np.full(2, 2))
    w[0, 0] = 9
    assert solve("cluster_one_to_one", data, psi=0).objective == 6
