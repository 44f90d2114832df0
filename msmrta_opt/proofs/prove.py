"""From a program and what a solver claims of it to a proof in a file, checked."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..certify import vipr
from ..mission.counting import told_apart
from ..mission.errors import CheckError
from ..mission.files import write_with
from ..optimise.export import is_program
from ..optimise.program import Program, Sense
from ..optimise.registry import Formulation
from ..optimise.solution import Solution
from ..optimise.solve import AUTO, solve_program
from ..optimise.solvers import Options
from ..optimise.subject import subject
from .certificate import Claim, write
from .exact import Numbers
from .prover import TIGHT, Prover
from .tree import Limits, leaves

if TYPE_CHECKING:
    import cvxpy as cp

TIME_LIMIT = 600.0
"""Seconds."""
SIZE_LIMIT = 500e6
"""Bytes."""
CLAIM_TOLERANCE = 1e-6
"""Difference, relative to the objective without its constant, beyond which a proof contradicts a claim:
solvers allow themselves as much."""
ROUNDING = 1e-14
"""Relative, of a claimed value: a sum of products of floats."""
READING: dict[Numbers, str] = {
    "binary": "each number is the binary fraction that the program holds",
    "decimal": "each number is the decimal of the program's file",
    "simple": "each number is the simplest fraction within rounding of what the program holds",
}


@dataclass(frozen=True)
class Proof:
    """What is proved of a program, and what a solver claims of it. Plain and picklable.

    Values are in the program's own sense, its constant included.
    """

    status: Literal["proved", "infeasible", "partial", "none"]
    """``proved``: that the value is optimal; ``infeasible``: that there is none; ``partial``: a bound
    that is not the value, or no solution that is feasible in exact numbers; ``none``: nothing."""
    sense: Sense
    value: float | None = None
    """Of a solution that is feasible in exact numbers."""
    bound: float | None = None
    """No point is better than this."""
    exact_value: Fraction | None = field(default=None, repr=False)
    exact_bound: Fraction | None = field(default=None, repr=False)
    exact_point: tuple[Fraction, ...] | None = field(default=None, repr=False)
    """The solution, shape ``(n_columns,)``."""
    constant: float = 0.0
    """What no point changes of the objective: no part of any gap."""
    step: float = math.inf
    """Where all points have values that are multiples of it, apart from the constant; else infinite."""
    claimed_by: str = ""
    """Solver and version."""
    claimed_status: str = ""
    claimed_value: float | None = None
    numbers: Numbers = "binary"
    """What floats were taken for; see `exact_program`."""
    rounded: bool = False
    """Whether the claimed solution misses rows in exact numbers, but by rounding only."""
    contradiction: str = ""
    """In what the proof contradicts the claim; empty if it does not."""
    remark: str = ""
    """Why not all is proved; empty if it is."""
    nodes: int = 0
    """Nodes that were looked at."""
    leaves: int = 0
    derivations: int = 0
    size: int = 0
    """Bytes of the certificate."""
    seconds: float = 0.0
    """Of finding the proof and writing it down."""
    check_seconds: float = 0.0
    """Of checking it."""
    path: str = ""

    @property
    def summary(self) -> str:
        """What is proved, what it took, and what is only claimed, in a line."""
        leaves = "1 leaf" if self.leaves == 1 else f"{self.leaves} leaves"
        took = f"{leaves}, {self.size} bytes, {self.seconds:.1f} s"
        if self.status == "proved":
            said = f"proved ({took})"
        elif self.status == "infeasible":
            said = f"proved infeasible ({took})"
        else:
            bound = "nothing" if self.bound is None else f"{self.bound:.9g}"
            said = f"claimed by {self.claimed_by}; proved up to {bound} ({took}): {self.remark}"
        return f"{said}; CONTRADICTED: {self.contradiction}" if self.contradiction else said


def prove(
    what: str | Path | Formulation | Program | cp.Problem,
    data: Any = None,
    *,
    path: str | Path,
    solution: Solution | None = None,
    solver: str = AUTO,
    time_limit: float | None = TIME_LIMIT,
    size_limit: float | None = SIZE_LIMIT,
    **parameters: float,
) -> Proof:
    """Prove the optimum of a program, or that it has no solution, in a VIPR 1.0 certificate.

    Parameters
    ----------
    what : str, Formulation, path, Program or cvxpy.Problem
        A formulation by its name or itself, which takes `data`; a file in MPS or LP format; arrays; or
        any linear (integer) problem of cvxpy.
    data
        What the formulation's stage takes, for instance `ClusterData`.
    path : path
        Where the certificate goes.
    solution : Solution, optional
        What is claimed of the program; by default it is solved first.
    solver : str
        By whom.
    time_limit : float, optional
        Seconds for the solver, and again for the proof. What is proved by then is written.
    size_limit : float, optional
        Bytes of derivations after which the search for a proof stops.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Raises
    ------
    InputError
        If a name, a file or a parameter is wrong, or the certificate cannot be written.
    ModelError
        If it is no linear integer program.
    SolverError
        If the solver is missing, or cannot do what is asked.
    CheckError
        If the certificate does not pass its check.
    """
    asked = subject(what, data, **parameters)
    program, name = asked.program, asked.name
    if solution is None:
        options = Options(time_limit=time_limit)
        solution = solve_program(program, solver=solver, options=options)
    is_file = isinstance(what, (str, Path)) and is_program(what)
    values = "".join(f" {parameter}={value:g}" for parameter, value in asked.parameters.items())
    return prove_program(
        program, solution, path,
        time_limit=time_limit, size_limit=size_limit,
        numbers=("decimal", "binary") if is_file else ("binary", "simple"),
        comments=(f"{name}{values}: what {solution.solver} {solution.solver_version} claims",),
    )  # fmt: skip


def prove_program(
    program: Program,
    claim: Solution,
    path: str | Path,
    *,
    time_limit: float | None = None,
    size_limit: float | None = None,
    numbers: Sequence[Numbers] = ("binary", "simple"),
    comments: tuple[str, ...] = (),
) -> Proof:
    """Prove what `claim` says of `program`, as far as possible, and write the certificate to `path`.

    Parameters
    ----------
    program : Program
        The arrays.
    claim : Solution
        What a solver says of it.
    path : path
        Where the certificate goes.
    time_limit : float, optional
        Seconds for the search; what is proved by then is written.
    size_limit : float, optional
        Bytes of derivations after which the search stops.
    numbers : sequence of str
        What floats stand for (see `exact_program`): the first of these with which the claimed solution
        is feasible in exact numbers, or else the first of all.
    comments : tuple of str
        Lines at the beginning of the certificate.

    Raises
    ------
    InputError
        If the file cannot be written.
    CheckError
        If the certificate does not pass its check: nothing of it is to be believed then.
    """
    began = time.perf_counter()
    limits = Limits(
        began + time_limit if time_limit is not None else math.inf,
        math.inf if size_limit is None else size_limit,
    )
    prover = _prover(program, claim, limits, numbers)
    proved = prover.run()
    said = Claim(proved.infeasible, proved.derived, proved.bound, prover.value, prover.point)
    counts: list[int] = []

    def put(temporary: Path) -> None:
        with temporary.open("wb") as file:
            counts.append(
                write(
                    file, prover.program, said, proved.root, prover.lemmas, prover.spool,
                    proved.grid, (*comments, READING[prover.numbers]),
                )
            )  # fmt: skip

    write_with(path, put)
    written = time.perf_counter()
    try:
        vipr.verify(str(path))
    except vipr.RefusedError as refusal:
        raise CheckError(f"{path}: the certificate does not pass its check: {refusal}") from None
    sign = prover.program.sign
    return judged(
        Proof(
            status="infeasible" if proved.infeasible else "none",
            sense=program.sense,
            exact_value=None if prover.value is None else sign * prover.value,
            exact_bound=None if proved.bound is None else sign * proved.bound,
            exact_point=_point(prover, program.n_columns),
            constant=float(sign * prover.program.constant),
            step=math.inf if prover.grid is None else float(prover.grid.step),
            claimed_by=f"{claim.solver} {claim.solver_version}".strip(),
            claimed_status=claim.status,
            claimed_value=claim.objective,
            numbers=prover.numbers,
            rounded=prover.is_rounded,
            remark=proved.remark,
            nodes=prover.search.n_nodes,
            leaves=0 if proved.root is None else sum(1 for _ in leaves(proved.root)),
            derivations=counts[0],
            size=Path(path).stat().st_size,
            seconds=written - began,
            check_seconds=time.perf_counter() - written,
            path=str(path),
        ),
        scale=float(prover.program.largest_cost),
    )


def _point(prover: Prover, n_columns: int) -> tuple[Fraction, ...] | None:
    """The solution without the column of the objective's constant."""
    return None if prover.point is None else tuple(map(Fraction, prover.point[:n_columns]))


def _prover(
    program: Program, claim: Solution, limits: Limits, numbers: Sequence[Numbers]
) -> Prover:
    """With the first of `numbers` by which the claimed solution is feasible, or else the first."""
    provers = (Prover(program, claim, limits, reading) for reading in numbers)
    first = next(provers)
    if first.value is not None or not claim.values:
        return first
    return next((other for other in provers if other.value is not None), first)


def judged(proof: Proof, *, scale: float) -> Proof:
    """`proof` with its status worked out, and what it says of the claim; `scale` is of the costs."""
    value, bound = proof.exact_value, proof.exact_bound
    near = Fraction(TIGHT * max(scale, _size(proof, value, bound)))
    status = proof.status
    if status != "infeasible":
        if value is not None and bound is not None and abs(value - bound) <= near:
            status = "proved"
        elif value is not None or bound is not None:
            status = "partial"
    known = replace(
        proof,
        status=status,
        value=None if value is None else float(value),
        bound=None if bound is None else float(bound),
    )
    if status == "proved" or (status == "infeasible" and not proof.rounded):
        known = replace(known, remark="")
    claim = Claimed(proof.claimed_status, proof.claimed_value)
    return replace(known, contradiction=contradiction(claim, known))


def _size(proof: Proof, *values: float | Fraction | None) -> float:
    """The largest of the `values` that are there, apart from the objective's constant."""
    constant = Fraction(proof.constant)
    sizes = (abs(float(Fraction(x) - constant)) for x in values if x is not None)
    return max(sizes, default=0.0)


@dataclass(frozen=True)
class Claimed:
    """What a solver says: a status of `Solution`, and a value if it has one."""

    status: str
    objective: float | None


def contradiction(claim: Claimed | Solution, proof: Proof) -> str:
    """In what `proof` contradicts `claim`, of the same program; empty if it does not."""
    claimed, value, bound = claim.objective, proof.value, proof.bound
    if claim.status == "infeasible" and value is not None:
        return f"it claims that there is no solution, and {value:.9g} is the value of one"
    if claimed is None:
        return ""
    if proof.status == "infeasible":
        if proof.rounded:
            return ""
        return f"it claims a solution of value {claimed:.9g}, and there is none"
    sign = 1 if proof.sense == "min" else -1
    slack = min(CLAIM_TOLERANCE * _size(proof, claimed, value, bound), proof.step / 2)
    slack = max(slack, ROUNDING * abs(claimed))
    if (
        claim.status in ("optimal", "claimed")
        and value is not None
        and sign * (claimed - value) > slack
    ):
        said, true = told_apart(claimed, value)
        return f"it claims that {said} is optimal, and {true} is feasible"
    if bound is not None and proof.rounded and proof.claimed_value is not None:
        bound = sign * min(sign * bound, sign * proof.claimed_value)
    if bound is not None and sign * (bound - claimed) > slack:
        said, true = told_apart(claimed, bound)
        return f"it claims a solution of value {said}, and no point is better than {true}"
    return ""
