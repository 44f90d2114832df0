r"""The linear relaxation of the joint problem, written out, and what dual values prove.

A robot's route visits no victim twice (no detour is shorter than the direct way), so it is a path; its
edges, ends, visits and services are the columns, all between 0 and 1, and every route satisfies the
rows of `proof`. For any dual values p of the rows, each of the sign that its row allows, no plan costs
less than

    Σ p b + Σ_j min(0, d_j) u_j,        d = c − A'p

(weak duality), b being the rows' sides, u_j the largest value of column j. All of it is added up in
fractions: no solver is asked, and nothing is rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations

from ..mission.errors import CheckError
from ..mission.proof import PathCut, RootProof, SubtourCut
from .joint_problem import Joint, figure

Column = tuple[str | int, ...]
"""``("y", robot, victim)``, ``f`` and ``l`` alike, ``("e", robot, i, j)`` with i < j,
``("a", robot, victim, kind)`` or ``("T",)``."""
MAKESPAN: Column = ("T",)
Named = Callable[..., tuple[str, Fraction]]
CUTS: Mapping[str, type[PathCut]] = {
    "subtour": SubtourCut,
    "outside": SubtourCut,
    "first": PathCut,
    "last": PathCut,
}
"""The kinds of cuts, and what each is about."""


@dataclass(frozen=True, eq=False)
class Row:
    """``lower ≤ Σ entries ≤ upper``, and its dual value; no side is ``None``."""

    name: str
    entries: Mapping[Column, Fraction | int]
    lower: Fraction | int | None
    upper: Fraction | int | None
    dual: Fraction


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Columns with costs and largest values (the smallest are 0), rows, and what all plans cost."""

    cost: Mapping[Column, Fraction | int]
    upper: Mapping[Column, Fraction | int]
    rows: tuple[Row, ...]
    offset: Fraction

    def bound(self) -> Fraction:
        """What the dual values prove.

        Raises
        ------
        CheckError
            If one has the wrong sign.
        """
        worth = self.offset
        reduced = {column: Fraction(cost) for column, cost in self.cost.items()}
        for row in self.rows:
            if not row.dual:
                continue
            side = row.lower if row.dual > 0 else row.upper
            if side is None:
                raise CheckError(
                    f"the dual value {figure(row.dual)} of {row.name} has the wrong sign"
                )
            worth += row.dual * side
            for column, weight in row.entries.items():
                reduced[column] -= row.dual * weight
        return worth + sum(d * self.upper[column] for column, d in reduced.items() if d < 0)


def relaxation(joint: Joint, proof: RootProof, worth: Fraction) -> Relaxation:
    """The relaxation of `joint` with the cuts and the dual values of `proof`.

    Parameters
    ----------
    joint : Joint
        The joint problem.
    proof : RootProof
        Which cuts there are, and the dual value of each row.
    worth : Fraction
        What a plan at hand is worth: no better one has a larger makespan.

    Raises
    ------
    CheckError
        If a dual value is of a row that there is not, or a cut is not one of the kinds that hold.
    """
    duals = _Duals(proof)
    cost, first = first_rows(joint, proof.objective, duals.of)
    rows = [*first, *_cuts(joint, proof)]
    if left := duals.left():
        raise CheckError(f"there is a dual value of {left}, which is no row of this problem")
    upper: dict[Column, Fraction | int] = {c: worth if c == MAKESPAN else 1 for c in cost}
    return Relaxation(cost, upper, tuple(rows), joint.offset(proof.objective))


def first_rows(
    joint: Joint, objective: str, named: Named
) -> tuple[dict[Column, Fraction | int], Iterator[Row]]:
    """The columns with their costs, and all rows that are not cuts.

    Parameters
    ----------
    joint : Joint
        The joint problem.
    objective : str
        Total time or makespan.
    named : callable
        Name and dual value of a row, from its kind and the ids that it is about.
    """
    loads = objective == "makespan" or joint.endurance is not None
    travel = _travel(joint)
    busy = dict(travel)
    if loads:
        busy |= {("a", r, v, k): joint.service[v, k] for r, v, k in joint.able}
    visits: dict[Column, Fraction | int] = {("y", r, v): 0 for r, v in joint.leave}
    if objective == "makespan":
        columns: set[Column] = {*visits, *busy, MAKESPAN}
        cost: dict[Column, Fraction | int] = {
            c: int(c == MAKESPAN) for c in sorted(columns, key=str)
        }
    else:
        cost = {**visits, **dict.fromkeys(busy, 0), **travel}

    def rows() -> Iterator[Row]:
        yield from _paths(joint, named)
        yield from _services(joint, named, loads=loads)
        yield from _limits(joint, named, travel, busy, objective)

    return cost, rows()


@dataclass
class _Duals:
    """The dual values of the rows that are not cuts, each to be asked for once."""

    proof: RootProof
    open: dict[tuple[str | int, ...], Fraction] = field(init=False)

    def __post_init__(self) -> None:
        self.open = {}
        for name in (
            "degree",
            "leaves",
            "ends",
            "served",
            "present",
            "walk",
            "endurance",
            "makespan",
        ):
            for item in getattr(self.proof, name):
                about = item.model_dump()
                dual = Fraction(about.pop("dual"))
                key = (name, *about.values())
                if key in self.open:
                    raise CheckError(f"the dual value of {_named(key)} is given twice")
                self.open[key] = dual

    def of(self, *key: str | int) -> tuple[str, Fraction]:
        """Name and dual value of a row."""
        return _named(key), self.open.pop(key, Fraction(0))

    def left(self) -> str:
        """The name of a row that nobody asked for, empty if there is none."""
        return next((_named(key) for key in self.open), "")


def _named(key: tuple[str | int, ...]) -> str:
    return f"row {key[0]}[{', '.join(map(str, key[1:]))}]"


def _travel(joint: Joint) -> dict[Column, Fraction]:
    time: dict[Column, Fraction] = {}
    for (r, v), way in joint.leave.items():
        time["f", r, v] = way
        time["l", r, v] = joint.back(r, v)
    return time | {("e", *key): way for key, way in joint.between.items()}


def _paths(joint: Joint, named: Named) -> Iterator[Row]:
    for r, victims in joint.victims_of.items():
        for v in victims:
            around: dict[Column, int] = {("f", r, v): 1, ("l", r, v): 1, ("y", r, v): -2}
            around |= {("e", r, *sorted((v, w))): 1 for w in victims if w != v}
            name, dual = named("degree", r, v)
            yield Row(name, around, 0, 0, dual)
        first: dict[Column, int] = {("f", r, v): 1 for v in victims}
        name, dual = named("leaves", r)
        yield Row(name, first, 0, 1, dual)
        name, dual = named("ends", r)
        yield Row(name, first | {("l", r, v): -1 for v in victims}, 0, 0, dual)


def _services(joint: Joint, named: Named, *, loads: bool) -> Iterator[Row]:
    able: dict[tuple[int, str], list[int]] = {
        requirement: [] for requirement in sorted(joint.service)
    }
    for r, v, k in sorted(joint.able):
        able[v, k].append(r)
    for (v, k), robots in able.items():
        name, dual = named("served", v, k)
        if not loads:
            yield Row(name, {("y", r, v): 1 for r in robots}, 1, None, dual)
            continue
        yield Row(name, {("a", r, v, k): 1 for r in robots}, 1, 1, dual)
        for r in robots:
            name, dual = named("present", r, v, k)
            yield Row(name, {("a", r, v, k): 1, ("y", r, v): -1}, None, 0, dual)


def _limits(
    joint: Joint,
    named: Named,
    travel: Mapping[Column, Fraction],
    busy: Mapping[Column, Fraction],
    objective: str,
) -> Iterator[Row]:
    for r in joint.robots:
        walked, used = (
            {column: time for column, time in times.items() if column[1] == r and time}
            for times in (travel, busy)
        )
        if r in joint.walk:
            name, dual = named("walk", r)
            yield Row(name, walked, None, joint.walk[r], dual)
        if joint.endurance is not None:
            name, dual = named("endurance", r)
            yield Row(name, used, None, joint.endurance, dual)
        if objective == "makespan":
            name, dual = named("makespan", r)
            yield Row(name, used | {MAKESPAN: Fraction(-1)}, None, 0, dual)


def _cuts(joint: Joint, proof: RootProof) -> Iterator[Row]:
    for kind in CUTS:
        cuts: Iterable[PathCut] = getattr(proof, kind)
        for number, cut in enumerate(cuts):
            yield cut_row(joint, f"cut {kind}[{number}]", kind, cut)


def cut_row(joint: Joint, name: str, kind: str, cut: PathCut) -> Row:
    """The row of a cut.

    Raises
    ------
    CheckError
        If it is not one that holds.
    """
    _require_valid(joint, name, kind, cut)
    return Row(name, _entries(joint, kind, cut), None, 0, Fraction(cut.dual))


def _require_valid(joint: Joint, name: str, kind: str, cut: PathCut) -> None:
    own = joint.victims_of.get(cut.robot)
    if own is None:
        raise CheckError(f"{name} is about robot {cut.robot}, which is not there")
    victims = set(cut.victims)
    if len(victims) < len(cut.victims):
        raise CheckError(f"{name} holds a victim twice")
    if not isinstance(cut, SubtourCut):
        about = victims
    else:
        about = victims | {cut.victim}
        if (cut.victim in victims) != (kind == "subtour"):
            where = "in" if kind == "subtour" else "outside"
            raise CheckError(f"{name} holds only for a victim {where} its set, not {cut.victim}")
    if strange := sorted(about - set(own)):
        raise CheckError(f"{name} holds victim {strange[0]}, which robot {cut.robot} cannot serve")


def _entries(joint: Joint, kind: str, cut: PathCut) -> dict[Column, int]:
    r, victims = cut.robot, sorted(cut.victims)
    row: dict[Column, int] = {("e", r, i, j): 1 for i, j in combinations(victims, 2)}
    row |= {("y", r, v): -1 for v in victims}
    if kind in ("first", "outside"):
        row |= {("f", r, v): 1 for v in victims}
    if kind in ("last", "outside"):
        row |= {("l", r, v): 1 for v in victims}
    if kind == "outside":
        for v in joint.victims_of[r]:
            row["f", r, v] = row.get(("f", r, v), 0) - 1
    if isinstance(cut, SubtourCut):
        row["y", r, cut.victim] = row.get(("y", r, cut.victim), 0) + 1
    return row
