"""The relaxation of a reduced program that adds the connectivity cuts that its points violate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from ...arrays import Floats, Ints
from ...optimise.scaling import Scaling
from ...proofs.derivation import Box, Combination
from ...proofs.exact import ExactProgram, Rational, Row
from ...proofs.multipliers import Bounds
from ...proofs.relaxation import Relaxation, Relaxed
from ..branch_and_cut.edge_formulation import EdgeFormulation
from ..branch_and_cut.points import point_supports
from ..branch_and_cut.separation import Cut, separate

ROUNDS = 12
"""Of cuts at a node."""
TOLERANCE = 0.02
"""Violation from which on a cut is added at a fractional point."""
ENFORCED = 1e-4
"""Violation from which on it is added at an integral one."""
CUTS_A_ROBOT = 8
STALLED = 1e-4
"""Relative rise of the bound by a round of cuts that does not pay."""


class SeparatingRelaxation(Relaxation):
    """The relaxation of some columns of the edge formulation, with cuts.

    Parameters
    ----------
    program : ExactProgram
        Of these columns.
    formulation : EdgeFormulation
        The whole.
    columns : int array, shape (n_columns,)
        Which of its columns the program has.
    rows : list of Row
        The program's rows; cuts are added to them, too.
    state : callable
        The row of a cut, stated in the certificate, by the program's columns.
    """

    def __init__(
        self,
        program: ExactProgram,
        formulation: EdgeFormulation,
        columns: Ints,
        rows: list[Row],
        state: Callable[[Cut], Row],
    ) -> None:
        largest = max((abs(float(c)) for c in program.cost), default=1.0) or 1.0
        row = [
            2.0 ** -np.ceil(np.log2(max(map(abs, r.coefficients), default=1))) for r in program.rows
        ]
        program.row_of = list(range(len(program.rows)))
        factors = Scaling(
            np.array(row), np.ones(program.n_columns), float(2.0 ** -np.ceil(np.log2(largest)))
        )
        super().__init__(program, factors)
        self._formulation = formulation
        self._columns = columns
        self._rows = rows
        self._state = state
        self._known: set[Cut] = set()

    def solve(self, *, iterations: int | None = None, time_limit: float | None = None) -> Relaxed:
        """Solve it, with cuts unless the iterations are limited."""
        relaxed = super().solve(iterations=iterations, time_limit=time_limit)
        if iterations is not None:
            return relaxed
        for _ in range(ROUNDS):
            if relaxed.x is None:
                break
            before = relaxed.value
            far = np.abs(relaxed.x - np.round(relaxed.x)).max(initial=0.0)
            is_integral = far < ENFORCED
            if not self._cut(relaxed.x, ENFORCED if is_integral else TOLERANCE):
                break
            relaxed = super().solve(time_limit=time_limit)
            if not is_integral and relaxed.value - before < STALLED * abs(before):
                break
        return relaxed

    def _cut(self, x: Floats, tolerance: float) -> bool:
        """Add cuts that `x` violates; whether there are any."""
        whole = np.zeros(self._formulation.n_columns)
        whole[self._columns] = x
        cuts = [
            cut
            for support in point_supports(self._formulation, whole)
            for cut in separate(support, tolerance=tolerance)[:CUTS_A_ROBOT]
            if cut not in self._known
        ]
        if cuts:
            self._known.update(cuts)
            rows = [self._state(cut) for cut in cuts]
            self._rows.extend(rows)
            self.add_rows(rows)
        return bool(cuts)

    def start_from(self, basis: Any) -> None:
        """Start from a basis kept before; rows added since are basic."""
        import highspy

        missing = self.n_rows - len(basis.row_status)
        if missing > 0:
            basic = highspy.HighsBasisStatus.kBasic
            basis.row_status = [*basis.row_status, *[basic] * missing]
        super().start_from(basis)


class CutoffBounds(Bounds):
    """Derivations that a node holds no better plan: its bound contradicts the assumption of one.

    Parameters
    ----------
    program, rows
        As of `Bounds`.
    goal : int
        What the assumption says that the objective is below.
    assumption : int
        Reference of ``objective ≤ goal - 1``.
    """

    def __init__(self, program: ExactProgram, rows: list[Row], goal: int, assumption: int) -> None:
        super().__init__(program, rows)
        self._plain = Bounds(program, rows)
        self.goal = goal
        self._assumption = assumption

    def derive(self, duals: Floats, box: Box, target: Fraction | None) -> Combination | None:
        """A contradiction if `duals` give one, else a bound; ``None`` if below `target`."""
        return self._against(self._plain.derive(duals, box, target))

    def exactly(self, duals: Sequence[Rational], box: Box) -> Combination | None:
        """A contradiction if exact `duals` give one, else a bound."""
        return self._against(self._plain.exactly(duals, box))

    def _against(self, found: Combination | None) -> Combination | None:
        if found is None or found.value is None or found.value <= self.goal - 1:
            return found
        multipliers = dict(found.multipliers)
        multipliers[self._assumption] = multipliers.get(self._assumption, 0) - found.under
        return Combination(None, multipliers, found.under)
