"""MPS files from anywhere: read as everybody reads them, or refused with line and reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.program_files import assert_refused, mps, read

from msmrta_opt.optimise.solve import solve_program

INF = float("inf")


def integer(columns: str) -> str:
    return f"M 'MARKER' 'INTORG'\n{columns}\nM 'MARKER' 'INTEND'"


INTEGER = integer("x c 1 d 1\nx obj 3") + "\ny c 1 obj 2"
NEGATIVE = "x c 1 d 1\ny c 1\nx obj -3\ny obj -2"
"""Of which the maximum is as small as can be."""

MPS_READ: dict[str, tuple[str, float]] = {
    "as it should be, split columns": (mps(), 11.5),
    "split columns of a minimum": (
        mps("x obj 1\nx c 1\ny obj 1\ny d 1\nx d 1", "rhs c 4 d 9", rows="N obj\nG c\nG d").replace(
            "MAX", "MIN"
        ),
        9,
    ),
    "a column in three parts": (mps("x c 1\ny c 1\nx d 1\ny obj 2\nx obj 3"), 11.5),
    "Windows": (mps().replace("\n", "\r\n"), 11.5),
    "byte order mark": ("\ufeff" + mps(), 11.5),
    "remarks and blank lines": ("* one\n\n" + mps().replace("RHS\n", "* two\n\nRHS\n", 1), 11.5),
    "tabs": (mps().replace("    ", "\t"), 11.5),
    "no name": (mps().removeprefix("NAME t\n"), 11.5),
    "a name in words": (mps(first="NAME a program of mine (FREE)"), 11.5),
    "sense on its line": (mps().replace("OBJSENSE\n    MAX", "OBJSENSE MAXIMIZE"), 11.5),
    "sense in small letters": (mps().replace("    MAX", "    max"), 11.5),
    "to be minimised": (mps().replace("OBJSENSE\n    MAX\n", ""), 0),
    "no names of sets": (mps(rhs="c 4\nd 3.5", rest="BOUNDS\nUP x 1"), 9),
    "right-hand sides in a line": (mps(rhs="RHS c 4 d 3.5"), 11.5),
    "constant": (mps(rhs="RHS obj 10 c 4\nRHS d 3.5"), 1.5),
    "negative constant": (mps(rhs="RHS obj -10 c 4\nRHS d 3.5"), 21.5),
    "a second row N": (
        mps(rows="N obj\nN other\nL c\nL d").replace("y c 1", "y c 1 other 9"),
        11.5,
    ),
    "no right-hand sides": (mps(rhs=""), 0),
    "numbers": (mps(rhs="RHS c +4. d .35e+1"), 11.5),
    "range of L": (mps(NEGATIVE, rest="RANGES\nRNG c 1 d 3"), -6.5),
    "range of G": (mps(rows="N obj\nG c\nL d", rest="RANGES\nRNG c -2"), 15.5),
    "range of E, up": (mps(rows="N obj\nE c\nL d", rest="RANGES\nRNG c 2"), 15.5),
    "range of E, down": (mps(NEGATIVE, rows="N obj\nE c\nL d", rest="RANGES\nRNG c -2"), -4),
    "range of E, none": (mps(NEGATIVE, rows="N obj\nE c\nL d", rest="RANGES\nRNG c 0"), -8),
    "ranges first": (mps().replace("RHS\n", "RANGES\n    R c 1\nRHS\n", 1), 11.5),
    "infinite side": (mps(rhs="RHS c 1e30 d 3.5", rest="BOUNDS\nUP B y 100"), 210.5),
    "integer without bounds": (mps(INTEGER), 9),
    "integer up to seven": (mps(INTEGER, rest="BOUNDS\nUP B x 7"), 11),
    "integer from two": (mps(INTEGER, rest="BOUNDS\nLO B x 2"), 11),
    "integer without upper bound": (mps(INTEGER, rest="BOUNDS\nPL B x"), 11),
    "BV": (mps(rest="BOUNDS\nBV B x"), 9),
    "BV with a value": (mps(rest="BOUNDS\nBV B x 1"), 9),
    "BV without a set": (mps(rest="BOUNDS\nBV x"), 9),
    "BV, then FX": (mps(rest="BOUNDS\nBV B x\nFX B x 0"), 8),
    "FX, then BV": (mps(rest="BOUNDS\nFX B x 0\nBV B x"), 8),
    "FX": (mps(rest="BOUNDS\nFX B x 0.5"), 8.5),
    "LI": (mps(NEGATIVE, rest="BOUNDS\nLI B x 2"), -6),
    "UI": (mps(rest="BOUNDS\nUI B x 3"), 11),
    "LI makes integer": (mps(rest="BOUNDS\nLI B x 0"), 11),
    "FR": (mps(NEGATIVE, rows="N obj\nG c\nL d", rest="BOUNDS\nFR B y"), -8),
    "FR with a value": (mps(NEGATIVE, rows="N obj\nG c\nL d", rest="BOUNDS\nFR B y 0"), -8),
    "MI": (
        mps("x c 1 obj -1\ny d 0", rows="N obj\nG c\nL d", rhs="R c -9", rest="BOUNDS\nMI B x"),
        9,
    ),
    "FR, then UP": (mps(rest="BOUNDS\nFR B x\nUP B x 1"), 9),
    "MI and a negative UP": (mps(rest="BOUNDS\nMI B x\nUP B x -1"), 7),
    "negative UP and LO": (mps(rest="BOUNDS\nUP B x -1\nLO B x -2"), 7),
    "UP of zero": (mps(rest="BOUNDS\nUP B x 0"), 8),
    "infinite bounds": (mps(rest="BOUNDS\nUP B x 1e30\nLO B y -Inf\nUP B y +infinity"), 11.5),
    "the same bound twice": (mps(rest="BOUNDS\nUP B x 1\nUP B x 1"), 9),
    "a set called as a variable": (mps(rest="BOUNDS\nUP y x 1"), 9),
    "variables called as a row and a word": (mps().replace("y", "c").replace("x", "RHS"), 11.5),
}


@pytest.mark.parametrize("name", MPS_READ)
def test_an_mps_file_is_read_as_everybody_reads_it(name: str, tmp_path: Path) -> None:
    text, best = MPS_READ[name]
    solution = solve_program(read(text, tmp_path / "program.mps"))
    assert solution.objective == pytest.approx(best)


MPS_REFUSED: dict[str, tuple[str, str, str]] = {
    "no program": ("this is no program\n", "line 1", "'this' is no section of a linear program"),
    "nothing": ("", "", "no ENDATA; the file is cut off"),
    "cut off": (mps().replace("ENDATA\n", ""), "", "no ENDATA; the file is cut off"),
    "behind the end": (mps() + "NAME u\n", "line 17", "'NAME u' after ENDATA"),
    "data before sections": (" x c 1\n" + mps(), "line 1", "' x c 1' in no section"),
    "no objective": (mps("x c 1", rows="L c\nL d"), "ROWS", "no row of type N"),
    "no columns": (
        mps(first="").split("COLUMNS")[0].lstrip() + "ENDATA\n",
        "",
        "no section COLUMNS",
    ),
    "two sections": (mps(rest="RHS\nRHS c 4"), "line 16", "a second section RHS"),
    "quadratic": (
        mps(rest="QUADOBJ\nx x 1"),
        "line 16",
        "'QUADOBJ' is no section of a linear program",
    ),
    "sos": (mps(rest="SOS\nS1 s x 1"), "line 16", "'SOS' is no section of a linear program"),
    "indicators": (mps(rest="INDICATORS\nIF c y 1"), "line 16", "'INDICATORS' is no section"),
    "semi-continuous": (mps(rest="BOUNDS\nSC B x 3"), "line 17", "bound 'SC'; give UP, LO, FX"),
    "other marker": (mps("M 'MARKER' 'SOSORG'\nx c 1"), "line 9", "marker 'SOSORG'"),
    "marker that no screen shows": (mps("M 'MARKER' 'I\x04K"), "line 9", "marker 'I\x04K;"),
    "unknown sense": (
        mps().replace("    MAX", "    MAXIMAL"),
        "line 3",
        "'MAXIMAL'; give MAX or MIN",
    ),
    "two senses": (mps().replace("OBJSENSE\n", "OBJSENSE MIN\n"), "line 3", "a second sense"),
    "name with a blank": (mps("x 1 c 1"), "line 9", "3 fields where one or two rows with a number"),
    "name with two blanks": (mps("x 1 2 c 1"), "line 9", "unknown row '1'"),
    "row with a blank": (mps(rows="N obj\nL my c\nL d"), "line 6", "'L my c'; give N, L, G or E"),
    "unknown kind of row": (mps(rows="N obj\nX c\nL d"), "line 6", "'X c'; give N, L, G or E"),
    "row twice": (mps(rows="N obj\nL c\nG c\nL d"), "line 7", "a second row 'c'"),
    "unknown row": (mps("x e 1"), "line 9", "unknown row 'e'"),
    "entry twice": (mps("x c 1 d 1\nx c 1"), "line 10", "a second coefficient of 'x' in 'c'"),
    "entry twice in a line": (mps("x c 1 c 1"), "line 9", "a second coefficient of 'x' in 'c'"),
    "cost twice": (mps("x obj 1\nx obj 1"), "line 10", "a second coefficient of 'x' in 'obj'"),
    "half of a pair": (mps("x c 1 d"), "line 9", "3 fields where one or two rows with a number"),
    "both within and outside": (
        mps(INTEGER + "\nx d 1"),
        "line 14",
        "'x' is both within and outside",
    ),
    "decimal comma": (mps("x obj 1,5"), "line 9", "'1,5'; give a number such as"),
    "exponent of Fortran": (mps(rhs="RHS c 4D1"), "line 14", "'4D1'; give a number such as"),
    "underscore": (mps(rhs="RHS c 4_0"), "line 14", "'4_0'; give a number such as"),
    "not a number": (mps(rhs="RHS c nan"), "line 14", "'nan'; give a number such as"),
    "infinite": (mps(rhs="RHS c inf"), "line 14", "'inf'; give a number such as"),
    "beyond a float": (mps(rhs="RHS c 1e999"), "line 14", "'1e999'; give a number such as"),
    "hexadecimal": (mps(rhs="RHS c 0x10"), "line 14", "'0x10'; give a number such as"),
    "other digits": (mps(rhs="RHS c ٤"), "line 14", "'٤'; give a number such as"),
    "a remark behind": (mps("x c 1 $ one"), "line 9", "a remark behind fields"),
    "side twice": (mps(rhs="RHS c 4\nRHS c 5"), "line 15", "a second value of 'c' in RHS"),
    "two sets of sides": (mps(rhs="R1 c 4\nR2 d 5"), "line 15", "'R2' is a second set of RHS"),
    "two sets of ranges": (
        mps(rest="RANGES\nA c 4\nB d 5"),
        "line 18",
        "'B' is a second set of RANGES",
    ),
    "two sets of bounds": (
        mps(rest="BOUNDS\nUP A x 4\nUP B y 5"),
        "line 18",
        "'B' is a second set",
    ),
    "range of the objective": (mps(rest="RANGES\nR obj 4"), "row obj", "of type N, with a range"),
    "range of no side": (mps(rhs="R c 1e30", rest="RANGES\nR c 4"), "row c", "side inf; give one"),
    "side that nothing meets": (mps(rhs="R c -1e30"), "row c", "side -inf; give one"),
    "negative upper bound": (
        mps(rest="BOUNDS\nUP B x -5"),
        "variable x",
        "upper bound -5 without a",
    ),
    "unknown bound": (mps(rest="BOUNDS\nXX B x 5"), "line 17", "bound 'XX'; give UP, LO, FX"),
    "bound of a stranger": (
        mps(rest="BOUNDS\nUP B z 5"),
        "line 17",
        "'UP B z 5'; give the kind of",
    ),
    "bound without a number": (mps(rest="BOUNDS\nUP B x"), "line 17", "'UP B x'; give the kind of"),
    "bound with two numbers": (
        mps(rest="BOUNDS\nUP B x 5 6"),
        "line 17",
        "'UP B x 5 6'; give the kind",
    ),
    "free with a number": (mps(rest="BOUNDS\nFR B x -5"), "line 17", "FR with the value -5"),
    "another upper bound": (
        mps(rest="BOUNDS\nUP B x 5\nUP B x 3"),
        "line 18",
        "bound 3 where 5 was",
    ),
    "UP, then FR": (mps(rest="BOUNDS\nUP B x 5\nFR B x"), "line 18", "bound inf where 5 was given"),
    "BV, then UP": (
        mps(rest="BOUNDS\nBV B x\nUP B x 3"),
        "variable x",
        "binary, with bounds 0 and 3",
    ),
    "BV, then FX to 3": (
        mps(rest="BOUNDS\nBV B x\nFX B x 3"),
        "variable x",
        "binary, with bounds 3",
    ),
    "lower bound beyond all": (mps(rest="BOUNDS\nLO B x 1e30"), "variable x", "bounds inf and inf"),
    "lines that begin at once": (
        "ROWS\nN obj\n",
        "line 2",
        "'N' is no section of a linear program",
    ),
    "something behind a section": (
        mps().replace("ROWS\n", "ROWS 3\n"),
        "line 4",
        "'3' behind ROWS",
    ),
}


@pytest.mark.parametrize("name", MPS_REFUSED)
def test_an_mps_file_of_which_readers_differ_is_refused_by_line(name: str, tmp_path: Path) -> None:
    assert_refused(MPS_REFUSED[name][0], tmp_path / "program.mps", *MPS_REFUSED[name][1:])


def test_a_public_mps_file_is_read_to_the_letter(tmp_path: Path) -> None:
    # 3 x + 2 y + 5 with x + y ≤ 8, y ≥ 1, x = y, 1 ≤ x ≤ 4, x ≤ 9 integer: best x = y = 4, 25.
    text = """NAME by_hand
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
    found = read(text, tmp_path / "by_hand.mps")
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
