"""The checker of VIPR 1.0 against the format's specification; certificates and values by hand."""

from __future__ import annotations

import os
import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest

from msmrta_opt.certify import vipr
from msmrta_opt.certify.vipr import RefusedError, verify


def certificate(
    *,
    version: str = "VER 1.0",
    variables: str = "VAR 2\nx y",
    integer: str = "INT 2\n0 1",
    objective: str = "OBJ min\n2 0 1 1 1",
    constraints: str = "CON 3 2\nx G 0 1 0 1\ny G 0 1 1 1\nC1 G 3 2 0 2 1 2",
    claim: str = "RTP range 2 2",
    solutions: str = "SOL 1\nbest 2 0 1 1 1",
    derivations: str = "DER 1\nD1 G 2 OBJ { rnd 1 2 1/2 } -1",
) -> str:
    """By default: min x + y over 2 x + 2 y ≥ 3, x, y ≥ 0 and whole. The minimum is 2."""
    sections = [version, variables, integer, objective, constraints, claim, solutions, derivations]
    return "\n".join(sections) + "\n"


@pytest.fixture
def checked(tmp_path: Path):
    """Check a certificate's text."""

    def check(text: str) -> vipr.Certificate:
        path = tmp_path / "proof.vipr"
        path.write_bytes(text.encode())
        return verify(str(path))

    return check


# Under x ≤ 0 the row gives y ≥ 3/2, so 2; under x ≥ 1 a quarter of it gives x + y ≥ 5/4, so 2.
SPLIT_ON_X = """DER 6
A1 L 0 1 0 1 { asm } -1
A2 G 1 1 0 1 { asm } -1
D1 G 2 1 1 1 { rnd 2 2 1/2 3 -1 } -1
D2 G 2 OBJ { lin 2 0 1 5 1 } -1
D3 G 2 OBJ { rnd 3 2 1/4 4 1/2 1 1/2 } -1
D4 G 2 OBJ { uns 6 3 7 4 } -1"""
# min -x over x ≤ 5/2, whole: the minimum is -2. Without a lower bound on x.
UNBOUNDED_BELOW = {
    "variables": "VAR 1\nx",
    "integer": "INT 1\n0",
    "objective": "OBJ min\n1 0 -1",
    "constraints": "CON 1 1\nx L 5/2 1 0 1",
    "claim": "RTP range -2 -2",
    "solutions": "SOL 1\nbest 1 0 2",
    "derivations": "DER 1\nD1 G -2 OBJ { rnd 1 0 -1 } -1",
}
# max 3 x + 2 y over 2 x + 2 y ≤ 5, x ≤ 1, whole and ≥ 0: x = y = 1, so 5. Half the row rounds to
# x + y ≤ 2; twice that and the bound of x give 3 x + 2 y ≤ 5.
MAXIMUM = {
    "objective": "OBJ max\n2 0 3 1 2",
    "constraints": "CON 4 3\nx G 0 1 0 1\ny G 0 1 1 1\nX L 1 1 0 1\nC1 L 5 2 0 2 1 2",
    "claim": "RTP range 5 5",
    "solutions": "SOL 1\nbest 2 0 1 1 1",
    "derivations": "DER 2\nD1 L 2 2 0 1 1 1 { rnd 1 3 1/2 } 5\nD2 L 5 OBJ { lin 2 4 2 2 1 } -1",
}
# x and y continuous, x + y = 3/2, min 2 x + 2 y: 3, by an equation alone, whatever its sign.
EQUATION = {
    "integer": "INT 0",
    "objective": "OBJ min\n2 0 2 1 2",
    "constraints": "CON 1 0\nC1 E 3/2 2 0 1 1 1",
    "claim": "RTP range 3 3",
    "solutions": "SOL 1\nbest 1 0 3/2",
    "derivations": "DER 1\nD1 G 3 OBJ { lin 1 0 2 } -1",
}
# 2 x = 1 has no whole solution: x ≤ 1/2 rounds to x ≤ 0, and so 0 ≥ 1.
INFEASIBLE = {
    "objective": "OBJ min\n0",
    "constraints": "CON 1 0\nC1 E 1 1 0 2",
    "claim": "RTP infeas",
    "solutions": "SOL 0",
    "derivations": "DER 3\n"
    "D1 L 1/2 1 0 1 { lin 1 0 1/2 } 2\n"
    "D2 L 0 1 0 1 { rnd 1 1 1 } 3\n"
    "D3 G 1 0 { lin 2 0 1 2 -2 } -1",
}


@pytest.mark.parametrize(
    ("parts", "claim"),
    [
        ({}, "minimum in [2, 2]"),
        ({"version": "% a comment\n%another, 1 VER\nVER 1.0"}, "minimum in [2, 2]"),
        ({"variables": "VAR 2 x\n\n  y\t"}, "minimum in [2, 2]"),
        ({"claim": "RTP range 2 inf", "solutions": "SOL 0"}, "minimum in [2, inf)"),
        ({"claim": "RTP range -inf 3", "derivations": "DER 0"}, "minimum in (-inf, 3]"),
        ({"claim": "RTP range -inf inf", "derivations": "DER 0"}, "minimum in (-inf, inf)"),
        ({"claim": "RTP range 3/2 2.50"}, "minimum in [3/2, 5/2] (about 1.5 to 2.5)"),
        ({"derivations": SPLIT_ON_X}, "minimum in [2, 2]"),
        (MAXIMUM, "maximum in [5, 5]"),
        ({**MAXIMUM, "claim": "RTP range -inf 5", "solutions": "SOL 0"}, "maximum in (-inf, 5]"),
        ({**MAXIMUM, "claim": "RTP range 5 inf", "derivations": "DER 0"}, "maximum in [5, inf)"),
        (UNBOUNDED_BELOW, "minimum in [-2, -2]"),
        (EQUATION, "minimum in [3, 3]"),
        (INFEASIBLE, "infeasible"),
        ({"solutions": "SOL 2\nworse 1 0 5\nbest 2 0 1 1 1"}, "minimum in [2, 2]"),
        ({"integer": "INT 3\n1 0 1"}, "minimum in [2, 2]"),
        ({"constraints": "CON 3 0\nx G 0 1 0 1\ny G 0 1 1 1\nC1 G 3 2 0 2 1 2"}, "minimum in [2, 2]"),
    ],
)  # fmt: skip
def test_a_true_certificate_is_accepted(checked, parts, claim) -> None:
    assert checked(certificate(**parts)).claim == claim


@pytest.mark.parametrize(
    "derivation",
    [
        # Rationals in every place: sides, coefficients, multipliers; decimals and fractions.
        "D1 G 3/4 2 0 0.5 1 1/2 { lin 1 2 0.25 } -1\nD2 G 2 OBJ { rnd 1 2 1/2 } -1",
        "D1 G 6/8 2 0 2/4 1 .5 { lin 1 2 1/4 } -1\nD2 G 1.75 OBJ { rnd 1 2 .5 } -1",
        "D1 G 3/4 2 0 5/10 1 1. { lin 2 2 1/4 1 0.5 } -1\nD2 G 2 OBJ { rnd 1 2 5/10 } -1",
        # A multiplier of 0, and a coefficient of 0, change nothing.
        "D1 G 0 1 0 1 { lin 2 0 1 2 0 } -1\nD2 G 2 2 0 1 1 1 { rnd 1 2 1/2 } -1",
        # No multipliers give 0 = 0.
        "D1 E 0 0 { lin 0 } -1\nD2 G 2 OBJ { rnd 1 2 1/2 } -1",
        "D1 G -1 1 1 0 { lin 0 } -1\nD2 G 2 OBJ { rnd 1 2 1/2 } -1",
        # A derivation over several lines, and the last index that refers to a constraint.
        "D1 G 3/2\nOBJ {\n lin 1\n2 1/2 }\n4\nD2 G 2 OBJ { rnd 1 3 1 } 0",
        # What is derived may be stronger than what is stated.
        "D1 G 1 OBJ { lin 1 2 1/2 } 3\nD2 G 2 OBJ { rnd 1 2 1/2 } -1",
    ],
)
def test_rationals_and_layout_are_as_the_specification_has_them(checked, derivation) -> None:
    text = certificate(claim="RTP range 3/2 2", derivations=f"DER 2\n{derivation}")
    assert checked(text).best == 2


def test_an_absurdity_dominates_everything(checked) -> None:
    # 2 x = 1 again, now as a minimum that is said to be at least a million.
    parts = {**INFEASIBLE, "claim": "RTP range 1000000 inf", "objective": "OBJ min\n1 1 7"}
    assert checked(certificate(**parts)).claim == "minimum in [1000000, inf)"


@pytest.mark.parametrize("side", ["L -1", "E 1/3", "E -2", "G 1"])
def test_each_absurdity_proves_infeasibility(checked, side) -> None:
    parts = {**INFEASIBLE, "constraints": f"CON 1 0\nC1 {side} 0"}
    parts["derivations"] = f"DER 1\nD1 {side} 0 {{ lin 1 0 1 }} -1"
    assert checked(certificate(**parts)).infeasible


def test_an_assumption_that_is_not_discharged_proves_nothing(checked) -> None:
    derivations = "DER 2\nA1 G 7 OBJ { asm } -1\nD1 G 2 OBJ { lin 1 3 1 } -1"
    with pytest.raises(RefusedError, match="only if constraint 3 holds"):
        checked(certificate(derivations=derivations))


def test_a_split_takes_away_the_assumption_of_each_side_only_from_that_side(checked) -> None:
    assert checked(certificate(derivations=SPLIT_ON_X.replace("uns 6 3 7 4", "uns 7 4 6 3")))
    with pytest.raises(RefusedError, match="only if constraint 3 holds"):
        checked(certificate(derivations=SPLIT_ON_X.replace("uns 6 3 7 4", "uns 6 4 7 3")))


def test_a_multiplier_of_0_makes_nothing_depend_on_an_assumption(checked) -> None:
    derivations = "DER 2\nA1 L 0 1 0 1 { asm } -1\nD1 G 2 OBJ { rnd 2 2 1/2 3 0 } -1"
    assert checked(certificate(derivations=derivations))


def test_a_solution_cuts_off_what_is_no_better(checked) -> None:
    # x + y ≤ 1 and 2 x + 2 y ≥ 3 contradict each other, so there is nothing better than 2.
    derivations = "DER 2\nS L 1 OBJ { sol } 4\nD1 G 2 OBJ { lin 2 2 1 3 -2 } -1"
    assert checked(certificate(derivations=derivations)).best == 2
    with pytest.raises(RefusedError, match="gives no such cutoff"):
        checked(certificate(derivations=derivations.replace("S L 1 OBJ", "S L 0 OBJ")))


def test_a_cutoff_is_by_less_than_one_where_the_objective_is_no_integer(checked) -> None:
    half = {"objective": "OBJ min\n2 0 1/2 1 1/2", "claim": "RTP range 1 1"}
    cutoff = "DER 2\nS L {} OBJ {{ sol }} -1\nD1 G 1 OBJ {{ rnd 1 2 1/2 }} -1"
    with pytest.raises(RefusedError, match="gives no such cutoff"):
        checked(certificate(**half, derivations=cutoff.format(0)))
    with pytest.raises(RefusedError, match="constraint 4 by rnd"):  # the cutoff itself stands
        checked(certificate(**half, derivations=cutoff.format(1)))


def test_a_maximum_is_cut_off_from_below(checked) -> None:
    parts = {**MAXIMUM, "derivations": "DER 1\nS {} {} OBJ {{ sol }} -1"}
    for sense, side in (("L", 5), ("L", 4), ("G", 7)):
        text = certificate(**parts).format(sense, side)
        with pytest.raises(RefusedError, match="gives no such cutoff"):
            checked(text)
    with pytest.raises(RefusedError, match="not the claimed bound"):  # true, but no upper bound
        checked(certificate(**parts).format("G", 6))


def refused(parts: dict[str, str], line: int, reason: str) -> object:
    return pytest.param(parts, line, reason, id=reason)


@pytest.mark.parametrize(
    ("parts", "line", "reason"),
    [
        refused({"version": "VER 1.1"}, 1, "'1.1' where 1.0 should be"),
        refused({"version": "VER 1.0\n% late"}, 2, "'%' where VAR"),
        refused({"variables": "VAR 3\nx y"}, 4, "'2' where INT"),
        refused({"variables": "VAR 2\nx\nx"}, 4, "a second variable is called 'x'"),
        refused({"variables": "VAR -1"}, 2, "-1 for the number of variables"),
        refused({"variables": "VAR 2.0 x y"}, 2, "an integer"),
        refused({"variables": "VAR 1_0 x y"}, 2, "an integer"),
        refused({"integer": "INT 1\n2"}, 5, "variable 2, where there are 2"),
        refused({"integer": "INT 1\n-1"}, 5, "variable -1, where"),
        refused({"objective": "OBJ minimise\n0"}, 6, "'minimise' where min or max"),
        refused({"objective": "OBJ min\n1 0 1/0"}, 7, "a fraction"),
        refused({"objective": "OBJ min\n1 0 1/-2"}, 7, "a fraction"),
        refused({"objective": "OBJ min\n1 0 1e3"}, 7, "an integer"),
        refused({"objective": "OBJ min\n1 0 ."}, 7, "an integer"),
        refused({"objective": "OBJ min\n1 0 1.-5"}, 7, "a decimal"),
        refused({"objective": "OBJ min\n1 0 inf"}, 7, "an integer"),
        refused({"objective": "OBJ min\n1 0 +1"}, 7, "an integer"),
        refused({"objective": "OBJ min\n1 0 ²"}, 7, "an integer"),
        refused({"objective": "OBJ min\n2 0 1 0 1"}, 7, "variable 0 occurs twice"),
        refused({"constraints": "CON 1 2\nC1 G 3 2 0 2 1 2"}, 8, "2 of 1 constraints"),
        refused({"constraints": "CON 1 1\nC1 G 3 2 0 2 1 2"}, 9, "constraint 0 is no bound"),
        refused({"constraints": "CON 1 0\nC1 N 3 2 0 2 1 2"}, 9, "'N' where E or L or G"),
        refused({"constraints": "CON 1 0\nC1 G 3 -2 0 2 1 2"}, 9, "-2 for the number of coeff"),
        refused({"claim": "RTP"}, 13, "'SOL' where infeas or range"),
        refused({"claim": "RTP range 3 2"}, 12, "lower bound is above"),
        refused({"claim": "RTP range inf inf"}, 12, "'inf' where the lower bound"),
        refused({"claim": "RTP range 1 1"}, 14, "the value 2, outside"),
        refused({"claim": "RTP range 2.01 3"}, 14, "the value 2, outside"),
        refused({"claim": "RTP infeas"}, 14, "is feasible, where infeasibility"),
        refused({"solutions": "SOL 0"}, 13, "no solution is given"),
        refused({"solutions": "SOL 1\nbest 2 0 3/2 1 1"}, 14, "no integer for variable 0"),
        refused({"solutions": "SOL 1\nbest 1 0 1"}, 14, "does not satisfy constraint 2"),
        refused({"solutions": "SOL 1\nbest 2 0 3 1 -1"}, 14, "does not satisfy constraint 1"),
        refused({"solutions": "SOL 2\na 2 0 1 1 1\nb 1 0 1"}, 15, "'b' does not satisfy"),
        refused({"derivations": "DER 0"}, 15, "nothing is derived"),
        refused({"derivations": "DER 2\nD1 G 2 OBJ { rnd 1 2 1/2 } -1"}, 16, "the file ends"),
        refused({"derivations": "DER 0\nD1 G 2 OBJ { rnd 1 2 1/2 } -1"}, 16, "after the last"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { lin 1 2 1/2 } -1"}, 16, ">= 3/2, which does"),
        refused({"derivations": "DER 1\nD1 G 3 OBJ { rnd 1 2 1/2 } -1"}, 16, ">= 2, which does"),
        refused({"derivations": "DER 1\nD1 L 2 OBJ { rnd 1 2 1/2 } -1"}, 16, ">= 2, which does"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { rnd 1 2 1/4 } -1"}, 16, "no integer"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { lin 1 3 1 } -1"}, 16, "is not before it"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { lin 1 -1 1 } -1"}, 16, "is not before it"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { lin 2 2 1 2 1 } -1"}, 16, "two multipliers"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { lin 2 2 1 0 -1 } -1"}, 16, "sign of the"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { rnd 1 2 1 } -1"}, 16, "has 2, not 1"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { weak } -1"}, 16, "'weak' where asm"),
        refused({"derivations": "DER 1\nD1 G 0 0x { lin 0 } -1"}, 16, "'0x' where the number of"),
        refused(
            {"derivations": "DER 2\nD1 G 2 OBJ { rnd 1 2 1/2 } -1\nnonsense"}, 17, "the file ends"
        ),
        refused({"claim": "RTP range -inf 2", "derivations": "DER 1\nnonsense"}, 16, "file ends"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { sol } -1"}, 16, "gives no such cutoff"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { rnd 1 2 1/2 } -2"}, 16, "-2 for the last"),
        refused({"derivations": "DER 1\nD1 G 2 OBJ { rnd 1 2 1/2 -1"}, 16, "'-1' where }"),
        refused(
            {**EQUATION, "derivations": "DER 1\nD1 G 3 OBJ { rnd 1 0 2 } -1"}, 13, "an equation"
        ),
        refused({**EQUATION, "derivations": "DER 1\nD1 G 4 OBJ { lin 1 0 2 } -1"}, 13, "is = 3"),
        refused({"integer": "INT 1 0"}, 15, "variable 1 is not integer"),
        refused({**MAXIMUM, "claim": "RTP range 4 4"}, 15, "the value 5, outside"),
        refused({**MAXIMUM, "claim": "RTP range 6 6"}, 15, "the value 5, outside"),
    ],
)
def test_what_does_not_hold_is_refused_at_its_line(checked, parts, line, reason) -> None:
    with pytest.raises(RefusedError, match=reason.replace("(", r"\(")) as refusal:
        checked(certificate(**parts))
    assert refusal.value.line == line


@pytest.mark.parametrize(
    ("before", "after", "reason"),
    [
        ("A2 G 1 1 0 1", "A2 G 2 1 0 1", "not ≤ β and ≥ β"),
        ("uns 6 3 7 4", "uns 6 3 7 2", "not ≤ and ≥ of the same"),
        ("A2 G 1 1 0 1", "A2 E 1 1 0 1", "not ≤ and ≥ of the same"),
        ("A1 L 0 1 0 1", "A1 E 0 1 0 1", "not ≤ and ≥ of the same"),
        ("D4 G 2 OBJ", "D4 G 3 OBJ", "constraint 6 is >= 2"),
        ("uns 6 3 7 4", "uns 6 3 2 4", "constraint 2 has 2, not 1"),
        ("uns 6 3 7 4", "uns 6 3 8 4", "is not before it"),
    ],
)
def test_a_split_is_a_disjunction_of_whole_numbers(checked, before, after, reason) -> None:
    assert before in SPLIT_ON_X
    with pytest.raises(RefusedError, match=reason):
        checked(certificate(derivations=SPLIT_ON_X.replace(before, after)))


@pytest.mark.parametrize(
    ("low", "high", "integer", "reason"),
    [
        ("L 1/2 1 0 1", "G 3/2 1 0 1", "INT 2\n0 1", "not ≤ β and ≥ β"),  # x = 1 is in neither
        ("L 0 1 0 1/2", "G 1 1 0 1/2", "INT 2\n0 1", "no integer"),  # and here
        ("L 0 1 0 1", "G 1 1 0 1", "INT 1\n1", "variable 0 is not integer"),
    ],
)
def test_a_split_that_leaves_points_out_is_refused(checked, low, high, integer, reason) -> None:
    derivations = (
        f"DER 3\nA1 {low} {{ asm }} -1\nA2 {high} {{ asm }} -1\nD G 0 1 0 1 {{ uns 0 3 0 4 }} -1"
    )
    with pytest.raises(RefusedError, match=reason):
        checked(certificate(integer=integer, derivations=derivations))


def test_a_constraint_is_forgotten_after_the_last_index_that_is_said_to_refer_to_it(
    checked,
) -> None:
    derivations = (
        "DER 3\nD1 G 3/2 OBJ { lin 1 2 1/2 } 4\nD2 G 2 OBJ { rnd 1 3 1 } -1\n"
        "D3 G 2 OBJ { rnd 1 3 1 } -1"
    )
    with pytest.raises(RefusedError, match="constraint 5 refers to constraint 3, which was not to"):
        checked(certificate(derivations=derivations))
    assert checked(certificate(derivations=derivations.replace("} 4", "} 5")))


def test_numbers_may_be_longer_than_python_reads_by_itself(checked) -> None:
    big = "9" * 6000
    text = certificate(derivations=f"DER 2\nD1 G {big} OBJ {{ asm }} -1\n"
                       "D2 G 2 OBJ { rnd 1 2 1/2 } -1")  # fmt: skip
    assert checked(text)
    with pytest.raises(RefusedError, match="200000 digits"):
        checked(certificate(objective=f"OBJ min\n1 0 {'9' * 200_000}"))
    with pytest.raises(RefusedError, match="a word of more than"):
        checked(certificate(variables=f"VAR 2\n{'x' * 2_100_000} y"))


@pytest.mark.parametrize(
    ("digits", "told"),
    [(20, "(about 2.85714286e+19)"), (400, "…"), (5000, "a number of over 1000 digits")],
)
def test_claims_of_any_size_are_told(checked, digits, told) -> None:
    n = f"1{'0' * digits}"
    parts = {**EQUATION, "constraints": f"CON 1 0\nC1 E {n}/7 2 0 1 1 1"}
    parts["claim"] = f"RTP range 2{n[1:]}/7 2{n[1:]}/7"
    parts["solutions"] = f"SOL 1\nbest 1 0 {n}/7"
    parts["derivations"] = f"DER 1\nD1 G 2{n[1:]}/7 OBJ {{ lin 1 0 2 }} -1"
    claim = checked(certificate(**parts)).claim
    assert told in claim
    assert len(claim) < 200


def test_a_long_proof_takes_no_more_memory_than_a_short_one(tmp_path: Path) -> None:
    def peak(length: int) -> int:
        path = tmp_path / "long.vipr"
        lines = (
            f"D{i} G 3/2 OBJ {{ lin 1 {i - 1 if i > 3 else 2} {'1' if i > 3 else '1/2'} }} {i + 1}\n"
            for i in range(3, length)
        )
        head = certificate(derivations=f"DER {length - 2}")
        path.write_text(f"{head}{''.join(lines)}D G 2 OBJ {{ rnd 1 {length - 1} 1 }} 0\n")
        tracemalloc.start()
        verify(str(path))
        _, maximum = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return maximum

    # Whatever is kept of a line takes more than ten bytes.
    assert peak(2000) - peak(500) < 10 * 1500


def test_the_checker_is_a_program_that_needs_nothing_but_python(tmp_path: Path) -> None:
    script, good, bad = tmp_path / "check.py", tmp_path / "good.vipr", tmp_path / "bad.vipr"
    script.write_bytes(Path(vipr.__file__).read_bytes())
    good.write_text(certificate())
    bad.write_text(certificate(claim="RTP range 1 1"))

    def run(*paths: Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-I", "-S", str(script), *map(str, paths)]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)

    fine = run(good)
    assert fine.returncode == 0
    assert f"{good}: proved: minimum in [2, 2]" in fine.stdout
    both = run(bad, good)
    assert both.returncode == 1
    assert f"{bad}: refused: line 14: " in both.stdout
    assert run(tmp_path / "none.vipr").returncode == 2
    assert "usage" in run().stderr


def test_what_is_not_a_regular_file_is_not_opened(tmp_path: Path) -> None:
    """Nobody writes to the pipe: opening it would wait for ever."""
    pipe = tmp_path / "pipe.vipr"
    os.mkfifo(pipe)
    for path in (pipe, tmp_path):
        with pytest.raises(OSError, match="not a regular file"):
            vipr.verify(str(path))


def test_the_checker_is_under_six_hundred_lines() -> None:
    assert len(Path(vipr.__file__).read_text(encoding="utf-8").splitlines()) < 600
