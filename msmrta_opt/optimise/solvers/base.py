"""The contract of a solver: what it can do, and one function from arrays to an outcome."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Literal, get_args

import numpy as np

from ...arrays import Floats
from ...mission.errors import InputError, SolverError, UnsupportedError
from ..program import INFINITE, LARGEST, SMALLEST, Program
from ..scaling import scaled, scaling
from ..solution import Status

Ability = Literal[
    "integer", "lp", "time_limit", "gap", "seed", "threads", "start", "verbose", "bound", "duals"
]
EVERY_ABILITY: frozenset[Ability] = frozenset(get_args(Ability))


@dataclass(frozen=True)
class Options:
    """Options with one meaning for every solver. ``None`` leaves the solver's own default.

    Parameters
    ----------
    time_limit : float, optional
        Seconds of wall time.
    gap : float, optional
        Stop when the relative gap is at most this; the default asks for a proof of optimality.
    seed : int, optional
        Of the solver's random choices.
    threads : int, optional
        The default is one, so that results can be repeated.
    start : float array, shape (n_columns,), optional
        A MIP start; NaN where it says nothing.
    verbose : bool
        Let the solver print its log.
    """

    time_limit: float | None = None
    gap: float | None = None
    seed: int | None = None
    threads: int | None = None
    start: Floats | None = None
    verbose: bool = False
    presolve: bool = True
    """Whether the solver may restate the program first; for a second look at what it said."""

    def __post_init__(self) -> None:
        if self.time_limit is not None and not self.time_limit >= 0:
            raise InputError(f"{self.time_limit}; give seconds, 0 or more", field="time_limit")
        if self.gap is not None and not self.gap >= 0:
            raise InputError(f"{self.gap}; give a relative gap, 0 or more", field="gap")
        if self.threads is not None and not (self.threads >= 1 and self.threads % 1 == 0):
            raise InputError(f"{self.threads}; give a whole number, 1 or more", field="threads")
        if self.seed is not None and not (0 <= self.seed < 2**31 and self.seed % 1 == 0):
            raise InputError(f"{self.seed}; give a whole number, 0 to 2147483647", field="seed")

    def given(self) -> dict[str, object]:
        """The options that were set, a start only by the fact."""
        chosen: dict[str, object] = {"start": True} if self.start is not None else {}
        for name in ("time_limit", "gap", "seed", "threads"):
            if (value := getattr(self, name)) is not None:
                chosen[name] = value
        return chosen | ({"verbose": True} if self.verbose else {})


@dataclass(frozen=True)
class Outcome:
    """What a solver said, in the program's own sense, before anybody checked it.

    ``duals`` are LP duals in the convention of `check.dual_bound`.
    """

    status: Status
    x: Floats | None = None
    bound: float | None = None
    nodes: int | None = None
    duals: Floats | None = None
    proof: str = ""
    message: str = ""


@cache
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


@cache
def _importable(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:
        return False


@dataclass(frozen=True)
class Solver:
    """A way to solve programs, with declared abilities."""

    name: str
    title: str
    package: str
    """The distribution that provides it."""
    module: str
    """The module that must be importable."""
    install: str
    abilities: frozenset[Ability]
    run: Callable[[Program, Options], Outcome] = field(compare=False, repr=False)
    tolerances: Mapping[str, float] = field(default_factory=dict, compare=False)
    """Absolute tolerances within which it calls a row satisfied and a value integral."""
    rank: int = 100
    """Place in lists."""
    available: Callable[[], bool] | None = field(default=None, compare=False, repr=False)
    """A further condition beyond the module, for instance a licence."""
    ask_version: Callable[[], str] | None = field(default=None, compare=False, repr=False)
    """Asks the solver for its version, where its package has another."""

    @property
    def installed(self) -> bool:
        """Whether it can be used here."""
        return _importable(self.module) and (self.available is None or self.available())

    @property
    def version(self) -> str:
        """The solver's own version, empty if it is not there."""
        own = self.ask_version
        return own() if own is not None and _importable(self.module) else self.package_version

    @property
    def package_version(self) -> str:
        """The version of the package that provides it, empty if there is none."""
        return _version(self.package)

    def solve(self, program: Program, options: Options) -> Outcome:
        """Solve `program`; what the solver cannot do is refused by name.

        Raises
        ------
        SolverError
            If it is not installed, or fails.
        UnsupportedError
            If an option or the program asks for what it cannot do.
        """
        if not self.installed:
            raise SolverError(f"solver {self.name} is not installed; {self.install}")
        for option in options.given():
            if option not in self.abilities:
                raise UnsupportedError(f"solver {self.name} cannot do {option}")
        if program.integer.any() and "integer" not in self.abilities:
            raise UnsupportedError(f"solver {self.name} cannot do integer programs")
        if not program.integer.all() and "lp" not in self.abilities:
            raise UnsupportedError(f"solver {self.name} cannot do continuous variables")
        factors = scaling(program)
        sent = scaled(program, factors)
        refuse_dropped(self.name, program, sent)
        start = None if options.start is None else options.start / factors.column
        outcome = self.run(sent, replace(options, start=start))
        x = outcome.x
        if x is not None and x.shape == factors.column.shape:
            x = x * factors.column
        return replace(
            outcome,
            x=x,
            bound=None
            if outcome.bound is None
            else outcome.bound * factors.unit + program.constant,
            duals=None if outcome.duals is None else outcome.duals * factors.row * factors.unit,
        )


def refuse_dropped(name: str, program: Program, sent: Program) -> None:
    """Refuse numbers that solvers would drop, refuse or take for infinite, named by row and column.

    Parameters
    ----------
    name : str
        The solver's.
    program, sent : Program
        The program, and what is sent of it, scaled.

    Raises
    ------
    UnsupportedError
        For the first of them.
    """
    _refuse_infinite(name, program, sent)
    size = np.abs(sent.matrix.data)
    wrong = ((size > 0) & (size <= SMALLEST)) | (size >= LARGEST)
    if not wrong.any():
        return
    entry = int(np.flatnonzero(wrong)[0])
    row = int(np.searchsorted(program.matrix.indptr, entry, side="right")) - 1
    entries = slice(program.matrix.indptr[row], program.matrix.indptr[row + 1])
    largest = float(np.abs(program.matrix.data[entries]).max())
    raise UnsupportedError(
        f"solver {name} cannot do row '{program.row_name(row)}': the coefficient"
        f" {program.matrix.data[entry]:g} of"
        f" {program.column_name(int(program.matrix.indices[entry]))} beside {largest:g};"
        " give coefficients of a row within a factor of 1e9, for instance a smaller big M"
    )


def refuse_infinite_costs(program: Program) -> None:
    """Refuse costs that solvers take for infinite, and values that would be beyond a float's range."""
    for place in np.flatnonzero(np.abs(program.cost) >= INFINITE):
        raise UnsupportedError(
            f"no solver can do the cost {program.cost[place]:g} of"
            f" '{program.column_name(int(place))}'; give less than {INFINITE:g}, in another unit"
        )


def _refuse_infinite(name: str, program: Program, sent: Program) -> None:
    """Refuse finite sides and bounds that solvers take for infinite."""
    for what, ends, of in (
        ("side", (sent.row_lower, sent.row_upper), program.row_name),
        ("bound", (sent.lower, sent.upper), program.column_name),
    ):
        for end in ends:
            for place in np.flatnonzero(np.isfinite(end) & (np.abs(end) >= INFINITE)):
                raise UnsupportedError(
                    f"solver {name} cannot do the {what} {end[place]:g} of '{of(int(place))}': it takes"
                    f" it for infinite; give less than {INFINITE:g}, or none"
                )
