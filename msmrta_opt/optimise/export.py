"""Programs as files for any other solver: free MPS and LP, written and read by HiGHS.

Names are the modeller's, as far as both formats allow: ``x[0,2]`` is written ``x(0,2)``, and the row
``cluster 2 has at most one robot`` as ``cluster_2_has_at_most_one_robot``. The sense and the constant
of the objective are kept. A row without positive coefficients is written with its signs turned, so
that what was modelled as ``x + y ≥ 1`` reads like it.

What files do not hold: rows without bounds, and coefficients below 1e-12. Numbers have 15 significant
digits. An LP file has a ranged row as two, named with ``lo`` and ``up``, and its variables in the order
of their first appearance.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, vstack

from ..arrays import Ints
from ..mission.errors import InputError, ModelError
from ..mission.files import read_text, write_text, write_with
from .program import Block, Program
from .registry import Formulation
from .solve import compile_for

FORMATS = (".mps", ".lp")

SMALLEST = 1e-12
"""HiGHS takes no smaller coefficient."""

LONGEST = 96
"""Characters of a name: CBC takes 100, and the rows of a range get two more."""

RESERVED = frozenset(
    """
    bin binaries binary bound bounds columns csection end endata free gen general generals inf
    infinity int integer integers marker max maximise maximize maximum min minimise minimize minimum
    name nan obj objsense qcmatrix qsection quadobj range ranges rhs rhs_v rows s.t. semi semis sin
    sos sos1 sos2 st st. subject such
    """.split()  # noqa: SIM905 - a list of as many strings reads worse
)
"""Words that a reader of either format takes for something else than a name."""


def export(
    formulation: str | Formulation, data: Any, path: str | Path, **parameters: float
) -> None:
    """Write `formulation` on `data` as a file, without solving it.

    Parameters
    ----------
    formulation : str or Formulation
        Its name in the registry, or itself.
    data
        What its stage takes, for instance `ClusterData`.
    path : path
        Where to: ``.mps`` (free format) or ``.lp``.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Raises
    ------
    InputError
        If the suffix is unknown, the file cannot be written, or a name or a parameter is wrong.
    ModelError
        If the formulation cannot be built as a linear integer program.
    """
    require_format(path)
    compiled = compile_for(formulation, data)
    write_program(compiled.program(**parameters), path, name=compiled.formulation.name)


def write_program(program: Program, path: str | Path, *, name: str = "") -> None:
    """Write `program` as ``.mps`` (free format) or ``.lp``, whole or not at all.

    Parameters
    ----------
    program : Program
        The arrays.
    path : path
        Where to.
    name : str
        The program's name in the file; by default the file's stem.

    Raises
    ------
    InputError
        If the suffix is unknown or the file cannot be written.
    ModelError
        If HiGHS does not take the program, for instance because of a coefficient beyond 1e15.
    """
    suffix = require_format(path)
    title = legal_name(name or Path(path).stem)
    spelled = as_written(program)

    def write(temporary: Path) -> None:
        if suffix == ".mps":
            _write_by_highs(_each_in_a_row(spelled), title, temporary)
        else:
            _write_by_highs(spelled, title, temporary)
            write_text(temporary, _completed(read_text(temporary), spelled, title))

    write_with(path, write)


def read_program(path: str | Path) -> Program:
    """The program in an ``.mps`` or ``.lp`` file.

    Each variable and each row is a `Block` of its own, of shape ``()``, under its name in the file.
    Of LP files, those that HiGHS would misread are refused: with two relations in a row.

    Raises
    ------
    InputError
        If there is no such file, its suffix is unknown, it cannot be read, or its program is not a
        linear (integer) one.
    """
    import highspy

    suffix = require_format(path)
    if not Path(path).is_file():
        raise InputError("no such file", file=path)
    if suffix == ".lp":
        _refuse_misread(path)
    highs = _quiet_highs()
    if highs.readModel(str(path)) == highspy.HighsStatus.kError:
        raise InputError("HiGHS cannot read it; give a program in free MPS or LP format", file=path)
    if highs.getModel().hessian_.dim_:
        raise InputError("the objective is quadratic; give a linear program", file=path)
    lp = highs.getLp()
    kinds = np.array([int(kind) for kind in lp.integrality_] or [0] * lp.num_col_, dtype=int)
    if (kinds > 1).any():
        raise InputError("there are semi-continuous variables; give a linear program", file=path)
    matrix = lp.a_matrix_
    shape = (lp.num_row_, lp.num_col_)
    return Program(
        sense="max" if lp.sense_ == highspy.ObjSense.kMaximize else "min",
        cost=np.array(lp.col_cost_, dtype=float),
        offset=float(lp.offset_),
        matrix=csc_array((matrix.value_, matrix.index_, matrix.start_), shape=shape).tocsr(),
        row_lower=np.array(lp.row_lower_, dtype=float),
        row_upper=np.array(lp.row_upper_, dtype=float),
        lower=np.array(lp.col_lower_, dtype=float),
        upper=np.array(lp.col_upper_, dtype=float),
        integer=kinds == 1,
        columns=_one_each(lp.col_names_),
        rows=_one_each(lp.row_names_),
    )


def as_written(program: Program) -> Program:
    """`program` as a file has it: rows turned, names legal and unique, nothing without effect.

    Each variable and each row is a `Block` of its own, of shape ``()``.
    """
    matrix = program.matrix.copy()
    matrix.sum_duplicates()
    matrix.data[np.abs(matrix.data) < SMALLEST] = 0.0
    matrix.eliminate_zeros()
    columns = _unique(_names(program.columns, program.n_columns, "x"))
    rows = _unique(_names(program.rows, program.n_rows, "row"), endings=("", "lo", "up"))
    kept = np.flatnonzero(np.isfinite(program.row_lower) | np.isfinite(program.row_upper))
    matrix, lower, upper = matrix[kept], program.row_lower[kept], program.row_upper[kept]
    turned = ((matrix > 0).sum(axis=1) == 0) & (np.diff(matrix.indptr) > 0)
    return replace(
        program,
        matrix=(diags_array(np.where(turned, -1.0, 1.0)) @ matrix).tocsr(),
        row_lower=np.where(turned, 0.0 - upper, lower),
        row_upper=np.where(turned, 0.0 - lower, upper),
        columns=_one_each(columns),
        rows=_one_each(rows[i] for i in kept),
    )


def require_format(path: str | Path) -> str:
    """The suffix of `path`, one of `FORMATS`.

    Raises
    ------
    InputError
        If it is another.
    """
    suffix = Path(path).suffix
    if suffix not in FORMATS:
        raise InputError(
            f"unknown format {suffix!r}; the suffix is one of {', '.join(FORMATS)}", file=path
        )
    return suffix


def legal_name(name: str) -> str:
    """`name` in characters that both formats take: ``x(0,2)`` for ``x[0,2]``.

    By the narrowest readers' rules: ASCII letters, digits and ``_.,()``; no more than 96; first
    neither a digit nor a point, nor an E, which might be read as an exponent.
    """
    name = name.replace("[", "(").replace("]", ")")
    name = re.sub(r"[^A-Za-z0-9_.,()]+", "_", name).strip("_")
    if not name or name[0] in "0123456789.eE" or name.lower() in RESERVED:
        name = f"_{name}"
    return name[:LONGEST].rstrip("_") or "_"


def _names(blocks: Iterable[Block], n: int, default: str) -> list[str]:
    """The names of `n` columns or rows, by their blocks."""
    names = [f"{default}_{i}" for i in range(n)]
    for block in blocks:
        for position in range(block.start, block.stop):
            names[position] = block.element(position)
    return names


def _unique(names: Iterable[str], *, endings: Sequence[str] = ("",)) -> list[str]:
    """The names made legal, and made to differ even with any of `endings` behind them."""
    taken: set[str] = set()
    numbers: dict[str, count[int]] = {}
    unique = []
    for name in map(legal_name, names):
        candidate = name
        while not taken.isdisjoint(candidate + ending for ending in endings):
            ending = f"_{next(numbers.setdefault(name, count(2)))}"
            candidate = name[: LONGEST - len(ending)] + ending
        taken.update(candidate + ending for ending in endings)
        unique.append(candidate)
    return unique


def _one_each(names: Iterable[str]) -> tuple[Block, ...]:
    return tuple(Block(name, position, ()) for position, name in enumerate(names))


def _quiet_highs() -> Any:
    import highspy

    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("small_matrix_value", SMALLEST)
    return highs


def _write_by_highs(program: Program, title: str, path: Path) -> None:
    import highspy

    lp = highspy.HighsLp()
    lp.model_name_ = title
    lp.num_col_, lp.num_row_ = program.n_columns, program.n_rows
    maximise = program.sense == "max"
    lp.sense_ = highspy.ObjSense.kMaximize if maximise else highspy.ObjSense.kMinimize
    lp.col_cost_, lp.offset_ = program.cost, program.offset
    lp.col_lower_, lp.col_upper_ = program.lower, program.upper
    lp.row_lower_, lp.row_upper_ = program.row_lower, program.row_upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = program.matrix.indptr
    lp.a_matrix_.index_ = program.matrix.indices
    lp.a_matrix_.value_ = program.matrix.data
    kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
    lp.integrality_ = [kinds[int(integer)] for integer in program.integer]
    lp.col_names_ = [block.name for block in program.columns]
    lp.row_names_ = [block.name for block in program.rows]
    highs = _quiet_highs()
    failed = highspy.HighsStatus.kError
    if highs.passModel(lp) == failed or highs.writeModel(str(path)) == failed:
        raise ModelError(
            f"{title} cannot be written: HiGHS refuses it; "
            "coefficients must be finite and at most 1e15 in size"
        )


def _in_no_row(program: Program) -> Ints:
    return np.flatnonzero(np.bincount(program.matrix.indices, minlength=program.n_columns) == 0)


def _each_in_a_row(program: Program) -> Program:
    """`program` with a row without bounds over the columns that are in none.

    Of such a column HiGHS' MPS writer does not say whether it is integer. Readers drop the row.
    """
    lonely = _in_no_row(program)
    if not len(lonely):
        return program
    row = csr_array((np.ones(len(lonely)), lonely, [0, len(lonely)]), shape=(1, program.n_columns))
    names = _unique([*(block.name for block in program.rows), "variables in no row"])
    return replace(
        program,
        matrix=vstack([program.matrix, row], format="csr"),
        row_lower=np.append(program.row_lower, -np.inf),
        row_upper=np.append(program.row_upper, np.inf),
        rows=_one_each(names),
    )


def _completed(text: str, program: Program, title: str) -> str:
    """The LP file `text` with what HiGHS' LP writer leaves out.

    These are the title; variables that appear nowhere; and anything to stand to the left of the
    relation in rows without coefficients, without which nobody can read the file.
    """
    names = [block.name for block in program.columns]
    unseen = [names[j] for j in _in_no_row(program) if program.cost[j] == 0]
    text = text.replace(" obj:", " obj:" + "".join(f" +0 {name}\n" for name in unseen), 1)
    text = re.sub(r"^( \S+:)(?= [<>=])", rf"\1 +0 {names[0]}", text, flags=re.MULTILINE)
    return f"\\ Problem name: {title}\n{text}"


def _refuse_misread(path: str | Path) -> None:
    """Refuse LP files that HiGHS takes for another program without a word.

    These are texts without an objective, which is no LP file; and rows such as ``1 <= x + y <= 2``,
    of which it drops a side.
    """
    text = re.sub(r"\\.*", "", read_text(path))
    ignoring = re.IGNORECASE | re.MULTILINE
    if not re.search(r"^\s*(max|min)", text, ignoring):
        raise InputError("neither minimize nor maximize in it; give a linear program", file=path)
    rows = re.search(
        r"^\s*(?:subject to|such that|st|s\.t\.|st\.)\s(.*?)"
        r"^\s*(?:bounds?|bin\w*|gen\w*|int\w*|semi\w*|sos\w*|end)\s*$",
        text,
        ignoring | re.DOTALL,
    )
    found = rows and re.search(r"^.*[<>=][^<>=:\n]*[a-z_][^<>=:\n]*[<>=].*$", rows[1], ignoring)
    if found:
        raise InputError(f"two relations in {found[0].strip()!r}; give two rows", file=path)
