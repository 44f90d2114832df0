"""Tampered plan files: what makes a claim false is refused, and nothing ends in a traceback.

Numbers, names and lists of honest files are changed at random. Whether the claim still holds is decided
by the tests' own checker, which tries all plans.
"""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support import small_checker

from msmrta_opt import cli
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan

Document = dict[str, Any]
Place = tuple[list[Any] | Document, int | str]

INSTANCES = Path(__file__).parents[2] / "instances"
QUICK, LARGE = 200, 2_000
NUMBERS = (0, 1, -1, 2, 0.5, 1e-9, 1e9, 1e300, -1e300, 10**30, 7.25, True, None, "x", [], {})
NOT_JSON = ("NaN", "Infinity", "-Infinity", "1e999", "9" * 5000, "[" * 3000 + "]" * 3000)
CLAIMS = Fraction(1, 10**6)


@cache
def honest() -> tuple[Document, ...]:
    """Plans of every kind, small enough to try all others."""
    calls: tuple[tuple[str, Document], ...] = (
        ("corridor", {"planner": "exact"}),
        ("corridor", {"planner": "exact", "objective": "latency"}),
        ("split", {"planner": "exact", "objective": "makespan"}),
        ("two_rooms", {"planner": "exact"}),
        ("scouted", {"planner": "exact", "objective": "latency"}),
        ("scouted", {}),
        ("two_rooms", {}),
    )
    return tuple(
        json.loads(
            json.dumps(plan(Instance.read(INSTANCES / f"{name}.json"), **options).document())
        )
        for name, options in calls
    )


def places(value: Any) -> Iterator[Place]:
    """Every place in a document that holds something."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, inner in items:
        yield value, key
        if isinstance(inner, (dict, list)):
            yield from places(inner)


def tampered(number: int) -> str:
    """The text of a tampered file."""
    chance = random.Random(f"tampering {number}")
    document = copy.deepcopy(chance.choice(honest()))
    mark = "tampered with"
    for _ in range(chance.choice([1, 1, 1, 2, 4])):
        part = chance.choice(["routes", "unserved", "scouting", "clusters", *["certificates"] * 3])
        inner = document.get(part)
        there = list(places(inner)) if isinstance(inner, (dict, list)) else []
        holder, key = chance.choice(there or [(document, part)])
        kind = chance.random()
        old = holder.get(key) if isinstance(holder, dict) else holder[key]  # type: ignore[index]
        if kind < 0.35 and isinstance(old, (int, float)) and not isinstance(old, bool):
            new: Any = old * chance.choice([0.5, 0.999, 1.001, 2, -1]) + chance.choice([0, 0, 1])
            holder[key] = int(new) if isinstance(old, int) else new  # type: ignore[index]
        elif kind < 0.75:
            holder[key] = chance.choice(NUMBERS)  # type: ignore[index]
        elif kind < 0.85:
            holder[key] = mark  # type: ignore[index]
        elif kind < 0.95 and isinstance(old, list) and old:
            chance.choice([old.pop, old.reverse, lambda old=old: old.append(old[0])])()
        elif isinstance(holder, dict):
            holder.pop(key, None)
    return json.dumps(document).replace(f'"{mark}"', chance.choice(NOT_JSON))


def is_false(text: str) -> bool:
    """Whether the claims of a file that was accepted do not hold."""
    document = json.loads(text)
    document = {"unserved": [], "scouting": None, "clusters": [], "options": {}} | document
    if small_checker.faults(document):
        return True
    for claim in document.get("certificates", []):
        if claim["stage"] != "joint problem":
            continue
        worth = small_checker.worth(document, claim["model"])
        best = small_checker.minimum(document, claim["model"]) or Fraction(0)
        slack = CLAIMS * worth
        bound, said = Fraction(claim["bound"] or 0), claim["objective"]
        if abs(Fraction(said) - worth) > slack or bound > best + slack:
            return True
        if claim["status"] == "optimal" and worth > best + slack:
            return True
    return False


def run_all(numbers: range, folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What is not as it should be."""
    wrong = []
    for number in numbers:
        text = tampered(number)
        file = folder / "plan.json"
        file.write_text(text)
        bound = ["--bound", "--strict"] if '"planner": "exact"' in text else []
        status = cli.run(["check", str(file), *bound])
        told = capsys.readouterr().err
        if status == 0 and is_false(text):
            wrong.append(f"{number}: a false claim is believed")
        if status not in (0, 1, 2):
            wrong.append(f"{number}: exit status {status}")
        if status and (not told or not all(str(file) in line for line in told.splitlines())):
            wrong.append(f"{number}: {told!r}")
    return wrong


def test_no_false_claim_is_believed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_all(range(QUICK), tmp_path, capsys) == []


@pytest.mark.slow
def test_no_false_claim_of_many_is_believed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_all(range(QUICK, LARGE), tmp_path, capsys) == []


def test_the_honest_files_are_accepted_and_some_tampered_ones_are_not_noticed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise the test above would be about nothing: not every change makes a claim false."""
    for number, document in enumerate(honest()):
        file = tmp_path / f"{number}.json"
        file.write_text(json.dumps(document))
        bound = ["--bound"] if document["planner"] == "exact" else []
        assert cli.run(["check", str(file), *bound]) in (0, 3)
        assert capsys.readouterr().err == ""
    texts = [tampered(number) for number in range(60)]
    statuses = []
    for text in texts:
        (tmp_path / "plan.json").write_text(text)
        statuses.append(cli.run(["check", str(tmp_path / "plan.json")]))
    capsys.readouterr()
    assert {0, 1, 2} <= set(statuses)


# Large numbers in proofs, by hand.

CHANGES: dict[str, Callable[[Document], None]] = {
    "a time step that is next to nothing": lambda proof: proof["time_steps"][0].update(
        length=1e-300
    ),
    "a time step of a short binary fraction": lambda proof: proof["time_steps"][0].update(
        length=2.0**-40
    ),
    "a dual value that is huge": lambda proof: proof["rounds"][0]["tasks"][0].update(dual=1e300),
    "a breakpoint that is huge": lambda proof: proof["rounds"][0].update(
        breakpoints=[{"victim": 0, "times": [1e300]}]
    ),
}


@pytest.mark.parametrize("name", CHANGES)
def test_numbers_that_are_too_large_to_count_with_get_one_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = copy.deepcopy(honest()[1])
    proof = {
        "bound": 12.0,
        "solver": "by hand",
        "time_steps": [{"robot": 0, "length": 1.0}],
        "rounds": [
            {
                "tasks": [
                    {"victim": v, "kinds": ["FirstAids"], "dual": dual, "densities": [1.0]}
                    for v, dual in ((0, 7.0), (1, 9.0))
                ]
            }
        ],
    }
    document["certificates"][0].update(pricing=proof, proof="column generation")
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(document))
    assert cli.run(["check", str(file), "--bound"]) == 0
    capsys.readouterr()
    CHANGES[name](proof)
    file.write_text(json.dumps(document))
    assert cli.run(["check", str(file), "--bound"]) == 1
    assert capsys.readouterr().err.count("\n") == 1
