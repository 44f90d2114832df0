"""SciPy's linear sum assignment: for programs whose matrix is recognised as an assignment."""

from __future__ import annotations

from ..assignment import solve_assignment
from ..check import dual_bound
from ..program import Program
from ..structure import integral_relaxation, recognise
from .base import Options, Outcome, Solver


def run(program: Program, options: Options) -> Outcome:
    """Solve a recognised assignment; anything else is refused."""
    del options  # it declares no ability that an option could ask for
    structure = recognise(program)
    found = None if structure is None else solve_assignment(program, structure)
    if structure is None or found is None:
        return Outcome("skipped", message="not recognised as a linear assignment with a solution")
    x, duals = found
    bound = dual_bound(integral_relaxation(program, structure), duals)
    proof = f"{structure.description}; assignment algorithm, dual values"
    return Outcome("optimal", x, bound, duals=duals, proof=proof)


SOLVER = Solver(
    name="lsa",
    title="SciPy linear sum assignment, for recognised structure",
    package="scipy",
    module="scipy",
    install="pip install scipy",
    abilities=frozenset(["integer", "bound", "duals"]),
    run=run,
    rank=9,
)
