"""Every formulation against every possible answer, and against the contract of the folder."""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.brute import ORACLES
from support.joint_cases import on_a_line
from support.oracles import assert_agrees
from support.small_cases import along_a_corridor

from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.compile import compiled as compile_module
from msmrta_opt.optimise.compile.canonical import Canonical
from msmrta_opt.optimise.compile.compiled import canonicalise
from msmrta_opt.optimise.data import ClusterData, VictimData
from msmrta_opt.optimise.formulation import Spec
from msmrta_opt.optimise.registry import get, listings
from msmrta_opt.optimise.solve import solve
from msmrta_opt.stages.cluster_assignment import cluster_data
from msmrta_opt.stages.clustering import clustering
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.requirement_analysis import requirement_analysis
from msmrta_opt.stages.situation import Situation

MODELS = Path(__file__).parents[2] / "models"
NAMES = sorted(item.name for item in listings())
"""Every formulation that the registry finds, in ``models/`` and in folders of one's own."""

shares = st.one_of(st.sampled_from([0.0, 0.25, 0.5, 0.95, 1.0]), st.floats(0, 1, width=32))
shapes = st.tuples(st.integers(1, 3), st.integers(1, 4))


def arrays(shape: tuple[int, ...], elements: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    size = int(np.prod(shape))
    return st.lists(elements, min_size=size, max_size=size).map(
        lambda values: np.array(values).reshape(shape)
    )


@st.composite
def cluster_cases(draw: st.DrawFn) -> ClusterData:
    """Counts, as in the paper, so that ties and zeros are common."""
    shape = draw(shapes)
    counts = arrays(shape, st.integers(0, 4).map(float))
    budget = draw(arrays(shape[:1], st.integers(0, 3)))
    return ClusterData(draw(counts), draw(counts), budget)


@st.composite
def victim_cases(draw: st.DrawFn) -> VictimData:
    """Times in quarters; robots and victims without partners are common."""
    shape = draw(shapes)
    quarters = st.integers(0, 40).map(lambda number: number / 4)
    can_serve = draw(arrays(shape, st.booleans()))
    return VictimData(
        success=draw(arrays(shape, quarters)) * can_serve,
        failure=draw(arrays(shape, quarters)) * can_serve,
        can_serve=can_serve,
        busy=draw(arrays(shape[:1], quarters)),
        budget=np.full(shape[0], 2),
        endurance=np.full(shape[0], np.inf),
    )


NOBODY = VictimData(
    success=np.zeros((2, 3)),
    failure=np.zeros((2, 3)),
    can_serve=np.zeros((2, 3), dtype=bool),
    busy=np.array([3.0, 5.0]),
    budget=np.full(2, 2),
    endurance=np.full(2, np.inf),
)


CLUSTER_NAMES = [name for name in ORACLES if name.startswith("cluster")]
VICTIM_NAMES = [name for name in ORACLES if name.startswith("victim")]


@pytest.mark.parametrize("name", CLUSTER_NAMES)
@given(data=cluster_cases(), psi=shares)
@settings(max_examples=examples(30))
def test_eq_1_is_worth_what_the_best_of_all_tables_is_worth(
    name: str, data: ClusterData, psi: float
) -> None:
    assert_agrees(name, data, psi=psi)


@pytest.mark.parametrize("name", VICTIM_NAMES)
@given(data=victim_cases(), beta=shares)
@example(data=NOBODY, beta=0.5)
@settings(max_examples=examples(30))
def test_eq_2_costs_what_the_cheapest_of_all_tables_costs(
    name: str, data: VictimData, beta: float
) -> None:
    assert_agrees(name, data, beta=beta)


@given(data=victim_cases(), beta=shares)
@settings(max_examples=examples(20))
def test_eq_2_as_printed_assigns_nobody_at_no_cost(data: VictimData, beta: float) -> None:
    solution = solve("victim_printed", data, beta=beta)
    assert solution.objective == 0
    worthless = (1 - beta) * data.success + beta * data.failure == 0
    assert not solution.values["x"][~worthless].any()


# Counted by hand in Tables 1 and 2: robots by clusters C0 to C3.
PAPER_MET = np.array([[4, 1, 1, 1], [5, 1, 2, 3], [3, 0, 1, 1], [3, 1, 0, 3]], float)
PAPER_FULL = np.array([[2, 0, 0, 0], [2, 0, 2, 2], [0, 0, 0, 0], [0, 0, 0, 2]], float)
BUDGET = np.full(4, 2)


@pytest.fixture(scope="module")
def paper_data(paper: Instance) -> dict[str, ClusterData]:
    """Eq. 1 on the paper's mission at its published clusters, by the reading of its weights."""
    situation = Situation.of(paper)
    analysis = requirement_analysis(paper.P, paper.Q)
    readings = {"text": StagedOptions(), "authors": StagedOptions(weights="authors")}
    clusters = clustering(situation, StagedOptions())
    return {
        reading: cluster_data(situation, analysis, clusters, options)
        for reading, options in readings.items()
    }


def test_the_papers_weights_are_those_counted_in_its_tables(
    paper_data: dict[str, ClusterData],
) -> None:
    np.testing.assert_array_equal(paper_data["text"].w, PAPER_MET)
    np.testing.assert_array_equal(paper_data["text"].w_full, PAPER_FULL)
    np.testing.assert_array_equal(paper_data["authors"].w, PAPER_MET - PAPER_FULL)
    np.testing.assert_array_equal(paper_data["authors"].w_full, PAPER_FULL)


@pytest.mark.parametrize("structure", [True, False])
@pytest.mark.parametrize(
    ("name", "weights", "worth"),
    [
        ("cluster_one_to_one", "text", {0: 10, 0.5: 7.5, 0.95: 6.15, 1: 6}),
        ("cluster_printed", "text", {0: 11, 0.5: 8.5, 0.95: 6.25, 1: 6}),
        ("cluster_one_to_one", "authors", {0: 6, 0.5: 5, 0.95: 5.85, 1: 6}),
    ],
)
def test_eq_1_on_the_papers_mission_is_worth_what_a_person_finds(
    name: str, weights: str, worth: dict[float, float], structure: bool
) -> None:
    partial = PAPER_MET if weights == "text" else PAPER_MET - PAPER_FULL
    data = ClusterData(partial, PAPER_FULL, BUDGET)
    for psi, best in worth.items():
        solution = solve(name, data, psi=psi, structure=structure)
        assert solution.objective == pytest.approx(best, abs=1e-9)
        assert solution.bound == pytest.approx(best, abs=1e-9)


def test_a_balanced_robot_is_busy_before_it_takes_anything() -> None:
    """Robot 0 is busy until 10; robot 1 takes both victims and is done at 2 + (5 − 2) + (6 − 2)."""
    data = VictimData(
        success=np.array([[11.0, 11.0], [5.0, 6.0]]),
        failure=np.zeros((2, 2)),
        can_serve=np.ones((2, 2), dtype=bool),
        busy=np.array([10.0, 2.0]),
        budget=np.full(2, 2),
        endurance=np.full(2, np.inf),
    )
    solution = solve("victim_balanced", data, beta=0)
    assert solution.objective == pytest.approx(10)
    assert solution.values["x"][1].tolist() == [1, 1]


@pytest.mark.parametrize(
    ("name", "n_variables", "n_rows"),
    [
        # N = 3 robots, K = 4 clusters or M = 4 victims, each of them coverable.
        ("cluster_printed", 12, 4),
        ("cluster_one_to_one", 12, 8),
        ("cluster_budgeted", 12, 7),
        ("victim_printed", 12, 4),
        ("victim_one_to_one", 12, 8),
        ("victim_covering", 12, 4),
        ("victim_balanced", 13, 7),
    ],
)
def test_a_program_has_the_size_that_its_docstring_states(
    name: str, n_variables: int, n_rows: int
) -> None:
    solution = solve(name, EXAMPLES[get(name).spec.stage])
    assert (solution.n_variables, solution.n_rows) == (n_variables, n_rows)


# What follows holds for every file of the folder, those of tomorrow included.

EXAMPLES: dict[str, Any] = {
    "cluster": ClusterData(np.ones((3, 4)), np.ones((3, 4)), np.full(3, 2)),
    "victim": VictimData(
        success=np.ones((3, 4)),
        failure=np.ones((3, 4)),
        can_serve=np.ones((3, 4), dtype=bool),
        busy=np.zeros(3),
        budget=np.full(3, 2),
        endurance=np.full(3, np.inf),
    ),
    "routing": on_a_line([0, 9], [2, 4, 5], [[[True]] * 3] * 2, service=1),
}
for stage in ("cluster", "victim"):  # whatever a formulation asks of its mission
    EXAMPLES[stage] = replace(EXAMPLES[stage], around=along_a_corridor())
"""Data of each stage on which a formulation can be built."""
STAGED = [
    listing.name
    for listing in listings()
    if listing.path.parent == MODELS
    and listing.formulation is not None
    and listing.formulation.spec.stage in EXAMPLES
]
PAIRING = [name for name in STAGED if get(name).spec.stage in ("cluster", "victim")]
"""Those whose answer is a table of pairs."""


def built(name: str) -> cp.Problem:
    formulation = get(name)
    return formulation.build(EXAMPLES[formulation.spec.stage])


def test_every_oracle_has_its_formulation() -> None:
    assert set(ORACLES) <= set(STAGED)


@pytest.mark.parametrize("name", NAMES)
def test_a_docstring_states_the_program_in_mathematics(name: str) -> None:
    mathematics = get(name).mathematics
    headings = set(re.findall(r"^(\w+)  ", mathematics, flags=re.MULTILINE))
    assert {"Sets", "Data", "Variables", "Size", "Source"} <= headings
    assert re.search(r"^    (max|min) ", mathematics, flags=re.MULTILINE)
    assert re.search(r"^    s\.t\. ", mathematics, flags=re.MULTILINE)


@pytest.mark.parametrize("name", NAMES)
def test_a_file_has_a_spec_with_a_title_and_sensible_parameters(name: str) -> None:
    spec = get(name).spec
    assert isinstance(spec, Spec)
    assert spec.title
    for parameter in spec.parameters.values():
        assert parameter.low <= parameter.default <= parameter.high
        assert parameter.meaning


@pytest.mark.parametrize("name", NAMES)
def test_a_file_imports_of_this_package_the_contract_alone(name: str) -> None:
    tree = ast.parse(get(name).path.read_text(encoding="utf-8"))
    modules = {
        module
        for node in ast.walk(tree)
        for module in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [f"{'.' * node.level}{node.module or ''}"]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    ours = {module for module in modules if module.startswith(("msmrta_opt", "."))}
    contract = "msmrta_opt.optimise.formulation"
    assert ours <= {contract, "msmrta_opt.routing.problem"}


@pytest.mark.parametrize("name", STAGED)
def test_every_constraint_is_labelled_with_a_place_for_each_of_its_axes(name: str) -> None:
    for constraint in built(name).constraints:
        assert constraint.label
        places = re.findall(r"\{\w+\}", constraint.label)
        assert len(places) == len(constraint.shape), constraint.label


@pytest.mark.parametrize("name", STAGED)
def test_the_parameters_are_those_that_the_spec_declares(name: str) -> None:
    assert set(built(name).param_dict) == set(get(name).spec.parameters)


@pytest.mark.parametrize("name", PAIRING)
def test_the_variable_x_is_binary_with_an_entry_for_each_pair(name: str) -> None:
    x = built(name).var_dict["x"]
    assert x.shape == (3, 4)
    assert x.attributes["boolean"]


@pytest.mark.parametrize("name", STAGED)
def test_parameters_are_used_in_dpp_form(name: str) -> None:
    assert built(name).is_dpp()


@pytest.mark.parametrize("name", STAGED)
def test_a_new_parameter_value_is_solved_without_building_or_canonicalising_again(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    formulation = get(name)
    calls = []

    def counted_build(data: Any) -> cp.Problem:
        calls.append("build")
        return formulation.build(data)

    def counted_canonicalise(*arguments: Any) -> Canonical:
        calls.append("canonicalise")
        return canonicalise(*arguments)

    monkeypatch.setattr(compile_module, "canonicalise", counted_canonicalise)
    counted = type(formulation)(
        name, formulation.path, formulation.spec, formulation.mathematics, counted_build
    )
    for parameter, item in formulation.spec.parameters.items():
        for value in (item.low, item.high):
            asked: dict[str, Any] = {parameter: value}
            solve(counted, EXAMPLES[formulation.spec.stage], **asked)
    assert calls == ["build", "canonicalise"]
