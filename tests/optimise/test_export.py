"""Programs as MPS and LP files: what is read in them is what was written, to the last digit."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import csr_array
from support.amounts import examples
from support.programs import INF, problem, program

from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.export import export, read_program, write_program
from msmrta_opt.optimise.formats.written import LONGEST, RESERVED, legal_name
from msmrta_opt.optimise.program import Block, Program
from msmrta_opt.stages.data import stage_data

SUFFIXES = (".mps", ".lp")
LEGAL = re.compile(r"(?!inf|nan)[A-DF-Za-df-z_][A-Za-z0-9_.,()]*")
"""What every reader takes for a name."""

both_formats = pytest.mark.parametrize("suffix", SUFFIXES)


def reread(program: Program, suffix: str) -> Program:
    """`program`, written and read again."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{suffix}"
        write_program(program, path)
        return read_program(path)


def assert_same(found: Program, meant: Program) -> None:
    """Both are the same in everything but names, free rows left out."""
    kept = np.isfinite(meant.row_lower) | np.isfinite(meant.row_upper)
    assert (found.sense, found.offset) == (meant.sense, meant.offset)
    for field in ("cost", "lower", "upper", "integer"):
        assert np.array_equal(getattr(found, field), getattr(meant, field)), field
    for field in ("row_lower", "row_upper"):
        assert np.array_equal(getattr(found, field), getattr(meant, field)[kept]), field
    assert np.array_equal(found.matrix.toarray(), meant.matrix.toarray()[kept])


@st.composite
def programs(draw: st.DrawFn) -> Program:
    """Small programs with all kinds of bounds, rows, variables and numbers."""
    n_columns, n_rows = draw(st.integers(1, 4)), draw(st.integers(0, 4))
    few = st.sampled_from(
        [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, -1.0, -3.0, 1 / 3, -2.5, 1e-7 / 3, 2e14 / 3]
    )
    any_ = st.floats(2e-9, 9e14)
    number = st.one_of(few, few, any_, any_.map(lambda value: -value))

    def vector(size: int, values: st.SearchStrategy[Any]) -> NDArray[Any]:
        return np.array(draw(st.lists(values, min_size=size, max_size=size)))

    some = st.sampled_from([-3.0, -1.0, 0.0, 0.0, 1 / 3, 2.0, 1e19 / 3])
    wider = st.sampled_from([0.0, 0.0, 1.0, 2 / 3, 1e-9])
    low, wide = vector(n_columns, some), vector(n_columns, wider)
    at_least, range_ = vector(n_rows, some), vector(n_rows, wider)
    sides = vector(n_rows, st.sampled_from(["=", "<", ">", "range", "none"]))
    open_ = vector(n_columns, st.sampled_from(["", "", "low", "high", "free"]))
    return Program(
        sense=draw(st.sampled_from(["min", "max"])),
        cost=vector(n_columns, number).astype(float),
        offset=draw(number),
        matrix=csr_array(vector(n_rows * n_columns, number).reshape(n_rows, n_columns)),
        row_lower=np.where(np.isin(sides, ["<", "none"]), -INF, at_least).astype(float),
        row_upper=np.select(
            [sides == "=", np.isin(sides, [">", "none"])], [at_least, INF], at_least + range_
        ).astype(float),
        lower=np.where(np.isin(open_, ["low", "free"]), -INF, low).astype(float),
        upper=np.where(np.isin(open_, ["high", "free"]), INF, low + wide).astype(float),
        integer=vector(n_columns, st.booleans()).astype(bool),
        columns=(Block("x", 0, (n_columns,)),),
        rows=(Block("row {i}", 0, (n_rows,)),),
    )


@both_formats
@settings(max_examples=examples(100))
@given(trial=programs())
def test_what_is_written_is_read_again_to_the_last_digit(suffix: str, trial: Program) -> None:
    again = reread(trial, suffix)
    assert_same(again, trial)
    names = [again.column_name(j) for j in range(again.n_columns)]
    assert names == [f"x({j})" for j in range(trial.n_columns)]
    kept = np.isfinite(trial.row_lower) | np.isfinite(trial.row_upper)
    rows = [again.row_name(i) for i in range(again.n_rows)]
    assert rows == [f"row_{i}" for i in np.flatnonzero(kept)]


@both_formats
def test_a_row_of_which_a_file_has_two_comes_back_as_one_and_no_other(
    suffix: str, tmp_path: Path
) -> None:
    trial = program([[1, 2], [1, 2], [1, 3]], [4, 9, 5], [1, 1], row_lower=[1, -INF, 5])
    names = ["between", "between_up", "between_lo"]
    trial = replace(trial, rows=tuple(Block(name, i, ()) for i, name in enumerate(names)))
    assert_same(reread(trial, suffix), trial)


@both_formats
@pytest.mark.parametrize("sense", ["min", "max"])
def test_a_program_without_rows_or_without_variables_stays_one(suffix: str, sense: Any) -> None:
    rows, nothing = np.zeros((0, 2)), np.zeros((0, 0))
    for trial in (
        program(rows, [], [1, -1], sense=sense, offset=-2.5),
        program(rows, [], [0, 0], sense=sense),
        program(nothing, [], [], sense=sense, offset=1.5),
        program(np.zeros((1, 2)), [-1], [1, 0], sense=sense),
    ):
        assert_same(reread(trial, suffix), trial)


@both_formats
def test_the_constant_of_one_who_uses_its_name_is_a_variable(suffix: str, tmp_path: Path) -> None:
    trial = program([[1, 1]], [1], [1, 2], offset=3)
    for name in ("objective_constant", "no_rows"):
        named = replace(trial, columns=(Block(name, 0, (2,)),), rows=(Block(name, 0, ()),))
        assert_same(reread(named, suffix), trial)


@both_formats
def test_names_are_the_modellers(suffix: str, paper: Instance, tmp_path: Path) -> None:
    path = tmp_path / f"eq1{suffix}"
    export("cluster_one_to_one", stage_data(paper, "cluster"), path)
    again = read_program(path)
    columns = {again.column_name(j) for j in range(again.n_columns)}
    rows = {again.row_name(i) for i in range(again.n_rows)}
    assert columns == {f"x({r},{c})" for r in range(4) for c in range(4)}
    assert rows == {
        *(f"cluster_{c}_has_at_most_one_robot" for c in range(4)),
        *(f"robot_{r}_has_at_most_one_cluster" for r in range(4)),
        "as_many_pairs_as_can_be",
    }
    assert "cluster_one_to_one" in "".join(path.read_text().splitlines()[:2])


def test_a_row_is_written_the_way_it_was_modelled() -> None:
    x = cp.Variable(2, boolean=True, name="x")
    formulation = problem(cp.Minimize(cp.sum(x)), [(cp.sum(x) >= 1).set_label("somebody goes")])
    with TemporaryDirectory() as folder:
        path = Path(folder) / "trial.lp"
        export(formulation, None, path)
        assert " somebody_goes: x(0) + x(1) >= 1\n" in path.read_text()


@pytest.mark.parametrize(
    ("name", "legal"),
    [
        ("x[0,2]", "x(0,2)"),
        ("busiest", "busiest"),
        ("cluster 2 has at most one robot", "cluster_2_has_at_most_one_robot"),
        ("who: a + b -> c?", "who_a_b_c"),
        ("2nd choice", "_2nd_choice"),
        ("each victim", "_each_victim"),
        ("End", "_End"),
        ("free", "_free"),
        ("ψ", "_"),
        ("", "_"),
        ("l" * 300, "l" * 96),
    ],
)
def test_a_name_becomes_one_that_all_readers_take(name: str, legal: str) -> None:
    assert legal_name(name) == legal


words = st.one_of(
    st.sampled_from(sorted(RESERVED)),
    st.sampled_from(["", "x", "X", "x(0)", "x[0]", "x 0", "x_0", "1e5", "e9", "R0", "Obj", "alo"]),
    st.sampled_from(
        ["x" * 200, "x" * 201, "a", "a lo", "alo", "a up", "-", "a:b", "a{b}", "$", "*"]
    ),
    st.text(max_size=8),
)


@both_formats
@settings(max_examples=examples(60))
@given(
    columns=st.lists(words, min_size=3, max_size=3), rows=st.lists(words, min_size=3, max_size=3)
)
@example(columns=["x", "x", "x_2"], rows=["alo", "a", "aup"])
@example(columns=["name", "free", "inf"], rows=["rhs", "obj", "end"])
def test_whatever_the_names_those_in_the_file_are_legal_and_unique(
    suffix: str, columns: list[str], rows: list[str]
) -> None:
    # x + 2 y + 3 z with x + y ≤ 1, 0 ≤ y + z ≤ 1, x - z = 0, all binary: best is x = z = 1, 4.
    trial = program(
        [[1, 1, 0], [0, 1, 1], [1, 0, -1]],
        [1, 1, 0],
        [1, 2, 3],
        row_lower=[-INF, 0, 0],
        sense="max",
    )
    trial = replace(
        trial,
        columns=tuple(Block(name, j, ()) for j, name in enumerate(columns)),
        rows=tuple(Block(name, i, ()) for i, name in enumerate(rows)),
    )
    again = reread(trial, suffix)
    for blocks in (again.columns, again.rows):
        names = [block.name for block in blocks]
        assert len(names) >= 3
        assert len(set(names)) == len(names)
        for name in names:
            assert LEGAL.fullmatch(name)
            assert len(name) <= LONGEST + 3
    assert_same(again, trial)


@both_formats
def test_a_program_without_names_gets_some(suffix: str) -> None:
    again = reread(replace(program([[1, 1]], 1, [1, 2]), columns=(), rows=()), suffix)
    assert {again.column_name(0), again.column_name(1)} == {"x_0", "x_1"}
    assert again.row_name(0) == "row_0"


@both_formats
def test_variables_in_no_row_keep_their_place_and_kind(suffix: str) -> None:
    trial = program([[1, 0, 0, 0]], 1, [1, 0, 2, 0], upper=INF, integer=[False, True, True, False])
    again = reread(trial, suffix)
    kinds = {again.column_name(j): bool(again.integer[j]) for j in range(again.n_columns)}
    assert kinds == {"x(0)": False, "x(1)": True, "x(2)": True, "x(3)": False}
    assert again.n_rows == 1


@both_formats
def test_rows_beyond_what_solvers_keep_are_multiplied_by_a_power_of_two(suffix: str) -> None:
    # At least a second, in nanoseconds; and rates a year. Both are the same rows, in other units.
    trial = program([[1e-9, 0], [1e9, -1e16]], [INF, 0], [1, 1], row_lower=[1, -INF], upper=1e12)
    again = reread(trial, suffix)
    sizes = np.abs(again.matrix.data)
    assert ((sizes > 1e-9) & (sizes < 1e15)).all()
    waiting, rate = again.row_lower[0], again.matrix[1, 0] / 1e9
    assert [np.log2(factor) % 1 for factor in (waiting, rate)] == [0, 0]
    assert again.matrix.toarray().tolist() == [[1e-9 * waiting, 0], [1e9 * rate, -1e16 * rate]]


@both_formats
@pytest.mark.parametrize(
    ("trial", "problem"),
    [
        (
            program([[1e-9, 1e16]], 1, [1, 1]),
            r"row 'row 0': coefficient 1e\+16 of 'x\[1\]' beside 1e-09 of 'x\[0\]'; solvers take none",
        ),
        (
            program([[1, -1e16]], 0, [1, 1]),
            r"row 'row 0': coefficient 1e\+16 of 'x\[1\]' beside 1 of",
        ),
        (
            program([[1e-9, 99]], 0, [1, 1]),
            r"row 'row 0': coefficient 1e-09 of 'x\[0\]' beside 99 of",
        ),
        (program([[1, INF]], 1, [1, 1]), r"row 'row 0': coefficient inf of 'x\[1\]' beside 1 of"),
        (program([[1, np.nan]], 1, [1, 1]), "row 'row 0': coefficient nan"),
        (
            program([[1, 1]], 1e20, [1, 1]),
            r"row 'row 0': its sides -inf and 1e\+20; give numbers be",
        ),
        (program([[1, 1]], -INF, [1, 1]), "row 'row 0': its sides -inf and -inf"),
        (program([[1e-9, 1e-9]], 1e19, [1, 1]), r"row 'row 0': its sides -inf and 1.07374e\+28"),
        (program([[1, 1]], 1, [1, -1e20]), r"variable 'x\[1\]': cost -1e\+20; give numbers below"),
        (program([[1, 1]], 1, [1, np.nan]), r"variable 'x\[1\]': cost nan"),
        (program([[1, 1]], 1, [1, 1], upper=[1e20, 1]), r"variable 'x\[0\]': upper bound 1e\+20"),
        (program([[1, 1]], 1, [1, 1], lower=[0, INF]), r"variable 'x\[1\]': lower bound inf"),
        (program([[1, 1]], 1, [1, 1], offset=INF), r"the objective's constant inf"),
    ],
)
def test_a_number_beyond_what_solvers_take_is_refused_by_row_and_variable(
    suffix: str, trial: Program, problem: str, tmp_path: Path
) -> None:
    path = tmp_path / f"huge{suffix}"
    path.write_text("as it was")
    with pytest.raises(ModelError, match=problem) as caught:
        write_program(trial, path)
    assert str(caught.value).isprintable()
    assert path.read_text() == "as it was"
    assert list(tmp_path.iterdir()) == [path]


def test_an_unknown_suffix_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "program.nl"
    for use in (lambda: write_program(program([[1]], 1, [1]), path), lambda: read_program(path)):
        with pytest.raises(InputError, match=r"'\.nl'; the suffix is one of \.mps, \.lp") as caught:
            use()
        assert caught.value.file == str(path)


def test_an_unknown_suffix_is_refused_before_any_work(tmp_path: Path) -> None:
    def build(data: object) -> cp.Problem:
        raise AssertionError("built")

    formulation = replace(problem(cp.Minimize(0)), build=build)
    with pytest.raises(InputError, match="unknown format"):
        export(formulation, None, tmp_path / "program.txt")


def test_a_folder_that_is_not_there_is_an_error_of_the_users(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_program(program([[1]], 1, [1]), tmp_path / "none" / "program.lp")


def test_a_maximisation_is_a_minimisation_in_an_mps_file_and_says_so(tmp_path: Path) -> None:
    path = tmp_path / "trial.mps"
    write_program(program([[1, 1]], 1, [3, -2], sense="max", offset=1), path)
    lines = path.read_text().splitlines()
    assert lines[0] == "* A maximisation: the costs are negated, minimise them."
    costs = [line.split()[2] for line in lines if re.match(r" {4}\S+ +obj ", line)]
    assert costs == ["-3", "2", "-1"]
    assert "OBJSENSE" not in path.read_text()


def test_a_file_that_is_not_there_is_an_error_of_the_users(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_program(tmp_path / "none.mps")
