"""Tampered certificates: whatever is changed, what is still accepted is true, by brute force."""

from __future__ import annotations

import random
import re
from collections import Counter
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.programs import INF, program
from support.vipr_oracle import refutation

from msmrta_opt.certify.vipr import RefusedError, verify
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.proofs.prove import prove_program

KEYWORDS = ("G", "L", "E", "asm", "lin", "rnd", "uns", "sol", "min", "max", "infeas", "range", "inf",
            "-inf", "OBJ")  # fmt: skip


def knapsack() -> Program:
    """A maximum that takes branching: three equal items of which one fits."""
    return program([[4, 4, 4, 3], [1, 1, 1, 1]], [7, 3], [5, 5, 5, 4], sense="max")


def covering() -> Program:
    """A minimum with ranges, a constant, a free sign and costs in thirds."""
    return program(
        [[2, 3, -1, 1], [1, -1, 2, 0]], [INF, 3], [2 / 3, 1, 5 / 3, -1 / 3],
        row_lower=[2.5, 1], lower=[0, 0, 0, -1], upper=[2, 2, 1, 1], offset=2.0,
    )  # fmt: skip


def odd_cycle() -> Program:
    """An infeasible one: of an odd cycle's nodes, more than half, no two of them neighbours."""
    return program(
        [*np.eye(3) + np.roll(np.eye(3), 1, axis=1), [1, 1, 1]], [1, 1, 1, 3], [1, 2, 3],
        row_lower=[-INF] * 3 + [2],
    )  # fmt: skip


def even() -> Program:
    """An infeasible one that rounding alone proves."""
    return program([[2, -2, 4]], [3], [1, 1, 1], row_lower=[3], upper=2)


PROGRAMS = (knapsack, covering, odd_cycle, even)


@cache
def certificate(which: int, folder: Path) -> list[str]:
    """The lines of the proof of a program."""
    given = PROGRAMS[which]()
    path = folder / f"proof{which}.vipr"
    proof = prove_program(given, solve_program(given), path, numbers=["binary"])
    assert proof.status in ("proved", "infeasible")
    return path.read_text().splitlines()


def _number(chance: random.Random, word: str) -> str:
    """Another number than `word`."""
    over, slash, under = word.partition("/")
    change = chance.randrange(5)
    if change == 0:
        return f"{int(over) + chance.choice([-1, 1])}{slash}{under}"
    if change == 1:
        return f"-{word}".replace("--", "")
    if change == 2:
        return f"{int(over) * chance.choice([2, 3])}{slash}{under}"
    return chance.choice(["0", "1", "-1", "2", "1/2", "1000000"])


def tampered(chance: random.Random, lines: list[str]) -> tuple[str, list[str]]:
    """What was done, and what came of it."""
    kind = chance.choice(["number", "number", "number", "word", "drop", "swap", "twice", "claim",
                          "count", "solution", "integers", "side"])  # fmt: skip
    new = list(lines)
    place = chance.randrange(1, len(new))
    words = new[place].split()
    if kind == "number":
        numeric = [i for i, word in enumerate(words) if re.fullmatch(r"-?\d+(/\d+)?", word)]
        if numeric:
            i = chance.choice(numeric)
            words[i] = _number(chance, words[i])
            new[place] = " ".join(words)
    elif kind == "word":
        named = [i for i, word in enumerate(words) if word in KEYWORDS]
        if named:
            words[chance.choice(named)] = chance.choice(KEYWORDS)
            new[place] = " ".join(words)
    elif kind == "drop":
        del new[place]
    elif kind == "swap":
        other = chance.randrange(1, len(new))
        new[place], new[other] = new[other], new[place]
    elif kind == "twice":
        new.insert(chance.randrange(1, len(new)), new[place])
    elif kind == "claim":
        place = next(i for i, line in enumerate(new) if line.startswith("RTP"))
        step = chance.choice(["1/3", "1", "-1", "-1/3"])
        ends = [f"{word}" for word in new[place].split()[2:]]
        if ends:
            i = chance.randrange(2)
            ends[i] = _sum(ends[i], step)
            new[place] = f"RTP range {' '.join(ends)}"
        else:
            new[place] = "RTP range 1 2"
    elif kind == "count":
        place = next(i for i, line in enumerate(new) if line.startswith("DER"))
        left = max(int(new[place].split()[1]) - chance.randint(1, 3), 0)
        del new[len(new) - (int(new[place].split()[1]) - left) :]
        new[place] = f"DER {left}"
    elif kind == "solution":
        place = next(i for i, line in enumerate(new) if line.startswith("SOL"))
        new[place : place + 2] = chance.choice(
            [["SOL 0"], ["SOL 1", "s 1 0 1"], ["SOL 2", new[place + 1], new[place + 1]]]
        )
    elif kind == "integers":
        place = next(i for i, line in enumerate(new) if line.startswith("INT"))
        whole = new[place + 1].split()
        new[place : place + 2] = [f"INT {len(whole) + 1}", " ".join([*whole, whole[0]])]
    elif kind == "side":
        derived = [i for i, line in enumerate(new) if "{" in line]
        place = chance.choice(derived)
        words = new[place].split()
        words[2] = _number(chance, words[2])
        new[place] = " ".join(words)
    return kind, new


def _sum(one: str, other: str) -> str:
    return one if "inf" in one else str(Fraction(one) + Fraction(other))


def refused(path: Path) -> RefusedError | None:
    """Why a certificate is refused, if it is."""
    try:
        verify(str(path))
    except RefusedError as refusal:
        return refusal
    return None


def accepted_ones_are_true(first: int, count: int, folder: Path) -> Counter[str]:
    """Tamper `count` times; how often each kind was refused or accepted, as ``kind verdict``."""
    seen: Counter[str] = Counter()
    path = folder / "tampered.vipr"
    for number in range(first, first + count):
        chance = random.Random(number)
        original = certificate(number % len(PROGRAMS), folder)
        kind, lines = tampered(chance, original)
        if lines == original:
            continue
        path.write_text("\n".join(lines) + "\n")
        refusal = refused(path)
        if refusal is None:
            assert refutation(path) == "", f"number {number}, {kind}:\n" + "\n".join(lines)
            seen[f"{kind} accepted"] += 1
        else:
            assert 1 <= refusal.line <= len(lines)
            assert refusal.reason
            seen[f"{kind} refused"] += 1
    return seen


def test_what_is_accepted_after_tampering_is_true(tmp_path: Path) -> None:
    seen = accepted_ones_are_true(0, 400, tmp_path)
    assert sum(count for kind, count in seen.items() if kind.endswith("refused")) > 250
    # Some changes make nothing false: a name, an unused bound, a weaker claim.
    assert sum(count for kind, count in seen.items() if kind.endswith("accepted")) > 5


@pytest.mark.slow
def test_what_is_accepted_after_thousands_of_tamperings_is_true(tmp_path: Path) -> None:
    seen = accepted_ones_are_true(400, 6000, tmp_path)
    assert sum(seen.values()) > 4000


@pytest.mark.parametrize("which", range(len(PROGRAMS)))
def test_each_derivation_is_needed(which: int, tmp_path: Path) -> None:
    lines = certificate(which, tmp_path)
    start = next(i for i, line in enumerate(lines) if line.startswith("DER"))
    for place in range(start + 1, len(lines)):
        left = [*lines[:start], f"DER {len(lines) - start - 2}", *lines[start + 1 : place],
                *lines[place + 1 :]]  # fmt: skip
        path = tmp_path / "left.vipr"
        path.write_text("\n".join(left) + "\n")
        with pytest.raises(RefusedError):
            verify(str(path))


@pytest.mark.parametrize("which", range(2))
def test_a_claim_beyond_what_is_derived_is_refused_at_the_last_line(
    which: int, tmp_path: Path
) -> None:
    lines = certificate(which, tmp_path)
    place = next(i for i, line in enumerate(lines) if line.startswith("RTP"))
    _, _, low, high = lines[place].split()
    maximise = any(line == "OBJ max" for line in lines)
    ends = (low, _sum(high, "-1/3")) if maximise else (_sum(low, "1/3"), high)
    # Without the solution, only the derivation decides.
    changed = [*lines[:place], f"RTP range {'-inf' if maximise else ends[0]} "
               f"{ends[1] if maximise else 'inf'}", "SOL 0", *lines[place + 3 :]]  # fmt: skip
    path = tmp_path / "beyond.vipr"
    path.write_text("\n".join(changed) + "\n")
    with pytest.raises(RefusedError, match="not the claimed bound") as refusal:
        verify(str(path))
    assert refusal.value.line == len(changed)
