"""One type of solution for all solvers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..mission import display
from ..mission.errors import CheckError, InputError
from ..mission.suggestions import meant
from .program import Block, Sense

if TYPE_CHECKING:
    import pandas as pd

Status = Literal[
    "optimal",  # proven
    "feasible",  # stopped with an incumbent
    "no_solution",  # stopped without one
    "infeasible",  # proven
    "unbounded",  # proven
    "claimed",  # an optimum by a solver's word alone, of numbers of very different size
    "contradicted",  # a solver's word that a checked point refutes; see the message
    "error",  # see the message
    "skipped",  # not attempted; see the message
]


@dataclass(frozen=True, repr=False)
class Solution:
    """What is known after solving one formulation on one data set. Plain and picklable.

    Objective and bound are in the model's own sense and include its constants; times are in seconds.
    """

    formulation: str
    status: Status
    sense: Sense
    objective: float | None = None
    """Value of the incumbent, worked out again from the arrays."""
    bound: float | None = None
    """No feasible point is better than this."""
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict, repr=False)
    """The incumbent, by variable name."""
    proof: str = ""
    """How the bound was obtained."""
    check: str = ""
    """Verdict of the independent check: ``passed``, what failed, or empty without an incumbent."""
    solver: str = ""
    solver_version: str = ""
    message: str = ""
    parameters: dict[str, float] = field(default_factory=dict)
    options: dict[str, object] = field(default_factory=dict)
    digest: str = ""
    """Of the formulation's file."""
    start: str = ""
    """What became of a MIP start, if one was given."""
    tolerances: dict[str, float] = field(default_factory=dict)
    """What rows may miss, relative to their terms, and what the solver was content with, on the
    scaled program."""
    violation: float = 0.0
    """The largest share of its terms by which a row is missed."""
    offset: float = 0.0
    """The constant of the objective, with what fixed variables cost: no part of any gap."""
    unit: float = 0.0
    """The smallest size of the objective that its data gives meaning to; see `scaling`."""
    canonicalise_seconds: float = 0.0
    solve_seconds: float = 0.0
    nodes: int | None = None
    n_variables: int = 0
    n_rows: int = 0
    duals: dict[str, NDArray[np.float64]] = field(default_factory=dict, repr=False)
    """Dual values by constraint label, where the proof is LP duality: what a unit more of a row's side
    changes the optimal value by, in the model's own sense, for every solver alike."""
    blocks: tuple[Block, ...] = field(default=(), repr=False)
    """The variables, then the constraints, with the ids along their dimensions."""

    @property
    def gap(self) -> float | None:
        """Relative gap, ``|objective - bound| / |objective - offset|``; 0 when proven optimal."""
        if self.objective is None or self.bound is None:
            return None
        difference = abs(self.objective - self.bound)
        size = abs(self.objective - self.offset) or max(abs(self.bound - self.offset), 1e-300)
        return difference / size if difference else 0.0

    @property
    def objective_size(self) -> float | None:
        """What differences of the objective are relative to: its value without the constant."""
        value = self.bound if self.objective is None else self.objective
        return None if value is None else max(self.unit, abs(value - self.offset))

    @property
    def found(self) -> bool:
        """Whether there is an incumbent that passed its check."""
        return self.objective is not None and self.check == "passed"

    def nonzero(self) -> list[tuple[str, float]]:
        """The variables that are not zero, by names such as ``x[7,104]``, in ids."""
        return [
            (block.element(block.start + int(place)), float(flat[place]))
            for block in self.blocks
            if block.name in self.values
            for flat in [self.values[block.name].ravel(order="F")]
            for place in np.flatnonzero(np.abs(flat) > 1e-9)
        ]

    def to_frame(self, name: str | None = None) -> pd.DataFrame:
        """A variable, or the rows of a constraint, as a table with a column for each axis, in ids.

        Parameters
        ----------
        name : str, optional
            A variable's name, or a constraint's label; without one, all variables that are not zero.

        Returns
        -------
        DataFrame
            With a last column ``value``, or ``dual``.

        Raises
        ------
        InputError
            If the solution has nothing of that name.
        """
        import pandas as pd

        if name is None:
            return pd.DataFrame(self.nonzero(), columns=["variable", "value"])
        found = {"value": self.values, "dual": self.duals}
        for block in self.blocks:
            for what, arrays in found.items():
                if block.name == name and name in arrays:
                    nouns = block.nouns or tuple(f"axis {d}" for d in range(len(block.shape)))
                    places = np.indices(block.shape).reshape(len(block.shape), -1)
                    ids = block.ids or tuple(tuple(range(n)) for n in block.shape)
                    columns: dict[str, object] = {
                        noun: [along[i] for i in at.tolist()]
                        for noun, along, at in zip(nouns, ids, places, strict=True)
                    }
                    return pd.DataFrame({**columns, what: arrays[name].ravel()})
        names = [key for arrays in found.values() for key in arrays]
        known = ", ".join(map(repr, names)) or "nothing"
        raise InputError(
            f"no values of {name!r}{meant(name, names)}; there are those of {known}", field="name"
        )

    def __repr__(self) -> str:
        return f"Solution({self._summary})"

    def _repr_html_(self) -> str:
        rows = [{"variable": name, "value": value} for name, value in self.nonzero()]
        facts = {
            "status": self.status,
            "objective": self.objective,
            "bound": self.bound,
            "gap": self.gap,
            "proof": self.proof,
            "independent check": self.check,
            "solver": f"{self.solver} {self.solver_version}".strip(),
            "parameters": ", ".join(f"{k} = {v:g}" for k, v in self.parameters.items()),
            "size": f"{self.n_variables} variables, {self.n_rows} rows",
            "message": self.message,
        }
        told = [{"what": what, "value": x} for what, x in facts.items() if x not in (None, "")]
        return display.page(
            self._summary,
            display.table("Certificate", told),
            display.table("Variables that are not zero", rows),
        )

    @property
    def _summary(self) -> str:
        parts = [f"{self.formulation}: {self.status}"]
        if self.objective is not None:
            parts.append(f"{self.sense} {self.objective:.9g}")
        if self.bound is not None:
            parts.append(f"bound {self.bound:.9g}")
        parts += [self.solver] if self.solver else []
        return ", ".join(parts)

    def document(self) -> dict[str, Any]:
        """The certificate and the variables that are not zero, ready for JSON; ids in the names."""
        names = (
            *("formulation", "status", "sense", "objective", "bound", "gap", "proof", "check"),
            *("solver", "solver_version", "message", "parameters", "options", "start"),
            *("canonicalise_seconds", "solve_seconds", "nodes", "n_variables", "n_rows"),
        )
        rows = [{"variable": name, "value": value} for name, value in self.nonzero()]
        return {**{name: getattr(self, name) for name in names}, "variables": rows}

    def require(self) -> Solution:
        """The solution itself, if it holds a checked incumbent.

        Raises
        ------
        CheckError
            If it does not, saying what is known instead.
        """
        if not self.found:
            raise CheckError(f"{self.formulation}: {self.status}: {self.reason}")
        return self

    @property
    def reason(self) -> str:
        """Why there is no solution to show, and what to do; of one that is, what was said of it."""
        if self.status == "infeasible":
            said = self.message or "no point is feasible"
            is_formulation = bool(self.digest)
            how = f"`msmrta explain {self.formulation} INSTANCE`" if is_formulation else "`explain`"
            return f"{said}; {how} names the rows that conflict"
        return self.message or ("" if self.found else self.check or "no feasible point")
