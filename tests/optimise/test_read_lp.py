"""LP files from anywhere: read as everybody reads them, or refused with line and reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.program_files import assert_refused, mps, read

from msmrta_opt.optimise.export import read_program, write_program
from msmrta_opt.optimise.solve import solve_program

INF = float("inf")


def lp(
    objective: str = "x + y",
    rows: str = "c: x + y <= 3",
    bounds: str = "x <= 2\ny <= 2",
    rest: str = "",
    sense: str = "max",
) -> str:
    return f"{sense}\n obj: {objective}\nst\n{rows}\nbounds\n{bounds}\n{rest}end\n"


def small(text: str) -> str:
    return f"max\n obj: x\nst\n c: x <= 3\n{text}end\n"


READ: dict[str, tuple[str, float]] = {
    # The optimum is by hand.
    "as it should be": (lp(), 3),
    "maximise": (lp(sense="maximise"), 3),
    "Maximize": (lp(sense="Maximize"), 3),
    "MAXIMUM": (lp(sense="MAXIMUM"), 3),
    "minimise": (lp("-x - y", sense="minimise"), -3),
    "subject to": (lp().replace("st\n", "Subject To\n"), 3),
    "such that": (lp().replace("st\n", "such that\n"), 3),
    "s.t.": (lp().replace("st\n", "S.T.\n"), 3),
    "byte order mark": ("\ufeff" + lp(), 3),
    "Windows": (lp().replace("\n", "\r\n"), 3),
    "tabs and blank lines": (lp().replace(" ", "\t").replace("\n", "\n\n \n"), 3),
    "remarks": (lp("x \\ + 100 x\n + y"), 3),
    "a remark before all": ("\\ min\n" + lp(), 3),
    "no name of the objective": (lp().replace("obj:", ""), 3),
    "no objective": ("max\nst\n c: x <= 3\nend\n", 0),
    "terms that add up": (lp("x + y + x", "c: x + y <= 3"), 5),
    "terms that add up in a row": (lp(rows="c: x + y + x <= 3", bounds="x <= 2\ny <= 1"), 2),
    "terms that take each other away": (lp(rows="c: x + y - x <= 1"), 3),
    "constant in the objective": (lp("x + 2 + y - 0.5"), 4.5),
    "constant on the left": (lp(rows="c: x + y + 1 <= 3"), 2),
    "constants on both sides": (lp(rows="c: 1 + x + y - 4 <= 3 - 5 "), 1),
    "variables on the right": (lp(rows="c: x <= 3 - y"), 3),
    "variables on the right alone": (lp(rows="c: 3 >= x + y"), 3),
    "joined to its variable on the right": (lp(rows="c: 4 >= 2x + y"), 3),
    "a variable on both sides": (lp(rows="c: 2 x + y <= 3 + x"), 3),
    "a sum on the right": (lp(rows="c: x + y <= 2 + 1"), 3),
    "signs after signs": (lp("x - -1 y + -0.5 x"), 2.5),
    "a coefficient joined to its variable": (lp("2x + 0.5y"), 4.5),
    "a variable that begins with e": (lp("2 e1 + y", "c: e1 + y <= 3", "e1 <= 2\ny <= 2"), 5),
    "exponents": (lp("1e0 x + .1E+1 y + 0.0e-5 x"), 3),
    "e behind an exponent": (lp("1e1x + y"), 21),
    "a range": (lp("x + y", "c: -1 <= x - y <= 0.5", sense="max"), 4),
    "a range in lines": (lp("x - y", "c: -1 <=\n x\n - y\n <= 0.5"), 0.5),
    "a range from above": (lp("x - y", "c: 0.5 >= x - y >= -1"), 0.5),
    "a row in lines": (lp(rows="c: x\n + y\n <=\n 3"), 3),
    "rows without names": (lp(rows="x + y <= 3\nx - y <= 2\n- x + y <= 0.5"), 3),
    "rows without names beside R1 and R2": (
        lp(rows="x + y <= 3\nR2: x <= 9\nx <= 8\nR1: y <= 7"),
        3,
    ),
    "rows in one line": (lp(rows="a: x + y <= 3 b: x - y <= 2"), 3),
    "a row behind a number": (lp(rows="x + y <= 3\n+ x - y <= -1.5"), 2.5),
    "<": (lp(rows="c: x + y < 3"), 3),
    "=<": (lp(rows="c: x + y =< 3"), 3),
    "=>": (lp(rows="c: - x - y => -3"), 3),
    "=": (lp("x - y", "c: x + y = 3"), 1),
    "infinite side": (lp(rows="c: x + y <= +inf"), 4),
    "side that is infinite to all": (lp(rows="c: x + y <= 1e30"), 4),
    "a row of zeros": (lp(rows="c: x + y <= 3\n d: 0 x <= 1"), 3),
    "bounds from both sides": (lp("- x - y", bounds="0.5 <= x <= 2\n2 >= y >= 1"), -1.5),
    "bounds that fix": (lp("- x - y", bounds="x = 0.5\n1 = y"), -1.5),
    "free": (lp("- x - y", "c: x + y >= -3", "x free\ny FREE"), 3),
    "free, then a bound": (lp("- 2 x", "c: x + 1 >= 0", "x free\n-5 <= x <= 5"), 2),
    "infinite bounds": (lp("- x - y", "c: x + y >= -3", "x >= -inf\n-Infinity <= y <= +inf"), 3),
    "bound that is infinite to all": (lp("- x", "c: x + y >= -3", "x >= -1e20\ny = 0"), 3),
    "bound given twice": (lp(bounds="x <= 0\nx <= 2\ny <= 0.5"), 2.5),
    "bound of zero": (lp(bounds="x <= 0\ny <= -0"), 0),
    "general": (small("general\n x\n"), 3),
    "integers, several a line": (lp("x + 1.5 y", "c: 2 x + 2 y <= 5", rest="int\nx y\n"), 3),
    "binary": (lp(rows="c: x + y <= 3", bounds="", rest="BINARIES\n x\n y\n"), 2),
    "binary and fixed": (lp(bounds="x = 0\ny <= 1", rest="bin\n x\n y\n"), 1),
    "binary before bounds": (small("bin\n x\nbounds\n x <= 0\n"), 0),
    "empty sections": (small("bounds\nbin\ngen\nsemi\nsos\nsemi-continuous\n"), 3),
}
READ["names of all kinds"] = (lp().replace("x ", "x.1(2,a)!\"#$%&?@'`{}~| "), 3)


@pytest.mark.parametrize("name", READ)
def test_an_lp_file_is_read_as_everybody_reads_it(name: str, tmp_path: Path) -> None:
    text, best = READ[name]
    solution = solve_program(read(text, tmp_path / "program.lp"))
    assert solution.objective == pytest.approx(best)


@pytest.mark.parametrize("suffix", [".LP", ".Lp", ".MPS"])
def test_a_suffix_is_read_in_letters_of_any_case(suffix: str, tmp_path: Path) -> None:
    text, best = (lp(), 3.0) if suffix.lower() == ".lp" else (mps(), 11.5)
    path = tmp_path / f"program{suffix}"
    assert solve_program(read(text, path)).objective == pytest.approx(best)
    write_program(read(text, path), tmp_path / f"again{suffix}")
    assert solve_program(read_program(tmp_path / f"again{suffix}")).objective == pytest.approx(best)


def test_rows_without_names_are_numbered_past_those_that_have_them(tmp_path: Path) -> None:
    found = read(
        "max\n x\nst\n x <= 3\n R1: x <= 4\n R3: x <= 5\n x <= 6\nend\n", tmp_path / "a.lp"
    )
    assert [block.name for block in found.rows] == ["R2", "R1", "R3", "R4"]


REFUSED: dict[str, tuple[str, str, str]] = {
    # (text, line, problem)
    "no program": ("this is no program\n", "line 1", "'this', where minimize or maximize"),
    "nothing": ("", "", "neither minimize nor maximize in it"),
    "something before": (
        "obj: x\n" + lp(),
        "line 1",
        "'obj', where minimize or maximize should be",
    ),
    "lp_solve": ("max: 3x + 2y;\nc1: x + y <= 4;\n", "line 1", "';' is no part of"),
    "no rows": ("max\n x\nend\n", "line 1", "no 'subject to' behind the objective"),
    "cut off": (lp().replace("end\n", ""), "", "no 'end'; the file is cut off"),
    "cut off in a row": ("max\n x\nst\n c: x <=\nend\n", "line 4", "nothing on one of its sides"),
    "something behind the end": (lp() + "x\n", "line 9", "'x' behind 'end'"),
    "two objectives": (lp(rest="min\n x\n"), "line 8", "a second objective"),
    "two lists of rows": (lp(rest="st\n d: x <= 1\n"), "line 8", "a second list of rows"),
    "all in a line": ("max x st c: x <= 3 end\n", "line 1", "'st', where the name of a variable"),
    "product": (lp(rows="c: 3 x y <= 10"), "line 4", "'y' without a sign before it"),
    "product with a star": (
        lp(rows="c: 3 * x <= 10"),
        "line 4",
        "'*' is a quadratic term, or no part",
    ),
    "two coefficients": (lp(rows="c: 2 3 x >= 12"), "line 4", "'3' behind another number"),
    "coefficient behind": (lp(rows="c: x 3 >= 12"), "line 4", "'3' without a sign before it"),
    "two sums": (lp("x + y\nx"), "line 3", "'x' without a sign before it"),
    "square": (lp("x + [ x ^2 ] / 2"), "line 2", "'[' is a quadratic term, or no part"),
    "power": (lp("x ^ 2"), "line 2", "'^' is a quadratic term, or no part"),
    "remark of C": (
        lp(rows="/* c: x <= 1 */\nd: x + y <= 3"),
        "line 4",
        "'/' is a quadratic term, or no",
    ),
    "remark of C++": (
        lp(rows="c: x + y <= 3 // or 4"),
        "line 4",
        "'/' is a quadratic term, or no part",
    ),
    "decimal comma": (lp(rows="c: x + y <= 1,5"), "line 4", "',' is no part of a linear program"),
    "decimal comma as coefficient": (lp("1,5 x"), "line 2", "',' is no part of a linear program"),
    "two points": (lp("1.5.2 x"), "line 2", "'.2' behind another number"),
    "hexadecimal": (lp(rows="c: x <= 0x10"), "line 4", "'x10' joined to a number; put a blank"),
    "underscore": (lp(rows="c: x <= 1_000"), "line 4", "'_000' joined to a number; put a blank"),
    "of Fortran": (lp(rows="c: x <= 1d3"), "line 4", "'d3' joined to a number; put a blank"),
    "joined to an e": (lp("2e x + y", bounds=""), "line 2", "'e' joined to a number; put a blank"),
    "not a number": (lp(rows="c: x + y <= nan"), "line 4", "'nan', where the name of a variable"),
    "beyond a float": (lp("1e999 x"), "line 2", "'1e999'; give a number such as"),
    "a sum beyond a float": (
        lp("1e308 x + 1e308 x"),
        "line 2",
        "coefficients of 'x' add up beyond",
    ),
    "below a float": (lp("1e-999 x"), "line 2", "'1e-999'; give a number such as"),
    "infinite coefficient": (lp("inf x"), "line 2", "an infinite coefficient"),
    "infinite constant": (lp("x + inf"), "line 1", "an infinite constant"),
    "infinite less infinite": (
        lp(rows="c: x + inf <= inf"),
        "line 4",
        "a side that no number can meet",
    ),
    "a row that nothing meets": (
        lp(rows="c: x >= 1e30"),
        "line 4",
        "a side that no number can meet",
    ),
    "two relations": (lp(rows="c: x <= y <= 3"), "line 4", "two relations in a row"),
    "two relations that differ": (
        lp(rows="c: 1 <= x + y >= 3"),
        "line 4",
        "two relations in a row",
    ),
    "two relations, one of them =": (
        lp(rows="c: 1 = x + y <= 3"),
        "line 4",
        "two relations in a row",
    ),
    "three relations": (lp(rows="c: 1 <= x <= 2 <= 3"), "line 4", "a row has one relation"),
    "no relation": (lp(rows="c: x + y"), "line 4", "a row has one relation"),
    "relation ==": (lp(rows="c: x + y == 3"), "line 4", "nothing on one of its sides"),
    "relation <>": (lp(rows="c: x + y <> 3"), "line 4", "nothing on one of its sides"),
    "an indicator": (lp(rows="c: x = 1 -> y <= 2"), "line 4", "a sign with nothing behind it"),
    "numbers alone": (lp(rows="c: 1 <= 2"), "line 4", "a relation of numbers alone"),
    "sign alone": (lp("x + y -"), "line 2", "a sign with nothing behind it"),
    "relation in the objective": (lp("x + y <= 3"), "line 2", "'<=' in the objective"),
    "two names": (lp(rows="c: d: x <= 3"), "line 4", "a row has one relation"),
    "name given twice": (lp(rows="c: x + y <= 3\nc: x <= 1"), "line 5", "a second row 'c'"),
    "name that is a word": (lp(rows="free: x + y <= 3"), "line 4", "'free', where the name of a"),
    "variable that is a word": (lp("x + bin"), "line 2", "'bin', where the name of a variable"),
    "number joined to a bracket": (lp("2(x)"), "line 2", "'(' is no part of a linear program"),
    "other script": (lp("ψ"), "line 2", "'ψ' is no part of a linear program"),
    "full width digit": (lp("２ x"), "line 2", "'２' is no part of a linear program"),
    "bound with a coefficient": (lp(bounds="2 x <= 1"), "line 6", "a bound is of one variable"),
    "bound of the negative": (lp(bounds="- x <= 1"), "line 6", "a bound is of one variable"),
    "bound of a sum": (lp(bounds="x + y <= 1"), "line 6", "a bound is of one variable"),
    "two bounds a line": (lp(bounds="x <= 1 y <= 2"), "line 6", "two relations in a row"),
    "free and more": (lp(bounds="x free 3"), "line 6", "'3' behind a bound"),
    "bound of a stranger": (lp(bounds="z <= 1"), "line 6", "unknown variable 'z'"),
    "integer stranger": (lp(rest="gen\n z\n"), "line 9", "unknown variable 'z'"),
    "integer number": (lp(rest="gen\n 3\n"), "line 9", "'3', where the name of a variable"),
    "negative upper bound": (
        lp(bounds="x <= -5"),
        "variable x",
        "upper bound -5 without a lower one",
    ),
    "binary up to five": (
        lp(bounds="x <= 5", rest="bin\n x\n"),
        "variable x",
        "binary, with bounds 0",
    ),
    "binary from below": (
        lp(bounds="x >= -1", rest="bin\n x\n"),
        "variable x",
        "binary, with bounds -1",
    ),
    "bounds that nothing meets": (
        lp(bounds="x >= inf"),
        "line 6",
        "a side that no number can meet",
    ),
    "semi-continuous": (
        lp(rest="semi\n x\n"),
        "line 9",
        "'x' behind 'semi'; give a linear program",
    ),
    "semi-continuous in full": (
        lp(rest="Semi-Continuous\n x\n"),
        "line 9",
        "'x' behind 'Semi-Cont",
    ),
    "sos": (lp(rest="sos\n s1: S1:: x: 1 y: 2\n"), "line 9", "'s1' behind 'sos'"),
    "lazy": (lp(rest="lazy constraints\n d: x <= 1\n"), "line 8", "'constraints' behind 'lazy'"),
    "subject without to": (lp().replace("st\n", "subject\n"), "line 3", "'subject' without 'to'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_an_lp_file_of_which_readers_differ_is_refused_by_line(name: str, tmp_path: Path) -> None:
    assert_refused(REFUSED[name][0], tmp_path / "program.lp", *REFUSED[name][1:])
