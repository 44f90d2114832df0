"""A plan checker of the tests' own, on documents alone: nothing of the package is used.

Small and slow, in fractions. It says what is wrong with a plan, and what the best plan is worth, by
trying all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise, permutations, product
from typing import Any

Document = dict[str, Any]
Cell = tuple[int, int]

CLOSE = Fraction(1, 10**8)
"""Relative difference of times that is rounding."""
HALF = Fraction(1, 2)


def faults(plan: Document) -> list[str]:
    """What is wrong with a plan's document, one line each."""
    return list(_Checker(plan).faults())


def minimum(plan: Document, objective: str) -> Fraction | None:
    """What the best plan for the same problem is worth; ``None`` if limits allow none."""
    return _Checker(plan).minimum(objective)


def worth(plan: Document, objective: str) -> Fraction:
    """What a plan is worth, by its own times."""
    return _Checker(plan).worth(objective)


class _Checker:
    def __init__(self, plan: Document) -> None:
        self.plan, mission = plan, plan["instance"]
        self.free = {
            (r, c)
            for r, row in enumerate(mission["map"]["rows"])
            for c, char in enumerate(row)
            if char == "."
        }
        self.robots = {robot["id"]: robot for robot in mission["robots"]}
        self.victims = {victim["id"]: victim for victim in mission["victims"]}
        self.scouts = mission["scouts"]
        self.services = {k: Fraction(str(t)) for k, t in mission["service_time"].items()}
        scouting = plan["scouting"]
        self.hidden = set(scouting["not_found"]) if scouting else set()
        options = plan["options"] if plan["planner"] == "exact" else {}
        self.returns = bool(options.get("return_to_start"))
        self.walk, self.endurance = options.get("longest_walk"), options.get("endurance")
        self._steps: dict[Cell, dict[Cell, int]] = {}

    def steps(self, start: Cell) -> dict[Cell, int]:
        if start not in self._steps:
            found, border = {start: 0}, [start]
            for here in border:
                for beside in _beside(here):
                    if beside in self.free and beside not in found:
                        found[beside] = found[here] + 1
                        border.append(beside)
            self._steps[start] = found
        return self._steps[start]

    def service(self, victim: int, kind: str) -> Fraction:
        own = self.victims[victim]["service_time"]
        return Fraction(str(own[kind])) if kind in own else self.services[kind]

    def speed(self, robot: int) -> Fraction:
        return Fraction(str(self.robots[robot]["speed"]))

    def reach(self, robot: int, victim: int) -> int | None:
        cell = tuple(self.victims[victim]["cell"])
        return self.steps(tuple(self.robots[robot]["start"])).get(cell)

    def able(self, victim: int, kind: str) -> list[int]:
        """The robots that can serve a requirement within their limits, if nothing else."""
        ways = 2 if self.returns else 1
        return [
            r
            for r, robot in self.robots.items()
            if kind in robot["capabilities"]
            and (moves := self.reach(r, victim)) is not None
            and (self.walk is None or ways * moves <= self.walk)
            and self.in_time(ways * moves / self.speed(r) + self.service(victim, kind))
        ]

    def in_time(self, busy: Fraction) -> bool:
        return self.endurance is None or busy <= Fraction(str(self.endurance)) * (1 + CLOSE)

    # The plan

    def faults(self) -> Iterator[str]:
        served: list[tuple[int, str]] = []
        names = [route["robot"] for route in self.plan["routes"]]
        if len(set(names)) < len(names) or not set(names) <= set(self.robots):
            yield f"routes of {names}"
        for route in self.plan["routes"]:
            yield from self.route(route, served)
        for victim in self.victims.values():
            for kind in victim["requirements"]:
                yield from self.requirement(victim["id"], kind, served)
        listed = [(item["victim"], item["kind"]) for item in self.plan["unserved"]]
        every = {(v, k) for v, victim in self.victims.items() for k in victim["requirements"]}
        if not set(listed) | set(served) <= every or len(set(listed)) < len(listed):
            yield "serves or lists what nobody needs, or lists it twice"
        yield from self.scouting()
        yield from self.clusters()

    def route(self, route: Document, served: list[tuple[int, str]]) -> Iterator[str]:
        robot, clock = self.robots[route["robot"]], Fraction(0)
        here = start = tuple(robot["start"])
        n_moves = 0
        for visit in route["visits"]:
            v = visit["victim"]
            if v not in self.victims or v in self.hidden:
                yield f"robot {robot['id']} visits {v}"
                return
            yield from self.leg(visit["cells"], here, tuple(self.victims[v]["cell"]))
            here, n_moves = tuple(visit["cells"][-1]), n_moves + len(visit["cells"]) - 1
            clock += (len(visit["cells"]) - 1) / self.speed(robot["id"])
            if not _same(visit["arrival"], clock):
                yield f"robot {robot['id']} at {v} at {visit['arrival']}, not {float(clock)}"
            for kind in visit["served"]:
                served.append((v, kind))
                if kind not in robot["capabilities"] or kind not in self.victims[v]["requirements"]:
                    yield f"robot {robot['id']} serves {kind} at {v}"
                    return
                clock += self.service(v, kind)
            if not _same(visit["departure"], clock):
                yield f"robot {robot['id']} leaves {v} at {visit['departure']}"
        if route["back"]:
            yield from self.leg(route["back"], here, start)
            n_moves, here = n_moves + len(route["back"]) - 1, start
            clock += (len(route["back"]) - 1) / self.speed(robot["id"])
        if self.returns and here != start:
            yield f"robot {robot['id']} does not return"
        if (self.walk is not None and n_moves > self.walk) or not self.in_time(clock):
            yield f"robot {robot['id']} goes beyond its limits"

    def leg(self, cells: list[list[int]], start: Cell, end: Cell) -> Iterator[str]:
        walk = [tuple(cell) for cell in cells]
        if walk[0] != start or walk[-1] != end or not set(walk) <= self.free:
            yield f"no walk from {start} to {end}"
        if any(b not in _beside(a) for a, b in pairwise(walk)):
            yield "a jump"

    def requirement(self, v: int, kind: str, served: list[tuple[int, str]]) -> Iterator[str]:
        reasons = [
            item["reason"]
            for item in self.plan["unserved"]
            if (item["victim"], item["kind"]) == (v, kind)
        ]
        if served.count((v, kind)) + len(reasons) != 1:
            yield f"{kind} at {v} is served {served.count((v, kind))} times"
        if reasons:
            capable = [r for r, robot in self.robots.items() if kind in robot["capabilities"]]
            true = "within limits"
            if v in self.hidden:
                true = "not found by the scouts"
            elif not capable:
                true = "no robot has it"
            elif all(self.reach(r, v) is None for r in capable):
                true = "no capable robot can reach it"
            elif not self.able(v, kind):
                true = "beyond the robots'"
            if not reasons[0].startswith(true):
                yield f"{kind} at {v} is {true}, not {reasons[0]}"

    # Scouts and clusters

    def scouting(self) -> Iterator[str]:
        report = self.plan["scouting"]
        if report is None:
            if self.scouts and self.plan["planner"] != "by hand":
                yield "the scouts stayed at home"
            return
        tracks = {track["scout"]: [tuple(c) for c in track["cells"]] for track in report["tracks"]}
        if sorted(tracks) != sorted(scout["id"] for scout in self.scouts):
            yield f"tracks of {sorted(tracks)}"
            return
        unseen = {v: tuple(victim["cell"]) for v, victim in self.victims.items()}
        finds = {}
        for step in range(len(next(iter(tracks.values())))):
            for scout in self.scouts:
                here = tracks[scout["id"]][step]
                for v, cell in list(unseen.items()):
                    if self.sees(here, cell, scout["visual_field_depth"]):
                        finds[v] = (scout["id"], step)
                        del unseen[v]
        for scout in self.scouts:
            track = tracks[scout["id"]]
            if track[0] != tuple(scout["start"]) or not set(track) <= self.free:
                yield f"scout {scout['id']} is where it cannot be"
            if any(
                b not in _beside(a) and (a != b or self.can_move(a)) for a, b in pairwise(track)
            ):
                yield f"scout {scout['id']} jumps"
        if sorted(report["not_found"]) != sorted(unseen):
            yield f"not found: {report['not_found']}, in truth {sorted(unseen)}"
        if {f["victim"]: (f["scout"], f["step"]) for f in report["finds"]} != finds:
            yield f"finds: {report['finds']}, in truth {finds}"

    def can_move(self, cell: Cell) -> bool:
        return any(beside in self.free for beside in _beside(cell))

    def sees(self, here: Cell, there: Cell, depth: int) -> bool:
        """The line between the centres meets no wall's inside and no corner between two walls."""
        down, right = there[0] - here[0], there[1] - here[1]
        if max(abs(down), abs(right)) > depth:
            return False
        box = product(
            range(min(here[0], there[0]), max(here[0], there[0]) + 1),
            range(min(here[1], there[1]), max(here[1], there[1]) + 1),
        )
        walls = [cell for cell in box if cell not in self.free]
        spans = {cell: _span(here, (down, right), cell) for cell in walls}
        if any(low < high for low, high in spans.values()):
            return False
        touched = [(low, cell) for cell, (low, high) in spans.items() if low == high]
        return not any(
            t == u and abs(a[0] - b[0]) == 1 and abs(a[1] - b[1]) == 1
            for (t, a), (u, b) in product(touched, touched)
        )

    def clusters(self) -> Iterator[str]:
        clusters = self.plan["clusters"]
        if not clusters:
            return
        members = sorted(v for cluster in clusters for v in cluster["victims"])
        if members != sorted(set(self.victims) - self.hidden):
            yield f"clusters of {members}"
            return
        for cluster in clusters:
            cells = [tuple(self.victims[v]["cell"]) for v in cluster["victims"]]
            for axis in (0, 1):
                mean = Fraction(sum(cell[axis] for cell in cells), len(cells))
                if abs(Fraction(cluster["centre"][axis]) - mean) > Fraction(1, 10**6):
                    yield f"centre {cluster['centre']}"
            steps = self.steps(tuple(cluster["cell"]))
            if not set(cells) & set(steps) or not set(cluster["robots"]) <= set(self.robots):
                yield f"cluster {cluster}"
            for v, cell in zip(cluster["victims"], cells, strict=True):
                straight = sum(abs(a - b) for a, b in zip(cell, cluster["cell"], strict=True))
                if (steps.get(cell) != straight) != (v in cluster["deferred"]):
                    yield f"deferred {cluster['deferred']}"

    # What plans are worth

    def worth(self, objective: str) -> Fraction:
        busy, done = [], dict.fromkeys(self.victims, Fraction(0))
        for route in self.plan["routes"]:
            clock, speed = Fraction(0), self.speed(route["robot"])
            for visit in route["visits"]:
                clock += (len(visit["cells"]) - 1) / speed
                clock += sum(self.service(visit["victim"], kind) for kind in visit["served"])
                if visit["served"]:
                    done[visit["victim"]] = max(done[visit["victim"]], clock)
            busy.append(clock + max(len(route["back"]) - 1, 0) / speed)
        return self.value(objective, busy, done)

    def value(self, objective: str, busy: list[Fraction], done: dict[int, Fraction]) -> Fraction:
        if objective == "total_time":
            return sum(busy, Fraction(0))
        if objective == "makespan":
            return max(busy, default=Fraction(0))
        weight = {v: Fraction(str(victim["priority"])) for v, victim in self.victims.items()}
        return sum((weight[v] * time for v, time in done.items()), Fraction(0))

    def minimum(self, objective: str) -> Fraction | None:
        tasks = {
            (v, kind): able
            for v, victim in self.victims.items()
            if v not in self.hidden
            for kind in victim["requirements"]
            if (able := self.able(v, kind))
        }
        best: Fraction | None = None
        for who in product(*tasks.values()):
            mine: dict[int, dict[int, Fraction]] = {r: {} for r in self.robots}
            for (v, kind), r in zip(tasks, who, strict=True):
                mine[r][v] = mine[r].get(v, Fraction(0)) + self.service(v, kind)
            every = [list(self.orders(r, load)) for r, load in mine.items()]
            for chosen in product(*every):
                done: dict[int, Fraction] = {}
                for _, own in chosen:
                    for v, time in own.items():
                        done[v] = max(done.get(v, time), time)
                value = self.value(objective, [busy for busy, _ in chosen], done)
                best = value if best is None else min(best, value)
        return best

    def orders(
        self, robot: int, load: dict[int, Fraction]
    ) -> Iterator[tuple[Fraction, dict[int, Fraction]]]:
        """When a robot is done, and each of its victims, by every order within its limits."""
        start, speed = tuple(self.robots[robot]["start"]), self.speed(robot)
        for order in permutations(load):
            here, clock, n_moves = start, Fraction(0), 0
            done = {}
            for v in order:
                cell = tuple(self.victims[v]["cell"])
                moves = self.steps(here)[cell]
                n_moves, clock, here = n_moves + moves, clock + moves / speed + load[v], cell
                done[v] = clock
            if self.returns and order:
                n_moves += self.steps(here)[start]
                clock += self.steps(here)[start] / speed
            if (self.walk is None or n_moves <= self.walk) and self.in_time(clock):
                yield clock, done


def _beside(cell: Cell) -> list[Cell]:
    row, col = cell
    return [(row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)]


def _same(said: float, true: Fraction) -> bool:
    return abs(Fraction(said) - true) <= CLOSE * true


def _span(here: Cell, way: tuple[int, int], wall: Cell) -> tuple[Fraction, Fraction]:
    """From when to when the line is on a wall's square, its border included; none if first > last."""
    low, high = Fraction(0), Fraction(1)
    for start, step, centre in zip(here, way, wall, strict=True):
        ends = (centre - HALF - start, centre + HALF - start)
        if step == 0:
            if not ends[0] < 0 < ends[1]:
                return Fraction(1), Fraction(0)
        else:
            first, last = sorted(Fraction(end) / step for end in ends)
            low, high = max(low, first), min(high, last)
    return low, high
