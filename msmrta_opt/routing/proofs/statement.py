"""The edge formulation in exact numbers, with the names that `certify.joint_proof` expects.

Times are whole multiples of their greatest common divisor, so all numbers of rows are integers; the
objective is stated in time units, all service included.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property
from urllib.parse import quote

import numpy as np

from ...mission.exact import exact, greatest_common_divisor
from ...mission.instance import Instance
from ...proofs.exact import ExactProgram, Row, Stated
from ..branch_and_cut.edge_formulation import EdgeFormulation
from ..branch_and_cut.points import point_of
from ..branch_and_cut.root_proof import about_cut, about_rows
from ..branch_and_cut.separation import Cut
from ..problem import Routes

OFFSET = "service"
"""Name of the variable that is 1, with all service as its cost."""


class Statement:
    """The program that a certificate is about. Cuts are added as they are found.

    Parameters
    ----------
    formulation : EdgeFormulation
        The joint problem.
    instance : Instance
        With the known victims, in the order of the formulation's data.
    """

    def __init__(self, formulation: EdgeFormulation, instance: Instance) -> None:
        self.formulation = formulation
        self.instance = instance
        self.is_makespan = formulation.objective.only_last
        times = [t for t, is_time in zip(self._times, self._counts, strict=True) if is_time]
        self.unit = greatest_common_divisor(times) or Fraction(1)
        """What is 1, in time units."""
        self.offset = Fraction(0)
        """What every plan costs besides, in time units; a variable that is 1 has it as its cost."""
        data = formulation.data
        if not self.is_makespan:
            self.offset = sum(map(exact, data.service[data.required].tolist()), Fraction(0))
        self.besides: tuple[tuple[int, Fraction], ...] = ()
        """Index of the constraint that this variable is 1, and the offset; nothing if that is 0."""
        self.places: dict[Cut, int] = {}
        """Index of the constraint that states a cut."""
        self.units: list[Fraction] = []
        """What is 1 in each of the formulation's rows, in its own unit."""
        self.program = self._program()

    # Numbers.

    @cached_property
    def _times(self) -> list[Fraction]:
        """Travel or service time of each column, in time units."""
        formulation = self.formulation
        data, start = formulation.data, formulation.start
        times = [Fraction(0)] * formulation.n_columns
        speeds = [exact(speed) for speed in data.speed.tolist()]
        for name, table in (("f", data.leave), ("l", data.back)):
            for pair, (r, v) in enumerate(formulation.pairs.tolist()):
                times[start(name) + pair] = _way(
                    float(table[r, v]), float(data.speed[r]), speeds[r]
                )
        for edge, (r, i, j) in enumerate(formulation.edges.tolist()):
            length = data.length[r if len(data.length) > 1 else 0, i, j]
            times[start("e") + edge] = exact(float(length)) / speeds[r]
        for n, (pair, kind) in enumerate(formulation.services.tolist()):
            victim = formulation.pairs[pair, 1]
            times[start("a") + n] = exact(float(data.service[victim, kind]))
        return times

    @cached_property
    def _counts(self) -> list[bool]:
        """Whether the time of each column adds to the objective."""
        is_time = np.ones(self.formulation.n_columns, dtype=bool)
        if not self.is_makespan:
            start = self.formulation.start("a")
            is_time[start : start + len(self.formulation.services)] = False
        return [bool(x) for x in is_time]

    def value(self, routes: Routes) -> int:
        """The objective of `routes`, in units, without the offset."""
        return int(self.program.value(self.point(routes)))

    def time(self, value: int) -> Fraction:
        """A value in units as one of the plan's objective, in time units."""
        return self.offset + self.unit * value

    def point(self, routes: Routes) -> list[int]:
        """The variables' values on `routes`."""
        point = [round(x) for x in point_of(self.formulation, routes).tolist()]
        if self.is_makespan:
            busy = [0] * self.formulation.data.n_robots
            for r, x, time in zip(self.formulation.robot, point, self._times, strict=True):
                if r >= 0 and x:
                    busy[r] += int(time / self.unit)
            point[self.formulation.start("T")] = max(busy, default=0)
        return [*point, 1] if self.offset else point

    # Constraints.

    def _program(self) -> ExactProgram:
        formulation = self.formulation
        n = formulation.n_columns
        last = formulation.start("T") if self.is_makespan else -1
        if self.is_makespan:
            cost = [Fraction(int(j == last)) for j in range(n)]
        else:
            cost = [
                t / self.unit if counts else Fraction(0)
                for t, counts in zip(self._times, self._counts, strict=True)
            ]
        names = self._names()
        lower: list[int | Fraction | None] = [0] * n
        upper: list[int | Fraction | None] = [None if j == last else 1 for j in range(n)]
        found = ExactProgram(1, names, [True] * n, cost, lower, upper, [], [], [], [])
        found.objective = [c * self.unit for c in cost]
        for j, name in enumerate(names):
            found.at_lower.append(len(found.stated))
            found.stated.append(Stated(f"low:{name}", "G", 0, ((j, 1),)))
            found.at_upper.append(-1 if j == last else len(found.stated))
            if j != last:
                found.stated.append(Stated(f"upp:{name}", "L", 1, ((j, 1),)))
        if self.offset:
            self._add_offset(found)
        found.n_bounds = len(found.stated)
        matrix, row_lower, row_upper = formulation.rows
        for i, (name, about) in enumerate(about_rows(self.instance, formulation)):
            ends = slice(matrix.indptr[i], matrix.indptr[i + 1])
            columns, weights = matrix.indices[ends].tolist(), matrix.data[ends].tolist()
            sides = (float(row_lower[i]), float(row_upper[i]))
            row, unit = self._row(name, about, columns, weights, sides)
            self._state(found, row, _word(name, *about.values()))
            self.units.append(unit)
        return found

    def _add_offset(self, program: ExactProgram) -> None:
        """The variable that is 1, last: of the stated objective alone."""
        assert program.objective is not None
        at = len(program.stated)
        self.besides = ((at, self.offset),)
        program.stated.append(Stated(f"fix:{OFFSET}", "E", 1, ((program.n_columns, 1),)))
        program.names.append(OFFSET)
        program.integer.append(True)
        program.cost.append(Fraction(0))
        program.objective.append(self.offset)
        program.lower.append(1)
        program.upper.append(1)
        program.at_lower.append(at)
        program.at_upper.append(at)

    def _row(
        self,
        name: str,
        about: dict[str, int | str],
        columns: list[int],
        weights: list[float],
        sides: tuple[float, float],
    ) -> tuple[Row, Fraction]:
        """A row in whole numbers, and what 1 is in it."""
        if name not in ("walk", "endurance", "makespan"):
            low, high = (int(side) if math.isfinite(side) else None for side in sides)
            return Row(columns, [int(w) for w in weights], low, high), Fraction(1)
        times = [self._times[j] for j in columns]
        if name == "makespan":
            whole = [
                int(t / self.unit) if w > 0 else -1 for t, w in zip(times, weights, strict=True)
            ]
            return Row(columns, whole, None, 0), self.unit
        unit = greatest_common_divisor(times) or Fraction(1)
        whole = [int(t / unit) for t in times]
        return Row(columns, whole, None, self._limit(name, about, unit)), unit

    def _limit(self, name: str, about: dict[str, int | str], unit: Fraction) -> int:
        """The largest multiple of `unit` that a robot's limit allows."""
        robot = [r.id for r in self.instance.robots].index(int(about["robot"]))
        data = self.formulation.data
        limit = data.endurance[robot] if name == "endurance" else data.longest_walk[robot]
        return math.floor(Fraction(float(limit)) / unit)

    def _state(self, program: ExactProgram, row: Row, name: str) -> Row:
        """Put `row` into the program."""
        terms = tuple(zip(row.columns, row.coefficients, strict=True))
        equation = row.lower is not None and row.lower == row.upper
        # A side that bounds imply is not used.
        if row.lower is not None and (equation or row.lower > 0):
            row.at_lower = len(program.stated)
            program.stated.append(Stated(name, "E" if equation else "G", row.lower, terms))
        else:
            row.lower = None
        if row.upper is not None:
            row.at_upper = row.at_lower if equation else len(program.stated)
            if not equation:
                program.stated.append(Stated(name, "L", row.upper, terms))
        program.rows.append(row)
        return row

    def add(self, cut: Cut, keep: np.ndarray | None = None) -> Row:
        """State a cut, if `keep` is given without those of its positive terms that it does not hold.

        Parameters
        ----------
        cut : Cut
            Not stated yet.
        keep : bool array, shape (n_columns,), optional
            Columns that are not known to be 0.
        """
        columns, weights, _ = self.formulation.cut_row(cut)
        if keep is not None:
            kept = keep[columns] | (weights < 0)
            columns, weights = columns[kept], weights[kept]
        kind, about = about_cut(self.instance, cut)
        members = ",".join(map(str, about["victims"]))
        victim = [str(about["victim"])] if "victim" in about else []
        name = ":".join([kind, str(about["robot"]), *victim, members])
        row = Row(columns.tolist(), [round(w) for w in weights.tolist()], None, 0)
        self.places[cut] = len(self.program.stated)
        return self._state(self.program, row, name)

    # Names.

    def _names(self) -> list[str]:
        formulation, instance = self.formulation, self.instance
        robots, victims = [r.id for r in instance.robots], [v.id for v in instance.victims]
        names = [""] * formulation.n_columns
        for pair, (r, v) in enumerate(formulation.pairs.tolist()):
            for name in "yfl":
                names[formulation.start(name) + pair] = _word(name, robots[r], victims[v])
        for n, (pair, kind) in enumerate(formulation.services.tolist()):
            r, v = formulation.pairs[pair]
            word = _word("a", robots[r], victims[v], instance.capabilities[kind])
            names[formulation.start("a") + n] = word
        if self.is_makespan:
            names[formulation.start("T")] = "T"
        for edge, (r, i, j) in enumerate(formulation.edges.tolist()):
            ends = sorted((victims[i], victims[j]))
            names[formulation.start("e") + edge] = _word("e", robots[r], *ends)
        return names


def _word(*parts: str | int) -> str:
    return ":".join(quote(str(part), safe="").replace("%", "=") for part in parts)


def _way(time: float, speed: float, exactly: Fraction) -> Fraction:
    """The time of a way of a robot of that speed, which is a whole number of cells in a mission."""
    cells = round(time * speed)
    if abs(cells - time * speed) <= 1e-9 * max(1, cells):
        return cells / exactly
    return exact(time)
