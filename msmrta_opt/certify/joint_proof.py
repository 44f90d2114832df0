r"""Whether a VIPR certificate is about the joint problem of a plan, and what it then proves of it.

`vipr` checks that the bound follows from the constraints that a certificate states. Here each of these
is held against the mission: the file may state whatever the edge formulation of `linear_relaxation`
implies, and nothing else. All of it is written out anew from the mission; of the file, a constraint's
name says which one it claims to be.

Times of rows are in units of their greatest common divisor, and so is T; the objective is the plan's, in
time units, all service being the cost of a variable that is 1. Names are words with colons:

==========================  ==================================================================
``y:R:V`` ``f:R:V``         robot R visits victim V; V is the first, ``l:R:V`` the last victim
``e:R:V:W`` ``a:R:V:KIND``  R walks between V and W, V < W; R serves a kind at V
``T``                       the makespan
``service``                 the variable that is 1, where the objective is total time
``low:NAME`` ``upp:NAME``   a variable is at least 0, at most 1 (not T); ``fix:service``: it is 1
``KIND_OF_ROW:R:…``         a row of `mission.proof`, by what it is about
``subtour:R:V:S``           a cut of robot R, victim V and the victims S, with commas between
``first:R:S``               ``outside`` and ``last`` alike
==========================  ==================================================================

Of a kind's name, characters other than letters, digits and ``_.-~`` are written as in addresses of the
web, but with ``=`` in place of ``%``. A constraint may be weaker than what it is named: as all variables
are at least 0, a ≤ row with smaller coefficients or a larger side is one.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from pathlib import Path
from urllib.parse import quote

from ..mission.errors import CheckError, InputError
from ..mission.exact import greatest_common_divisor
from ..mission.plan import Plan
from . import vipr
from .certificates import worth
from .joint_problem import Joint, figure
from .linear_relaxation import CUTS, MAKESPAN, Column, Row, cut_row, first_rows
from .verdict import Verdict

_CUT = re.compile(
    r"(first|last):(\d{1,18})():([\d,]*)|(subtour|outside):(\d{1,18}):(\d{1,18}):([\d,]*)"
)
SERVICE: Column = ("service",)
_OF_TIMES = ("walk", "endurance", "makespan")


def check_joint_proof(path: str | Path, plan: Plan) -> Verdict:
    """Check a certificate of the joint problem of `plan`; what it proves.

    Parameters
    ----------
    path : path
        The certificate, in VIPR 1.0.
    plan : Plan
        One that passes its own check (`certify.plan.problems`).

    Raises
    ------
    InputError
        If the file cannot be read.
    CheckError
        If it does not prove what it claims, or states what does not follow from the mission; with the
        line at which it fails.
    """
    statement: list[_Statement] = []

    def admit(found: vipr.Certificate) -> None:
        statement.append(_Statement(Joint.of(plan), found))

    try:
        found = vipr.verify(str(path), admit)
    except vipr.RefusedError as refusal:
        raise CheckError(f"{path}: {refusal}") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", file=path) from None
    stated = statement[0]
    value = worth(plan, stated.objective)
    if found.infeasible or found.lower is None:
        claim = "that there is no plan, and there is this one" if found.infeasible else "no bound"
        raise CheckError(f"{path}: it claims {claim}")
    bound = Fraction(found.lower)
    if bound > value:
        raise CheckError(
            f"{path}: it claims that no plan has a {stated.objective} below {figure(bound)}, and this "
            f"one has {figure(value)}"
        )
    size = f"{stated.n_cuts} cuts, {found.n_derivations} derivations"
    return Verdict(stated.objective, value, bound, size)


class _Statement:
    """The joint problem as a certificate should state it.

    Raises
    ------
    RefusedError
        If it does not.
    """

    def __init__(self, joint: Joint, found: vipr.Certificate) -> None:
        self.joint = joint
        self.objective = "makespan" if "T" in found.names else "total_time"
        self.unit = joint.step(self.objective) or Fraction(1)
        self.n_cuts = 0
        cost, rows = first_rows(joint, self.objective, lambda *key: (_word(*key), Fraction(0)))
        place = {name: j for j, name in enumerate(found.names)}
        if offset := joint.offset(self.objective):
            cost = {**cost, SERVICE: offset}
        columns = {_word(*column): column for column in cost}
        if place.keys() != columns.keys() or len(place) < len(found.names):
            other = sorted(place.keys() ^ columns.keys()) or sorted(found.names)
            raise vipr.RefusedError(1, f"the variables are not those of the mission: {other[0]}")
        self.place = {column: place[name] for name, column in columns.items()}
        self._known: dict[str, Row] = {row.name: self._in_units(row) for row in rows}
        for name, column in columns.items():
            if column == SERVICE:
                self._known[f"fix:{name}"] = Row("", {column: 1}, 1, 1, Fraction(0))
                continue
            self._known[f"low:{name}"] = Row("", {column: 1}, 0, None, Fraction(0))
            if column != MAKESPAN:
                self._known[f"upp:{name}"] = Row("", {column: 1}, None, 1, Fraction(0))
        self._require_objective(found, cost)
        for (line, name), item in zip(found.labels, found.constraints, strict=True):
            try:
                self._require_implied(name, item)
            except CheckError as error:
                raise vipr.RefusedError(line, str(error)) from None

    def _in_units(self, row: Row) -> Row:
        """`row`, if it is one of times, in whole units of them.

        Of limits, that is their own greatest common divisor, and what is beyond a multiple is left out.
        """
        if row.name.partition(":")[0] not in _OF_TIMES:
            return row
        times = [a for column, a in row.entries.items() if column != MAKESPAN]
        is_limit = len(times) == len(row.entries)
        unit = (
            greatest_common_divisor(map(Fraction, times)) or Fraction(1) if is_limit else self.unit
        )
        entries = {c: a if c == MAKESPAN else a / unit for c, a in row.entries.items()}
        assert row.upper is not None
        return Row(row.name, entries, None, math.floor(row.upper / unit), row.dual)

    def _require_objective(
        self, found: vipr.Certificate, cost: dict[Column, Fraction | int]
    ) -> None:
        last = found.labels[0][0] if found.labels else 1
        unit = self.unit if self.objective == "makespan" else 1
        own = {self.place[column]: Fraction(c) * unit for column, c in cost.items() if c}
        stated = {j: Fraction(a, found.objective_under) for j, a in found.objective.items()}
        if not found.minimise or stated != own:
            raise vipr.RefusedError(last, f"before it, the objective is not the {self.objective}")

    def _require_implied(self, name: str, item: vipr.Constraint) -> None:
        """Refuse a constraint that the one of its name does not imply."""
        row = self._known.get(name) or self._cut(name)
        if row is None:
            raise CheckError(f"{name[:60]!r} is no row of the mission")
        side = Fraction(item.side, item.under)
        own = {self.place[column]: a for column, a in row.entries.items()}
        if item.sense == 0 and row.lower != row.upper:
            raise CheckError(f"{name[:60]!r} is no equation")
        for sense, end in ((1, row.lower), (-1, row.upper)):
            if item.sense == -sense:
                continue
            if end is None or sense * (side - end) > 0:
                allowed = "no such side" if end is None else f"{figure(Fraction(end))}"
                raise CheckError(
                    f"{name[:60]!r} has the side {figure(side)}; the mission: {allowed}"
                )
            for j in own.keys() | item.terms.keys():
                a = Fraction(item.terms.get(j, 0), item.under)
                if sense * (own.get(j, 0) - a) > 0:
                    raise CheckError(
                        f"{name[:60]!r} has {figure(a)} as coefficient of variable {j}; the mission: "
                        f"{figure(Fraction(own.get(j, 0)))}"
                    )

    def _cut(self, name: str) -> Row | None:
        """The cut of that name; ``None`` if it is not the name of one."""
        parts = _CUT.fullmatch(name)
        if parts is None:
            return None
        kind, robot, victim, members = (part for part in parts.groups() if part is not None)
        about = {
            "robot": int(robot),
            "victims": [int(v) for v in members.split(",") if v],
            "dual": 0,
            **({"victim": int(victim)} if victim else {}),
        }
        self.n_cuts += 1
        return cut_row(self.joint, repr(name[:60]), kind, CUTS[kind].model_validate(about))


def _word(*parts: str | int) -> str:
    """The name of a column or row, from what it is about."""
    return ":".join(quote(str(part), safe="").replace("%", "=") for part in parts)
