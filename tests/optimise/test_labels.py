"""Rows and columns are named by ids: a brace is the axis that its rows run over, whatever the order."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from support.joint_cases import small_mission
from support.small_cases import dense_case

from msmrta_opt.mission.errors import ModelError
from msmrta_opt.optimise.axes import StageData
from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.data import ClusterData, VictimData
from msmrta_opt.optimise.formulation import Spec
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.registry import Formulation, get
from msmrta_opt.optimise.solve import solve
from msmrta_opt.routing.problem import RoutingData

N = 3
ROBOTS, VICTIMS = (20, 10, 30), (104, 7, 55)


def square(**changes: Any) -> VictimData:
    """As many robots as victims, so that lengths tell nothing."""
    data = VictimData(
        success=np.ones((N, N)),
        failure=np.ones((N, N)),
        can_serve=np.ones((N, N), dtype=bool),
        busy=np.zeros(N),
        budget=np.full(N, 2),
        endurance=np.full(N, np.inf),
        ids={"r": ROBOTS, "v": VICTIMS},
    )
    return replace(data, **changes)


def compiled(rows: Any, data: StageData | None = None) -> Program:
    """The program of rows over the variable that the stage ``victim`` reads."""
    data = data or square()

    def build(data: VictimData) -> cp.Problem:
        x = cp.Variable(data.success.shape, boolean=True, name="x")
        return cp.Problem(cp.Minimize(cp.sum(x)), rows(x))

    spec = Spec("victim", "trial")
    return compile_formulation(
        Formulation("trial", Path("trial.py"), spec, "", build), data
    ).program()


def row_names(program: Program) -> list[str]:
    return [program.row_name(i) for i in range(program.n_rows)]


def test_a_variable_of_the_stage_is_named_by_the_ids_of_its_axes() -> None:
    program = compiled(lambda x: [x <= 1])
    assert program.column_name(0) == "x[20,104]"
    assert program.column_name(1) == "x[10,104]"
    assert program.column_name(3) == "x[20,7]"


@pytest.mark.parametrize("axis", [0, 1])
def test_rows_take_the_ids_of_what_they_sum_to(axis: int) -> None:
    label = ("victim {v} is served", "robot {r} is sent")[axis]
    program = compiled(lambda x: [(cp.sum(x, axis=axis) <= 1).set_label(label)])
    ids = (VICTIMS, ROBOTS)[axis]
    assert row_names(program) == [label.replace("{v}", str(i)).replace("{r}", str(i)) for i in ids]


@pytest.mark.parametrize("label", ["{r} to {v}", "{v} by {r}"])
@pytest.mark.parametrize("transposed", [False, True])
def test_the_order_of_the_sentence_is_free_and_so_is_that_of_the_rows(
    label: str, transposed: bool
) -> None:
    program = compiled(lambda x: [((x.T if transposed else x) <= 1).set_label(label)])
    for i, name in enumerate(row_names(program)):
        (column,) = program.matrix[[i]].indices
        robot, victim = program.columns[0].index(int(column))
        assert name == label.replace("{r}", str(robot)).replace("{v}", str(victim))


def test_rows_for_some_victims_are_named_by_these() -> None:
    program = compiled(lambda x: [(cp.sum(x[:, [2, 0]], axis=0) <= 1).set_label("victim {v}")])
    assert row_names(program) == ["victim 55", "victim 104"]


def test_rows_in_another_order_are_named_by_what_they_hold() -> None:
    program = compiled(lambda x: [(cp.sum(x[[1, 2, 0], :], axis=1) <= 1).set_label("robot {r}")])
    assert row_names(program) == ["robot 10", "robot 30", "robot 20"]


def test_rows_without_braces_have_their_ids_behind() -> None:
    program = compiled(lambda x: [(x <= 1).set_label("no pair twice"), cp.sum(x, axis=0) <= 1])
    assert row_names(program)[1] == "no pair twice[10,104]"
    assert row_names(program)[-1] == "constraint 2[55]"


def test_an_axis_that_no_brace_names_follows_behind() -> None:
    program = compiled(lambda x: [(x <= 1).set_label("robot {r}")])
    assert row_names(program)[3] == "robot 20[7]"


def test_an_axis_of_length_one_needs_no_brace() -> None:
    program = compiled(
        lambda x: [(cp.sum(x, axis=1, keepdims=True) <= 1).set_label("robot {r} once")]
    )
    assert row_names(program) == [f"robot {r} once" for r in ROBOTS]


WIDE = square(
    success=np.ones((2, N)),
    failure=np.ones((2, N)),
    can_serve=np.ones((2, N), dtype=bool),
    busy=np.zeros(2),
    budget=np.full(2, 2),
    endurance=np.full(2, np.inf),
    ids={"v": VICTIMS},
)


@pytest.mark.parametrize("data", [square(), WIDE], ids=["square", "not square"])
@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (
            lambda x: [(cp.sum(x, axis=0) <= 1).set_label("robot {r}")],
            r"label 'robot {r}' does not fit its constraint, of shape \(3,\); "
            r"name in braces what that runs over: {v} \(victim\)$",
        ),
        (
            lambda x: [(cp.sum(x, axis=0) <= 1).set_label("victim {v} of {r}")],
            r"name in braces what that runs over: {v} \(victim\)$",
        ),
        (
            lambda x: [(cp.sum(x) <= 1).set_label("victim {v}")],
            r"of shape \(\); name in braces what that runs over: nothing$",
        ),
        (
            lambda x: [(x <= 1).set_label("kind {k} at {v}")],
            r"names {k}; the axes of VictimData are {r} \(robot\), {v} \(victim\), "
            r"{u} \(other victim\)$",
        ),
        (lambda x: [(x <= 1).set_label("robot {} at {v}")], "names {}; the axes of VictimData are"),
    ],
)
def test_a_brace_that_is_no_axis_of_its_rows_is_refused_in_one_line(
    data: VictimData, rows: Any, said: str
) -> None:
    with pytest.raises(ModelError, match=said) as caught:
        compiled(rows, data)
    assert str(caught.value).startswith("trial: ")
    assert "\n" not in str(caught.value)


def test_data_of_another_stage_is_refused_by_name() -> None:
    posts = ClusterData(np.ones((2, 2)), np.ones((2, 2)), np.ones(2, dtype=np.int64))
    with pytest.raises(ModelError, match="for data of stage 'victim', not ClusterData"):
        compile_formulation(get("victim_covering"), posts)


# Variables that the stage does not read are known by the rows that hold them.


def test_other_variables_take_the_axes_of_the_rows_that_hold_them() -> None:
    program = compiled(
        lambda x: [
            cp.Variable(N, name="load") >= cp.sum(x, axis=1),
            cp.Variable(N, name="late") >= cp.sum(x, axis=0),
        ]
    )
    names = {block.name: program.column_name(block.start) for block in program.columns}
    assert names == {"x": "x[20,104]", "load": "load[20]", "late": "late[104]"}


SQUARES = {
    # As many victims as kinds, robots and places could be confused with.
    "routing": small_mission(0, 3, 6),
    "joint": dense_case("joint", 0),
}


@pytest.mark.parametrize("model", ["joint_routing_flow", "joint_routing_mtz"])
def test_requirements_of_the_joint_models_are_named_by_their_own_victim_and_kind(
    model: str,
) -> None:
    """Six victims and six kinds: only what the rows hold tells them apart."""
    data = SQUARES["routing"]
    assert isinstance(data, RoutingData)
    assert data.n_victims == data.n_kinds
    victims, kinds = [11, 22, 33, 44, 55, 66], ["Saw", "Aid", "Air", "Cut", "Dig", "Fire"]
    program = compile_formulation(
        get(model), replace(data, ids={"v": victims, "k": kinds})
    ).program()
    for i in range(program.n_rows):
        if program.row_name(i).startswith("kind "):
            held = program.matrix[[i]].indices
            (pair,) = {program.column_name(int(j)).strip("a[]").split(",", 1)[1] for j in held}
            victim, kind = pair.split(",")
            assert program.row_name(i).startswith(f"kind {kind} at victim {victim} is served")


@pytest.mark.parametrize("model", ["joint_routing_flow", "joint_routing_mtz"])
def test_places_of_the_joint_models_are_victims_and_the_start(model: str) -> None:
    data = replace(SQUARES["routing"], ids={"v": [11, 22, 33, 44, 55, 66]})
    program = compile_formulation(get(model), data).program()
    x = next(block for block in program.columns if block.name == "x")
    assert program.column_name(x.start) == "x[0,11,11]"
    assert program.column_name(x.stop - 1) == "x[2,start,66]"


def test_every_dimension_of_the_shipped_models_has_an_axis() -> None:
    for model, stage in (
        *((name, "victim") for name in ("victim_balanced", "victim_generalized")),
        *((name, "cluster") for name in ("cluster_fair", "cluster_budgeted")),
        ("joint_assignment", "joint"),
        ("clustering_pmedian", "clustering"),
    ):
        for seed in range(3):
            program = compile_formulation(get(model), dense_case(stage, seed)).program()
            for block in (*program.columns, *program.rows):
                assert len(block.letters) == len(block.shape)
                assert all(block.letters), (model, block.name)


# Solutions speak in ids, too.


def test_a_solution_names_its_pairs_by_ids() -> None:
    data = square(success=np.where(np.eye(N), 1.0, 9.0))
    solution = solve("victim_one_to_one", data, beta=0)
    pairs = {f"x[{r},{v}]" for r, v in zip(ROBOTS, VICTIMS, strict=True)}
    assert {name for name, _ in solution.nonzero()} == pairs
    table = solution.to_frame("x")
    assert list(table.columns) == ["robot", "victim", "value"]
    taken = table[table["value"] > 0.5]
    assert list(zip(taken["robot"], taken["victim"], strict=True)) == list(
        zip(ROBOTS, VICTIMS, strict=True)
    )


def test_dual_values_are_a_table_by_the_ids_of_their_rows() -> None:
    solution = solve("victim_one_to_one", square(), beta=0)
    table = solution.to_frame("victim {v} has at most one robot")
    assert list(table.columns) == ["victim", "dual"]
    assert table["victim"].tolist() == list(VICTIMS)
