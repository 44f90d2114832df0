"""A smallest generated mission that tells two formulations apart."""

from __future__ import annotations

from itertools import islice

import pytest
from support.programs import feasible_points

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.registry import get
from msmrta_opt.optimise.subject import subject
from msmrta_opt.stages.data import stage_data
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.studies.analysis.witness import sizes, witness


def test_sizes_go_from_the_smallest_on() -> None:
    assert list(islice(sizes(), 6)) == [(1, 1), (1, 2), (2, 1), (1, 3), (2, 2), (3, 1)]


def test_on_a_witness_the_optima_are_not_the_same_points() -> None:
    options = StagedOptions.of(budget=2)
    a, b = get("cluster_one_to_one"), get("cluster_budgeted")
    found = witness(a, b, tries=40, options=options)
    assert found.mission is not None
    data = stage_data(found.mission, "cluster", options)
    best: list[set[tuple[float, ...]]] = []
    for model in (a, b):
        program = subject(model, data).program
        points = feasible_points(program)
        values = points @ program.cost
        best.append({tuple(x) for x in points[values >= values.max() - 1e-9].tolist()})
    assert best[0] != best[1]
    assert found.text.startswith(f"A witness, the {found.tried}. mission tried: ")
    assert found.mission.n_robots + found.mission.n_victims <= 6


def test_a_formulation_has_no_witness_against_itself() -> None:
    model = get("cluster_one_to_one")
    found = witness(model, model, tries=6)
    assert (found.mission, found.tried + found.failed) == (None, 6)
    assert found.text.startswith("No witness: the optima agree on ")


def test_formulations_of_two_stages_are_refused() -> None:
    with pytest.raises(InputError, match="give two of one"):
        witness(get("cluster_fair"), get("victim_covering"))
    with pytest.raises(InputError, match="tries: 0; give 1 or more"):
        witness(get("cluster_fair"), get("cluster_fair"), tries=0)
    with pytest.raises(InputError, match="sti: neither has such a parameter"):
        witness(get("cluster_fair"), get("cluster_fair"), sti=0.5)
