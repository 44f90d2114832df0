"""Programs as MPS and LP files: what other solvers read in them is what was meant."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cvxpy as cp
import highspy
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import csr_array
from support.programs import INF, best_value, problem, program

from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.export import (
    LONGEST,
    RESERVED,
    export,
    legal_name,
    read_program,
    write_program,
)
from msmrta_opt.optimise.program import Block, Program, Sense
from msmrta_opt.optimise.solve import solve, solve_program
from msmrta_opt.stages.data import stage_data

SUFFIXES = (".mps", ".lp")
LEGAL = re.compile(r"[A-DF-Za-df-z_(),][A-Za-z0-9_.,()]*")
"""What every reader takes for a name: IBM's rules for LP files, which are the narrowest."""

both_formats = pytest.mark.parametrize("suffix", SUFFIXES)


def read_by_highs(path: Path) -> float | None:
    """The optimum that HiGHS finds in a file, ``None`` if there is no feasible point."""
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("mip_rel_gap", 0.0)
    assert highs.readModel(str(path)) != highspy.HighsStatus.kError, path.read_text()
    highs.run()
    if highs.getModelStatus() == highspy.HighsModelStatus.kInfeasible:
        return None
    assert highs.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return float(highs.getObjectiveValue())


def read_by_scip(path: Path) -> float | None:
    """The optimum that SCIP finds in a file, ``None`` if there is no feasible point."""
    scip = pytest.importorskip("pyscipopt").Model()
    scip.hideOutput()
    scip.readProblem(str(path))
    scip.optimize()
    if scip.getStatus() == "infeasible":
        return None
    assert scip.getStatus() == "optimal"
    return float(scip.getObjVal())


readers = pytest.mark.parametrize("read", [read_by_highs, read_by_scip])
Reader = Callable[[Path], float | None]


def reread(program: Program, suffix: str) -> Program:
    """`program`, written and read again."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{suffix}"
        write_program(program, path)
        return read_program(path)


def coefficients(program: Program, row: int) -> dict[str, float]:
    """The terms of a row, by variable."""
    line = program.matrix[[row]].tocoo()
    return {
        program.column_name(int(j)): float(value)
        for j, value in zip(line.col, line.data, strict=True)
        if value
    }


@st.composite
def programs(draw: st.DrawFn, *, finite: bool = False, most: int = 4) -> Program:
    """Small programs with all kinds of bounds, rows and variables; `finite`: pure integer ones."""
    n_columns, n_rows = draw(st.integers(1, most)), draw(st.integers(0, most))
    number = st.sampled_from([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, -1.0, -3.0, 1 / 3, -2.5])

    def vector(size: int, values: st.SearchStrategy[Any]) -> NDArray[Any]:
        return np.array(draw(st.lists(values, min_size=size, max_size=size)))

    low, wide = vector(n_columns, st.integers(-3, 3)), vector(n_columns, st.integers(0, 3))
    at_least, range_ = vector(n_rows, st.integers(-6, 3)), vector(n_rows, st.integers(0, 6))
    sides = vector(n_rows, st.sampled_from(["=", "<", ">", "range", "none"]))
    open_ = vector(n_columns, st.sampled_from(["", "", "low", "high", "free"]))
    if finite:
        open_[:] = ""
    integer = np.ones(n_columns, bool) if finite else vector(n_columns, st.booleans())
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
        integer=integer.astype(bool),
        columns=(Block("x", 0, (n_columns,)),),
        rows=(Block("row {i}", 0, (n_rows,)),),
    )


@both_formats
@settings(max_examples=60)
@given(trial=programs())
def test_what_is_written_is_read_again(suffix: str, trial: Program) -> None:
    again = reread(trial, suffix)

    assert again.sense == trial.sense
    assert again.offset == pytest.approx(trial.offset, rel=1e-14)
    names = [again.column_name(j) for j in range(again.n_columns)]
    assert sorted(names) == sorted(f"x({j})" for j in range(trial.n_columns))
    order = [names.index(f"x({j})") for j in range(trial.n_columns)]
    for field in ("cost", "lower", "upper", "integer"):
        np.testing.assert_allclose(
            getattr(again, field)[order].astype(float),
            getattr(trial, field).astype(float),
            rtol=1e-14,  # files have 15 digits
            atol=0.0,
            err_msg=field,
        )

    found = {again.row_name(i): i for i in range(again.n_rows)}
    for i in range(trial.n_rows):
        terms = {
            name.replace("[", "(").replace("]", ")"): value
            for name, value in coefficients(trial, i).items()
        }
        low, high = trial.row_lower[i], trial.row_upper[i]
        if low == -INF and high == INF:
            continue
        if terms and max(terms.values()) < 0:  # such rows are turned
            terms, low, high = {name: -value for name, value in terms.items()}, -high, -low
        if suffix == ".lp" and -INF < low < high < INF:
            halves = {f"row_{i}lo": (low, INF), f"row_{i}up": (-INF, high)}
        else:
            halves = {f"row_{i}": (low, high)}
        for name, bounds in halves.items():
            row = found.pop(name)
            assert coefficients(again, row) == pytest.approx(terms, rel=1e-14)
            assert (again.row_lower[row], again.row_upper[row]) == pytest.approx(bounds, rel=1e-14)
    assert not found


@readers
@both_formats
@settings(max_examples=40)
@given(trial=programs(finite=True))
def test_other_programs_find_the_optimum_in_the_file(
    suffix: str, read: Reader, trial: Program
) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{suffix}"
        write_program(trial, path)
        found = read(path)
    best = best_value(trial)
    assert found == (None if best is None else pytest.approx(best, abs=1e-6))


def by_hand(sense: Sense) -> Program:
    """3 a + 2 b - c + d / 2 + 10 with a ≤ 1 binary, b integer, c free, d ≤ -1, and four rows.

    a + b ≤ 4;  1 ≤ b ≤ 3;  c - b = 0.5;  d ≥ -6.  So c = b + 0.5, and the objective is
    3 a + b + d / 2 + 9.5: least at a = 0, b = 1, d = -6, where it is 7.5, and largest at a = 1,
    b = 3, d = -1, where it is 15.
    """
    return program(
        [[1, 1, 0, 0], [0, -1, 0, 0], [0, -1, 1, 0], [0, 0, 0, -1]],
        [4, -1, 0.5, 6],
        [3, 2, -1, 0.5],
        row_lower=[-INF, -3, 0.5, -INF],
        lower=[0, -INF, -INF, -INF],
        upper=[1, INF, INF, -1],
        integer=[True, True, False, False],
        sense=sense,
        offset=10,
    )


@readers
@both_formats
@pytest.mark.parametrize(("sense", "best"), [("min", 7.5), ("max", 15.0)])
def test_sense_constant_ranges_and_free_variables_reach_other_programs(
    sense: Sense, best: float, suffix: str, read: Reader, tmp_path: Path
) -> None:
    path = tmp_path / f"by_hand{suffix}"
    write_program(by_hand(sense), path)
    assert read(path) == pytest.approx(best)
    assert solve_program(read_program(path)).objective == pytest.approx(best)


def names_of_formulations() -> list[str]:
    return [listing.name for listing in registry.listings()]


@both_formats
@pytest.mark.parametrize("name", names_of_formulations())
def test_every_formulation_has_the_same_optimum_in_the_file(
    name: str, suffix: str, paper: Instance, tmp_path: Path
) -> None:
    formulation = registry.get(name)
    data = stage_data(paper, formulation.spec.stage)
    path = tmp_path / f"{name}{suffix}"
    export(formulation, data, path)
    best = solve(formulation, data).require().objective
    assert read_by_highs(path) == pytest.approx(best)
    assert read_by_scip(path) == pytest.approx(best)


@both_formats
def test_parameters_are_those_asked_for(suffix: str, paper: Instance, tmp_path: Path) -> None:
    # Of two readings of ψ only one counts everything that is met, the other what is met in full.
    data = stage_data(paper, "cluster")
    for psi in (0.0, 1.0):
        path = tmp_path / f"psi{suffix}"
        export("cluster_printed", data, path, psi=psi)
        worth = data.w if psi == 0 else data.w_full
        assert read_by_highs(path) == pytest.approx(worth.max(axis=0).sum())


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
    assert "cluster_one_to_one" in path.read_text().splitlines()[0]


def test_a_row_is_written_the_way_it_was_modelled() -> None:
    x = cp.Variable(2, boolean=True, name="x")
    formulation = problem(cp.Minimize(cp.sum(x)), [(cp.sum(x) >= 1).set_label("somebody goes")])
    with TemporaryDirectory() as folder:
        path = Path(folder) / "trial.lp"
        export(formulation, None, path)
        assert " somebody_goes: +1 x(0) +1 x(1) >= +1\n" in path.read_text()


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
@settings(max_examples=60)
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
            assert len(name) <= LONGEST + 2
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{suffix}"
        write_program(trial, path)
        assert read_by_highs(path) == pytest.approx(4.0)
        assert read_by_scip(path) == pytest.approx(4.0)


@both_formats
def test_a_program_without_names_gets_some(suffix: str) -> None:
    again = reread(replace(program([[1, 1]], 1, [1, 2]), columns=(), rows=()), suffix)
    assert {again.column_name(0), again.column_name(1)} == {"x_0", "x_1"}
    assert again.row_name(0) == "row_0"


@readers
@both_formats
def test_a_row_without_coefficients_stays_as_infeasible_as_it_is(
    suffix: str, read: Reader, tmp_path: Path
) -> None:
    path = tmp_path / f"empty{suffix}"
    write_program(program([[0, 0], [1, 1]], [INF, 2], [1, 1], row_lower=[-1, 0]), path)
    assert read(path) == pytest.approx(0.0)
    write_program(program([[0, 0], [1, 1]], [INF, 2], [1, 1], row_lower=[1, 0]), path)
    assert read(path) is None


@both_formats
def test_variables_in_no_row_keep_their_place_and_kind(suffix: str) -> None:
    trial = program([[1, 0, 0, 0]], 1, [1, 0, 2, 0], upper=INF, integer=[False, True, True, False])
    again = reread(trial, suffix)
    kinds = {again.column_name(j): bool(again.integer[j]) for j in range(again.n_columns)}
    assert kinds == {"x(0)": False, "x(1)": True, "x(2)": True, "x(3)": False}
    assert again.n_rows == 1


@both_formats
def test_a_refused_program_leaves_the_old_file_and_nothing_else(
    suffix: str, tmp_path: Path
) -> None:
    path = tmp_path / f"huge{suffix}"
    path.write_text("as it was")
    with pytest.raises(ModelError, match="HiGHS refuses it; coefficients must be finite"):
        write_program(program([[1e16, 1]], 1, [1, 1]), path)
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


MPS = """NAME by_hand
OBJSENSE
    MAX
ROWS
 N  worth
 L  most
 G  least
 E  same
 L  between
COLUMNS
    MARK  'MARKER'  'INTORG'
    x     worth  3    most     1
    x     same   1    between  1
    MARK  'MARKER'  'INTEND'
    y     worth  2    most     1
    y     least  1    same    -1
RHS
    RHS   worth  -5   most     8
    RHS   least  1    between  4
RANGES
    RNG   between  3
BOUNDS
 UP BND   x  9
 FR BND   y
ENDATA
"""


def test_a_public_mps_file_is_read_to_the_letter(tmp_path: Path) -> None:
    # 3 x + 2 y + 5 with x + y ≤ 8, y ≥ 1, x = y, 1 ≤ x ≤ 4, x ≤ 9 integer: best x = y = 4, 25.
    path = tmp_path / "by_hand.mps"
    path.write_text(MPS)
    found = read_program(path)
    assert (found.sense, found.offset) == ("max", 5.0)
    assert [found.column_name(j) for j in range(2)] == ["x", "y"]
    assert [found.row_name(i) for i in range(4)] == ["most", "least", "same", "between"]
    assert found.cost.tolist() == [3, 2]
    assert found.matrix.toarray().tolist() == [[1, 1], [0, 1], [1, -1], [1, 0]]
    assert found.row_lower.tolist() == [-INF, 1, 0, 1]
    assert found.row_upper.tolist() == [8, INF, 0, 4]
    assert found.lower.tolist() == [0, -INF]
    assert found.upper.tolist() == [9, INF]
    assert found.integer.tolist() == [True, False]
    solution = solve_program(found)
    assert solution.objective == pytest.approx(25.0)
    assert solution.values["x"] == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("words.mps", "this is no program\n", "HiGHS cannot read it"),
        ("words.lp", "this is no program\n", "neither minimize nor maximize"),
        ("half.lp", "min\n o: x\nst\n a: x <= <=\nend\n", "HiGHS cannot read it"),
        ("square.lp", "min\n o: x + [ x ^2 ] / 2\nst\n a: x >= 1\nend\n", "objective is quadratic"),
        (
            "semi.lp",
            "min\n o: x\nst\n a: x + y >= 1\nbounds\n y <= 5\nsemi\n y\nend\n",
            "semi-continuous",
        ),
        (
            "range.lp",
            "Minimize\n o: x\nSubject To\n a: 1 <= x + y <= 2\nBounds\n 0 <= x <= 4\nEnd\n",
            r"two relations in 'a: 1 <= x \+ y <= 2'; give two rows",
        ),
    ],
)
def test_a_file_that_holds_no_linear_program_is_refused_by_name(
    name: str, text: str, problem: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError, match=problem) as caught:
        read_program(path)
    assert caught.value.file == str(path)


def test_two_sided_bounds_in_an_lp_file_are_no_ranges(tmp_path: Path) -> None:
    path = tmp_path / "bounds.lp"
    path.write_text(
        "\\ 1 <= x <= 2\nmin\n o: x + y\nst\n a: x + y >= 1\n b: x - y <= 1\n"
        "bounds\n 0.5 <= x <= 4\nend\n"
    )
    assert read_program(path).lower.tolist() == [0.5, 0]


def test_a_file_that_is_not_there_is_an_error_of_the_users(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_program(tmp_path / "none.mps")
