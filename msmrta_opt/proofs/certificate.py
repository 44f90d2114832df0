"""Writing a proof as a VIPR 1.0 certificate, from what a search has put down.

The order is the format's: the program, what is claimed, the solution, and the derivations. These are
the lemmas that are needed, then the tree from its leaves up, each constraint with the last one that
refers to it, so that a checker can forget it then; then the objective's grid.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import BinaryIO

from .derivation import LEMMA, Lemmas, Spool, number
from .exact import ExactProgram, Rational, Stated
from .grid import Grid
from .tree import Node


@dataclass(frozen=True)
class Cutoff:
    """An assumption that integer terms are less than a goal, to which the tree is a contradiction."""

    at: int
    """Reference of the lemma that assumes ``Σ terms ≤ goal - 1``."""
    goal: int
    terms: tuple[tuple[int, Rational], ...]
    unit: Rational
    """What 1 of the terms is worth in the objective."""
    besides: tuple[tuple[int, Rational], ...] = ()
    """What else the objective is made of: equations of the program, and their multipliers."""


@dataclass(frozen=True)
class Claim:
    """What a certificate says: of a minimisation, in the program's own sense when it is written."""

    infeasible: bool
    bound: Fraction | None = None
    """What the tree derives; ``None`` if no bound is proved."""
    proved: Fraction | None = None
    """What follows on the grid of the objective."""
    value: Fraction | None = None
    """Of the solution."""
    point: Sequence[Rational] | None = None
    cutoff: Cutoff | None = None
    """What the tree is a contradiction to, if it is one."""


def write(
    file: BinaryIO,
    program: ExactProgram,
    claim: Claim,
    root: Node | None,
    lemmas: Lemmas,
    spool: Spool,
    grid: Grid | None,
    comments: Sequence[str] = (),
) -> int:
    """Write the certificate; the number of its derivations."""
    for comment in comments:
        file.write(f"% {comment}\n".encode("ascii", "replace"))
    for text in _program(program):
        file.write(text.encode())
    file.write(_claimed(program, claim).encode())
    if root is None:
        file.write(b"DER 0\n")
        return 0
    return _Derivations(file, program, claim, root, lemmas, spool, grid).write()


def _program(program: ExactProgram) -> Iterator[str]:
    yield f"VER 1.0\nVAR {program.n_columns}\n"
    yield from (f"{name}\n" for name in program.names)
    whole = [str(j) for j, integer in enumerate(program.integer) if integer]
    yield f"INT {len(whole)}\n{' '.join(whole)}\n"
    stated = program.cost if program.objective is None else program.objective
    terms = [f"{j} {number(program.sign * c)}" for j, c in enumerate(stated) if c]
    yield f"OBJ {'min' if program.sign > 0 else 'max'}\n{len(terms)} {' '.join(terms)}\n"
    yield f"CON {len(program.stated)} {program.n_bounds}\n"
    yield from (f"{constraint(item)}\n" for item in program.stated)


def constraint(item: Stated) -> str:
    """A constraint in the format's words."""
    terms = "".join(f" {j} {number(a)}" for j, a in item.terms)
    return f"{item.name} {item.sense} {number(item.side)} {len(item.terms)}{terms}"


def _claimed(program: ExactProgram, claim: Claim) -> str:
    if claim.infeasible:
        return "RTP infeas\nSOL 0\n"
    ends = [
        "inf" if end is None else number(program.sign * end) for end in (claim.proved, claim.value)
    ]
    if program.sign > 0:
        low, high = ("-inf" if claim.proved is None else ends[0]), ends[1]
    else:
        low, high = ("-inf" if claim.value is None else ends[1]), ends[0]
    text = f"RTP range {low} {high}\n"
    if claim.point is None:
        return text + "SOL 0\n"
    values = [f"{j} {number(v)}" for j, v in enumerate(claim.point) if v]
    return f"{text}SOL 1\nsolution {len(values)} {' '.join(values)}\n"


class _Derivations:
    """The derivations of one certificate."""

    def __init__(
        self,
        file: BinaryIO,
        program: ExactProgram,
        claim: Claim,
        root: Node,
        lemmas: Lemmas,
        spool: Spool,
        grid: Grid | None,
    ) -> None:
        self.file = file
        self.program = program
        self.claim = claim
        self.root = root
        self.lemmas = lemmas
        self.spool = spool
        self.grid = grid
        self.sizes: dict[Node, int] = {}
        """How many derivations the tree below a node takes."""
        references = self._measure()
        if claim.cutoff is not None:
            references.add(claim.cutoff.at)
        self.needed = lemmas.needed(references | (grid.references if grid else set()))
        first = len(program.stated)
        self.place = {LEMMA + k: first + i for i, k in enumerate(self.needed)}
        self.next = first
        if claim.infeasible or claim.cutoff is not None:
            self.goal = "G 1 0"
        else:
            assert claim.bound is not None
            sense = "G" if program.sign > 0 else "L"
            self.goal = f"{sense} {number(program.sign * claim.bound)} OBJ"

    def write(self) -> int:
        """Write them all; how many they are."""
        on_grid = self.grid is not None and not self.claim.infeasible
        cutoff = self.claim.cutoff
        more = 2 * on_grid + 3 * (cutoff is not None)
        total = len(self.needed) + self.sizes[self.root] + more
        self.file.write(f"DER {total}\n".encode())
        for position in self.needed:
            self._lemma(position)
        end = self.next + self.sizes[self.root]
        self._tree(last_use=(end + 1 if cutoff is not None else end) if more else -1)
        if on_grid:
            self._grid()
        elif cutoff is not None:
            self._not_below(cutoff)
        return total

    def _measure(self) -> set[int]:
        """The number of derivations of each subtree; returns the lemmas that leaves refer to."""
        references: set[int] = set()
        waiting: list[tuple[Node, bool]] = [(self.root, False)]
        while waiting:
            node, done = waiting.pop()
            if node.leaf is not None:
                self.sizes[node] = 1
                references.update(at for at, _ in node.leaf.placeless)
            elif done:
                self.sizes[node] = 3 + sum(self.sizes[child] for child in _children(node))
            else:
                waiting.append((node, True))
                waiting += [(child, False) for child in _children(node)]
        return references

    def _put(self, text: str, last_use: int) -> int:
        """Write a derivation; its index."""
        self.file.write(f"d{self.next} {text} {last_use}\n".encode())
        self.next += 1
        return self.next - 1

    def _lemma(self, position: int) -> None:
        item = self.lemmas.items[position]
        terms = "".join(f" {j} {number(a)}" for j, a in item.terms)
        stated = f"{item.sense} {number(item.side)} {len(item.terms)}{terms}"
        reason = item.rule
        if reason == "uns":
            reason += "".join(f" {self.place.get(at, at)}" for at, _ in item.uses)
        elif reason != "asm":
            reason += f" {self._combination(item.uses)}"
        self._put(f"{stated} {{ {reason} }}", -1)

    def _tree(self, last_use: int) -> None:
        """The tree from its leaves up; its last constraint is used up to `last_use`."""
        goal, done = self.goal, []  # the indices of what was derived below
        assumed: list[int] = []  # by depth
        # A node is entered, then its low side is done, then its high side.
        waiting: list[tuple[Node, int, int]] = [(self.root, 0, last_use)]
        while waiting:
            node, step, used = waiting.pop()
            if node.leaf is not None:
                done.append(self._leaf(node, assumed, used))
                continue
            low, high = _children(node)
            end = self.next + self.sizes[node] - 1 if step == 0 else 0
            if step == 0:
                index = self._put(f"L {node.split} 1 {node.column} 1 {{ asm }}", end)
                assumed.append(index)
                waiting += [(node, 1, used), (low, 0, end)]
            elif step == 1:
                done.append(assumed.pop())
                end = self.next + self.sizes[high] + 1
                assumed.append(self._put(f"G {node.split + 1} 1 {node.column} 1 {{ asm }}", end))
                waiting += [(node, 2, used), (high, 0, end)]
            else:
                asm_high, high_index, asm_low, low_index = (
                    assumed.pop(), done.pop(), done.pop(), done.pop()
                )  # fmt: skip
                reason = f"uns {low_index} {asm_low} {high_index} {asm_high}"
                done.append(self._put(f"{goal} {{ {reason} }}", used))

    def _leaf(self, node: Node, assumed: list[int], last_use: int) -> int:
        leaf = node.leaf
        assert leaf is not None
        placed = "".join(
            f" {assumed[-at - 1] if at < 0 else self.place[at]} {text}"
            for at, text in leaf.placeless
        )
        words = (f"d{self.next} {self.goal} {{ lin {leaf.size}".encode(), self.spool.text(leaf))
        self.file.write(b"".join([*words, f"{placed} }} {last_use}\n".encode()]))
        self.next += 1
        return self.next - 1

    def _grid(self) -> None:
        """From the tree's bound to the next value of the grid."""
        grid, sign, claim = self.grid, self.program.sign, self.claim
        assert grid is not None
        assert claim.bound is not None
        assert claim.proved is not None
        rest = [(at, -left / grid.step) for at, left in grid.rest_above]
        reason = self._combination([(self.next - 1, sign / grid.step), *rest])
        whole = "".join(f" {j} {k}" for j, k in grid.whole)
        stated = f"G {grid.minimum(claim.bound)} {len(grid.whole)}{whole}"
        index = self._put(f"{stated} {{ rnd {reason} }}", self.next + 1)
        rest = [(at, sign * left) for at, left in grid.rest_below]
        reason = self._combination([(index, sign * grid.step), *rest])
        bound = number(sign * claim.proved)
        self._put(f"{'G' if sign > 0 else 'L'} {bound} OBJ {{ lin {reason} }}", -1)

    def _not_below(self, cutoff: Cutoff) -> None:
        """From the tree, a contradiction to the cutoff, to the bound on the objective."""
        tree, assumed = self.next - 1, self.place[cutoff.at]
        terms = "".join(f" {j} {number(a)}" for j, a in cutoff.terms)
        stated = f"G {cutoff.goal} {len(cutoff.terms)}{terms}"
        other = self._put(f"{stated} {{ asm }}", self.next + 1)
        index = self._put(f"{stated} {{ uns {tree} {assumed} {other} {other} }}", self.next + 1)
        reason = self._combination([(index, cutoff.unit), *cutoff.besides])
        self._put(f"G {number(self.claim.proved or 0)} OBJ {{ lin {reason} }}", -1)

    def _combination(self, uses: Sequence[tuple[int, Rational]]) -> str:
        words = [f" {self.place.get(at, at)} {number(weight)}" for at, weight in uses]
        return f"{len(uses)}{''.join(words)}"


def _children(node: Node) -> tuple[Node, Node]:
    assert node.low is not None
    assert node.high is not None
    return node.low, node.high
