"""Where numbers have decimal commas, programs are written and read with decimal points all the same."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.programs import INF, program

from msmrta_opt.optimise.export import read_program, write_program

both_formats = pytest.mark.parametrize("suffix", [".mps", ".lp"])
SET_LOCALE = """
import ctypes, locale, os, sys
locale.setlocale(locale.LC_NUMERIC, "comma")
assert locale.localeconv()["decimal_point"] == ","
strtod = ctypes.CDLL(None).strtod
strtod.restype = ctypes.c_double
assert strtod(b"2,5", None) == 2.5  # as readers written in C read it
from msmrta_opt.optimise.export import read_program, write_program
"""


@pytest.fixture(scope="session")
def decimal_comma(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment in which the locale ``comma`` writes 1,5 for 1.5."""
    folder = tmp_path_factory.mktemp("locales")
    try:
        subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", folder / "comma"], check=True, timeout=60
        )
    except (FileNotFoundError, subprocess.CalledProcessError):
        pytest.skip("no localedef here that makes a locale with a decimal comma")
    return {"LOCPATH": str(folder)}


def said(code: str, *paths: Path, environment: dict[str, str]) -> list[str]:
    """What a process says that runs `code` on `paths` where 1,5 is a number."""
    arguments = [sys.executable, "-c", SET_LOCALE + code, *map(str, paths)]
    env = {"PYTHONPATH": ":".join(sys.path), **environment}
    ended = subprocess.run(arguments, env=env, check=True, capture_output=True, text=True)
    return ended.stdout.splitlines()


@both_formats
def test_what_is_written_and_read_there_is_what_is_written_and_read_here(
    suffix: str, tmp_path: Path, decimal_comma: dict[str, str]
) -> None:
    code = """
for written, again in zip(sys.argv[1::2], sys.argv[2::2]):
    write_program(read_program(written), again, name="t")
    print(read_program(again).offset, read_program(again).cost.tolist())
"""
    trials = [
        program([[1 / 3, 0.123456789012346]], 1e-3, [1 / 3, -2.5], upper=0.5, offset=1e-7),
        program([[0.333]], 0.5, [0.25], upper=1.5, integer=False),  # decimals below 1 everywhere
        program([[1.5, 2.5]], 4.5, [0.5, 1.5], upper=2.5, integer=False, offset=-2.5),
        program([[0.1, 1e-5]], 7.25, [1e-9, 1e9], row_lower=0.75, lower=-0.5, integer=False),
        program([[1, 1]], 2.5, [3, 1], lower=[-INF, 0], upper=[2, 1], sense="max", offset=2),
    ]
    pairs = [(tmp_path / f"{n}{suffix}", tmp_path / f"{n}b{suffix}") for n in range(len(trials))]
    for trial, (before, _) in zip(trials, pairs, strict=True):
        write_program(trial, before, name="t")
    assert said(code, *(path for pair in pairs for path in pair), environment=decimal_comma) == [
        "1e-07 [0.3333333333333333, -2.5]",
        "0.0 [0.25]",
        "-2.5 [0.5, 1.5]",
        "0.0 [1e-09, 1000000000.0]",
        "2.0 [3.0, 1.0]",
    ]
    for trial, (before, after) in zip(trials, pairs, strict=True):
        assert after.read_text() == before.read_text()
        again = read_program(after)
        for field in ("cost", "row_lower", "row_upper", "lower", "upper"):
            assert np.array_equal(getattr(again, field), getattr(trial, field)), field
        assert np.array_equal(again.matrix.toarray(), trial.matrix.toarray())


FILES = {
    # As HiGHS writes them.
    "digits.lp": """\
\\ Problem name: digits
\\ File written by HiGHS .lp file handler
min
 obj: +0.333333333333333 x(0) +0.333333333333333 x(1)  +0.1
st
 c: +0.333333333333333 x(0) +0.123456789012346 x(1) >= +0.001
bounds
 x(0) <= 1
 x(1) <= 1
bin
 x(0)
 x(1)
gen
semi
end
""",
    "digits.mps": """\
NAME        digits
ROWS
 N  Obj
 G  c
COLUMNS
    MARK0000  'MARKER'                 'INTORG'
    x(0)      Obj       0.333333333333333
    x(0)      c         0.333333333333333
    x(1)      Obj       0.333333333333333
    x(1)      c         0.123456789012346
    MARK0001  'MARKER'                 'INTEND'
RHS
    RHS_V     Obj       -0.1
    RHS_V     c         0.001
BOUNDS
 BV BOUND     x(0)
 BV BOUND     x(1)
ENDATA
""",
    "max_constant.lp": """\
\\ Problem name: max_constant
\\ File written by HiGHS .lp file handler
max
 obj: +3 x +1 y  +2
st
 c: +1 x +1 y <= +2.5
bounds
 -inf <= x <= 2
 y <= 1
bin
 y
gen
semi
end
""",
    "max_constant.mps": """\
NAME        max_constant
OBJSENSE
  MAX
ROWS
 N  Obj
 L  c
COLUMNS
    x         Obj       3
    x         c         1
    MARK0000  'MARKER'                 'INTORG'
    y         Obj       1
    y         c         1
    MARK0001  'MARKER'                 'INTEND'
RHS
    RHS_V     Obj       -2
    RHS_V     c         2.5
BOUNDS
 MI BOUND     x
 UP BOUND     x         2
 BV BOUND     y
ENDATA
""",
}
THIRD, PART = 0.333333333333333, 0.123456789012346
READ = {
    "digits": (0.1, [THIRD, THIRD], [THIRD, PART], [0.001], [INF], [1.0, 1.0]),
    "max_constant": (2.0, [3.0, 1.0], [1.0, 1.0], [-INF], [2.5], [2.0, 1.0]),
}


def test_another_programs_files_are_read_there_to_the_last_digit(
    tmp_path: Path, decimal_comma: dict[str, str]
) -> None:
    code = """
for path in sys.argv[1:]:
    p = read_program(path)
    parts = (p.cost, p.matrix.data, p.row_lower, p.row_upper, p.upper)
    print((p.offset, *(part.tolist() for part in parts)))
"""
    paths = [tmp_path / name for name in FILES]
    for path in paths:
        path.write_text(FILES[path.name])
    wanted = [str(READ[path.stem]) for path in paths]
    assert said(code, *paths, environment=decimal_comma) == wanted
