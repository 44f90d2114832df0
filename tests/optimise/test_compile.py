"""From cvxpy to arrays: what is refused and in what words, and that every row keeps its name."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import assert_solved_right, formulation, problem

from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.optimise.check import violations
from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.compile.canonical import AUXILIARY
from msmrta_opt.optimise.formulation import Parameter
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.registry import Formulation
from msmrta_opt.optimise.solve import solve

SHARE = Parameter(0.0, 1.0, 0.5, "a share")


def binary(shape: int | tuple[int, ...] = 2) -> cp.Variable:
    return cp.Variable(shape, boolean=True, name="x")


def share(**attributes: Any) -> cp.Parameter:
    return cp.Parameter(name="share", **attributes)


def arrays_of(objective: cp.Minimize | cp.Maximize, constraints: list[Any]) -> Program:
    return compile_formulation(problem(objective, constraints), None).program()


# What is refused.


def refused(formulation: Formulation) -> str:
    """What the refusal says: one line that starts with the formulation's name."""
    with pytest.raises(ModelError) as caught:
        compile_formulation(formulation, None).program()
    message = str(caught.value)
    assert message.startswith("trial: ")
    assert "\n" not in message
    return message


def test_a_program_that_is_not_convex_is_refused() -> None:
    x = cp.Variable(2, name="x")
    assert "not convex" in refused(problem(cp.Minimize(cp.sqrt(x[0]))))
    assert "not convex" in refused(problem(cp.Minimize(0), [x[0] * x[1] <= 1]))


@pytest.mark.parametrize("attributes", [{}, {"boolean": True}])
def test_a_quadratic_objective_is_refused(attributes: dict[str, bool]) -> None:
    x = cp.Variable(2, name="x", **attributes)
    message = refused(problem(cp.Minimize(cp.sum_squares(x - 0.3))))
    assert "not a linear integer program" in message


def test_a_cone_that_is_not_linear_is_refused() -> None:
    x = cp.Variable(2, name="x")
    for constraint in (cp.norm(x) <= 1, cp.exp(x[0]) <= 1):
        assert "not a linear integer program" in refused(problem(cp.Minimize(x[1]), [constraint]))


def test_a_parameter_that_the_spec_does_not_declare_is_refused_by_name() -> None:
    undeclared = problem(cp.Minimize(share() * cp.sum(binary())))
    assert "SPEC.parameters lacks share" in refused(undeclared)


def test_a_program_without_variables_is_refused() -> None:
    assert "no variables" in refused(problem(cp.Minimize(cp.Constant(3))))


def test_parameters_that_are_multiplied_are_refused() -> None:
    def build(_: object) -> cp.Problem:
        psi = share(nonneg=True)
        return cp.Problem(cp.Minimize(psi * psi * cp.sum(binary())))

    assert "DPP" in refused(formulation(build, share=SHARE))


@pytest.mark.parametrize(
    "error", [ValueError("first line\nsecond line"), KeyError("x"), ZeroDivisionError()]
)
def test_an_error_while_building_is_told_in_one_line_with_its_type(error: Exception) -> None:
    def build(_: object) -> cp.Problem:
        raise error

    assert f"build(data) failed: {type(error).__name__}" in refused(formulation(build))


@pytest.mark.parametrize("answer", [None, 3, [cp.Variable(name="x") <= 1]])
def test_something_else_than_a_problem_is_refused_by_its_type(answer: object) -> None:
    message = refused(formulation(lambda _: answer))
    assert f"returned {type(answer).__name__}, not a Problem" in message


def test_a_chained_comparison_is_an_error_while_building() -> None:
    def build(_: object) -> cp.Problem:
        x = binary()
        return cp.Problem(cp.Minimize(cp.sum(x)), [0 <= x <= 1])

    assert "build(data) failed" in refused(formulation(build))


def test_a_variable_whose_attribute_changes_its_shape_is_refused_by_name() -> None:
    x = cp.Variable((2, 2), symmetric=True, name="x")
    assert "variable x" in refused(problem(cp.Minimize(cp.sum(x)), [x >= 1]))


@pytest.mark.parametrize(
    "parameter",
    [lambda: cp.Parameter(2, name="share"), lambda: share(nonpos=True)],
    ids=["a vector", "the wrong sign"],
)
def test_a_parameter_that_cannot_hold_the_declared_number_is_refused(
    parameter: Callable[[], cp.Parameter],
) -> None:
    def build(_: object) -> cp.Problem:
        return cp.Problem(cp.Minimize(cp.sum(binary()) + cp.sum(parameter())))

    assert "share" in refused(formulation(build, share=SHARE))


def test_two_parameters_of_one_name_are_refused() -> None:
    """Setting the value by its name would set one of them only."""

    def build(_: object) -> cp.Problem:
        x = binary()
        return cp.Problem(cp.Minimize(share() * x[0] - share() * x[1]))

    assert "share" in refused(formulation(build, share=SHARE))


@pytest.mark.parametrize("number", [np.nan, np.inf])
@pytest.mark.parametrize("where", ["objective", "constant", "coefficient"])
def test_data_that_is_not_finite_is_refused(number: float, where: str) -> None:
    def build(_: object) -> cp.Problem:
        x, wrong = binary(), np.array([number, 1.0])
        if where == "objective":
            return cp.Problem(cp.Minimize(wrong @ x), [cp.sum(x) >= 1])
        if where == "coefficient":
            return cp.Problem(cp.Minimize(cp.sum(x)), [wrong @ x >= 1])
        return cp.Problem(cp.Minimize(cp.sum(x) + number), [cp.sum(x) >= 1])

    assert "finite" in refused(formulation(build))


def test_a_right_hand_side_may_be_infinite_but_not_undefined() -> None:
    x = binary()
    free = arrays_of(cp.Minimize(cp.sum(x)), [x <= np.array([np.inf, 0])])
    assert free.row_upper.tolist() == [np.inf, 0]
    assert "finite" in refused(problem(cp.Minimize(cp.sum(x)), [x <= np.array([np.nan, 0])]))


# What is read.


def test_the_sense_costs_and_constant_are_the_models_own() -> None:
    x = binary(3)
    for objective, sense in ((cp.Maximize, "max"), (cp.Minimize, "min")):
        program = arrays_of(objective(np.array([1, -2, 3]) @ x + 4), [cp.sum(x) <= 1])
        assert program.sense == sense
        assert program.cost.tolist() == [1, -2, 3]
        assert program.offset == 4
        assert program.value(np.array([1.0, 1.0, 0.0])) == 3


def test_rows_are_read_with_their_sides() -> None:
    x = cp.Variable(2, name="x")
    program = arrays_of(
        cp.Minimize(cp.sum(x)), [x[0] - x[1] <= 3, 2 * x[0] >= x[1] - 4, x[0] + x[1] == 5]
    )
    rows = {
        tuple(row): (low, high)
        for row, low, high in zip(
            program.matrix.toarray().tolist(), program.row_lower, program.row_upper, strict=True
        )
    }
    assert rows == {(1, -1): (-np.inf, 3), (-2, 1): (-np.inf, 4), (1, 1): (5, 5)}


def test_bounds_and_kinds_of_variables_are_read() -> None:
    x = binary(2)
    n = cp.Variable(2, integer=True, bounds=[-1, 7], name="n")
    y = cp.Variable(2, nonneg=True, name="y")
    free = cp.Variable(name="free")
    masked = cp.Variable(2, boolean=True, bounds=[0, np.array([False, True])], name="masked")
    taken = cp.Variable(2, boolean=True, bounds=[np.array([0, 1]), 5], name="taken")
    total = sum(cp.sum(variable) for variable in (x, n, y, free, masked, taken))
    program = arrays_of(cp.Minimize(total), [total >= 1])
    lower, upper = program.shaped(program.lower), program.shaped(program.upper)
    integer = program.shaped(program.integer.astype(float))
    assert (lower["x"].tolist(), upper["x"].tolist()) == ([0, 0], [1, 1])
    assert (lower["n"].tolist(), upper["n"].tolist()) == ([-1, -1], [7, 7])
    assert (float(lower["free"]), float(upper["free"])) == (-np.inf, np.inf)
    assert (lower["masked"].tolist(), upper["masked"].tolist()) == ([0, 0], [0, 1])
    assert (lower["taken"].tolist(), upper["taken"].tolist()) == ([0, 1], [1, 1])
    whole = {name for name, kind in integer.items() if np.all(kind == 1)}
    assert whole == {"x", "n", "masked", "taken"}
    assert {name for name, kind in integer.items() if np.all(kind == 0)} == {"y", "free"}
    # Whether as a bound or as a row, y is not negative.
    point = program.flat(upper | {"y": np.ones(2), "free": np.array(1.0)})
    assert violations(program, point) == []
    negative = program.shaped(point) | {"y": np.array([1.0, -1.0])}
    assert violations(program, program.flat(negative)) != []


def test_some_entries_of_a_variable_may_be_binary() -> None:
    x = cp.Variable((2, 2), boolean=[(0, 1), (0, 1)], bounds=[0, 5], name="x")
    program = arrays_of(cp.Maximize(cp.sum(x)), [x <= 0.7])
    assert program.shaped(program.integer.astype(float))["x"].tolist() == [[1, 0], [0, 1]]


def test_a_parameter_takes_its_default_or_the_value_given() -> None:
    def build(_: object) -> cp.Problem:
        psi, x = share(nonneg=True), binary()
        return cp.Problem(cp.Maximize((1 - psi) * x[0] + psi * 4 * x[1]), [cp.sum(x) <= 2 * psi])

    compiled = compile_formulation(formulation(build, share=SHARE), None)
    assert compiled.program(share=0.25).cost.tolist() == [0.75, 1]
    assert compiled.program().cost.tolist() == [0.5, 2]
    assert compiled.program().row_upper.tolist() == [1]
    assert compiled.program(share=1).row_upper.tolist() == [2]


@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan"), "0.5", None, [0.5]])
def test_a_parameter_that_is_no_number_in_its_range_is_an_input_error(value: Any) -> None:
    compiled = compile_formulation(
        formulation(lambda _: cp.Problem(cp.Minimize(share() * binary()[0])), share=SHARE), None
    )
    with pytest.raises(InputError, match=r"^share: .* from 0 to 1"):
        compiled.program(share=value)


def test_an_unknown_parameter_is_named_with_those_there_are() -> None:
    compiled = compile_formulation(
        formulation(lambda _: cp.Problem(cp.Minimize(share() * binary()[0])), share=SHARE), None
    )
    with pytest.raises(InputError, match=r"^psi: .*share"):
        compiled.program(psi=0.5)


# Every row keeps its name, and every value its place.


def labelled(x: cp.Variable) -> list[cp.Constraint]:
    """Rows of all shapes and kinds, those of equations not first; all hold at 1/2 throughout."""
    table = np.arange(6).reshape(2, 3)
    return [
        (x <= 0.5 + table).set_label("most at {r} {c}"),
        (cp.sum(x, axis=0) == 1).set_label("column {c} in all"),
        (x[0, 0] <= 4).set_label("the corner"),
        (x.T >= -table.T).set_label("least at {c} {r}"),
        (cp.sum(x, axis=1, keepdims=True) == 1.5).set_label("row {r} in all, {one}"),
        (cp.sum(x) == 3).set_label("everything"),
        cp.sum(x, axis=1) >= -np.array([1, 2]),
    ]


def only_violation(program: Program, changes: dict[tuple[int, int], float]) -> list[str]:
    x = np.full((2, 3), 0.5)
    for index, value in changes.items():
        x[index] = value
    return violations(program, program.flat({"x": x}), maximum=99)


@pytest.fixture(scope="module")
def rows_of_all_kinds() -> Program:
    x = cp.Variable((2, 3), name="x")
    return arrays_of(cp.Minimize(cp.sum(x)), labelled(x))


def test_the_point_that_the_names_are_tried_at_is_feasible(rows_of_all_kinds: Program) -> None:
    assert only_violation(rows_of_all_kinds, {}) == []


@pytest.mark.parametrize("index", list(itertools.product(range(2), range(3))))
def test_a_row_that_is_missed_is_named_by_its_label_and_index(
    rows_of_all_kinds: Program, index: tuple[int, int]
) -> None:
    r, c = index
    found = only_violation(rows_of_all_kinds, {index: 9.0})
    names = {text.split("'")[1] for text in found}
    expected = {f"most at {r} {c}", f"column {c} in all", f"row {r} in all, 0", "everything"}
    assert names == expected | ({"the corner"} if index == (0, 0) else set())
    found = only_violation(rows_of_all_kinds, {index: -9.0})
    names = {text.split("'")[1] for text in found}
    expected = {f"least at {c} {r}", f"column {c} in all", f"row {r} in all, 0", "everything"}
    assert names == expected | {f"constraint 7[{r}]"}


def test_constraints_without_a_label_are_numbered_as_the_file_has_them() -> None:
    """cvxpy moves equations to the front; the modeller's first row is still number 1."""
    x = cp.Variable(name="x")
    program = arrays_of(cp.Minimize(x), [x <= 3, x == 2, x >= 1])
    names = {text.split("'")[1] for text in violations(program, np.array([0.5]), maximum=9)}
    assert names == {"constraint 2", "constraint 3"}


def test_values_come_back_in_the_variables_own_shape() -> None:
    worth = np.array([[1, -2, 3], [-4, 5, -6]])
    x = binary((2, 3))
    solution = solve(problem(cp.Maximize(cp.sum(cp.multiply(worth, x))), [x <= 1]), None)
    assert solution.values["x"].tolist() == [[1, 0, 1], [0, 1, 0]]


# Rows and columns that cvxpy adds.

WHOLE = [np.array(point, float) for point in itertools.product(range(3), repeat=3)]


def enumerated(
    sense: Callable[..., float],
    worth: Callable[[np.ndarray], float],
    feasible: Callable[[np.ndarray], bool],
) -> float | None:
    values = [worth(x) for x in WHOLE if feasible(x)]
    return sense(values) if values else None


@given(
    weights=st.lists(st.integers(-3, 3), min_size=3, max_size=3),
    centre=st.lists(st.integers(0, 2), min_size=3, max_size=3),
    limit=st.integers(0, 4),
)
@settings(max_examples=examples(25))
def test_maxima_and_absolute_values_are_solved_right(
    weights: list[int], centre: list[int], limit: int
) -> None:
    w, m = np.array(weights), np.array(centre)
    x = cp.Variable(3, integer=True, bounds=[0, 2], name="x")
    within = [
        (cp.sum(cp.abs(x - m)) <= limit).set_label("near the centre"),
        (cp.max(x) + cp.pos(x[0] - x[1]) <= 2).set_label("not too high"),
        (cp.sum(x) >= 1).set_label("not nothing"),
    ]

    def feasible(point: np.ndarray) -> bool:
        near = np.abs(point - m).sum() <= limit
        return bool(near and point.max() + max(point[0] - point[1], 0) <= 2 and point.sum() >= 1)

    linear = problem(cp.Maximize(w @ x + 1), within)
    assert_solved_right(
        solve(linear, None), enumerated(max, lambda point: float(w @ point + 1), feasible)
    )
    busiest = problem(cp.Minimize(cp.max(cp.multiply(w, x)) + cp.norm1(x - m)), within)

    def load(point: np.ndarray) -> float:
        return float((w * point).max() + np.abs(point - m).sum())

    assert_solved_right(solve(busiest, None), enumerated(min, load, feasible))


@pytest.mark.parametrize(
    ("atom", "best"),
    # Of x1 + x2 ≥ 2: two at 1 each, or one at 2.
    [
        (lambda x: cp.sum_largest(x, 2), 2),
        (lambda x: cp.sum_largest(cp.sum(x), 1), 2),
        (lambda x: cp.max(cp.abs(x)), 1),
        (lambda x: cp.sum(cp.maximum(x, 0.5)), 2),
    ],
)
def test_values_that_variables_have_already_change_nothing(
    atom: Callable[[cp.Variable], cp.Expression], best: float
) -> None:
    x = cp.Variable(2, integer=True, name="x")
    x.value = np.array([3.0, 1.0])
    given = cp.Problem(cp.Minimize(atom(x)), [cp.sum(x) >= 2, x >= 0])
    assert solve(given).objective == pytest.approx(best)
    assert x.value.tolist() == [3, 1]


def test_added_columns_are_called_auxiliary_and_the_models_own_keep_their_names() -> None:
    x = binary(3)
    two = cp.max(cp.multiply([3, 2, 5], x)) + cp.max(cp.multiply([2, 3, 1], x))
    program = arrays_of(cp.Minimize(two), [cp.sum(x) >= 2])
    for blocks in (program.columns, program.rows):
        names = [block.name for block in blocks]
        assert {AUXILIARY, f"{AUXILIARY}_2"} <= set(names)
        assert len(set(names)) == len(names)
    own = [block for block in program.columns if not block.name.startswith(AUXILIARY)]
    assert [block.name for block in own] == ["x"]
    assert program.columns[0].start == 0
    assert sum(block.size for block in program.columns) == program.n_columns
    assert sum(block.size for block in program.rows) == program.n_rows
