"""Certificates of formulations, files and cvxpy problems, and of which program they are."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from scipy.sparse import csr_array
from support.programs import INF, program

import msmrta_opt as mo
from msmrta_opt.mission.errors import CheckError, InputError, ModelError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.subject import subject
from msmrta_opt.proofs.stated import differences


def small() -> Program:
    return program([[1, 2], [0.1, -1]], [3, INF], [0.7, 1], row_lower=[-INF, -0.3], offset=0.5)


def test_a_cvxpy_problem_is_proved_with_its_parameters(tmp_path: Path) -> None:
    # Knapsack of weights 2, 3, 3, 4 and room 15/2, the rest worth a half a unit: 5 + 6 and 1/4.
    x, rest = cp.Variable(4, boolean=True), cp.Variable(nonneg=True)
    worth = cp.Parameter(4, value=[3.0, 5, 4, 6])
    room = cp.sum(cp.multiply([2, 3, 3, 4], x)) + rest <= 7.5
    problem = cp.Problem(cp.Maximize(worth @ x + rest / 2), [room])
    proof = mo.prove(problem, path=tmp_path / "proof.vipr")
    assert (proof.status, proof.value, proof.bound) == ("proved", 11.25, 11.25)
    assert mo.check_proof(proof.path, problem) == "maximum in [45/4, 45/4] (about 11.25)"
    worth.value = [3.0, 5, 4, 7]
    with pytest.raises(CheckError, match="objective's coefficient"):
        mo.check_proof(proof.path, problem)


def test_what_is_no_linear_program_is_refused(tmp_path: Path) -> None:
    x = cp.Variable(2)
    with pytest.raises(ModelError, match="not a linear"):
        mo.prove(cp.Problem(cp.Minimize(cp.sum_squares(x))), path=tmp_path / "p.vipr")
    with pytest.raises(InputError, match="no value"):
        mo.prove(cp.Problem(cp.Minimize(cp.Parameter() * x[0])), path=tmp_path / "p.vipr")
    with pytest.raises(InputError, match="give a formulation"):
        mo.prove(7, path=tmp_path / "p.vipr")  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".mps", ".lp"])
def test_the_decimals_of_a_file_are_what_is_proved(tmp_path: Path, suffix: str) -> None:
    # 0.1 x = 0.3 y, as decimals: x = 3, y = 1.
    given = program([[0.1, -0.3]], [0.0], [-1, 0], row_lower=[0.0], upper=5)
    mo.write_program(given, tmp_path / f"given{suffix}")
    proof = mo.prove(tmp_path / f"given{suffix}", path=tmp_path / "proof.vipr")
    assert (proof.status, proof.value, proof.numbers) == ("proved", -3, "decimal")
    assert "1/10" in Path(proof.path).read_text()
    assert mo.check_proof(proof.path, tmp_path / f"given{suffix}") == "minimum in [-3, -3]"


@pytest.mark.parametrize("model", ["victim_balanced", "cluster_fair", "joint_assignment"])
def test_a_formulation_is_proved_and_is_recognised_coefficient_by_coefficient(
    paper: Instance, tmp_path: Path, model: str
) -> None:
    stage = mo.model(model).spec.stage
    data = mo.stage_data(paper, stage)
    proof = mo.prove(model, data, path=tmp_path / "proof.vipr")
    assert proof.status == "proved"
    assert proof.value == pytest.approx(mo.solve(model, data).objective)
    mo.check_proof(proof.path, model, data)
    other = mo.stage_data(paper.replace(victims=paper.victims[:-1], clusters=None), stage)
    with pytest.raises(CheckError, match=f"it is not of {model}"):
        mo.check_proof(proof.path, model, other)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"sense": "max"}, "it is a minimum, the program is not"),
        ({"cost": np.array([0.7, 1 + 2.0**-50])}, r"objective's coefficient of x\[1\]"),
        ({"offset": 0.25}, "objective's coefficient of objective_constant"),
        ({"integer": np.array([True, False])}, r"x\[1\] is integer in the certificate"),
        ({"upper": np.array([1.0, 2.0])}, r"upp:x\[1\] is <= 1, not <= 2"),
        ({"upper": np.array([1.0, INF])}, r"1 x\[1\] <= 1 is not in the program"),
        ({"row_upper": np.array([3.0, 7.0])}, "row_1:upp is missing"),
        (
            {"matrix": csr_array([[1, 2], [0.1 + 2.0**-50, -1]])},
            r"row_1 has 0\.1, not 0\.1000000\d+, as coefficient of x\[0\]",
        ),
        ({"row_lower": np.array([-INF, -0.3 - 2.0**-50])}, r"row_1 is >= -0\.3, not >= -0\.300"),
    ],
)
def test_every_number_of_the_program_is_compared(
    tmp_path: Path, change: dict[str, Any], what: str
) -> None:
    path = tmp_path / "proof.vipr"
    mo.prove(small(), path=path)
    mo.check_proof(path, small())
    with pytest.raises(CheckError, match=what):
        mo.check_proof(path, replace(small(), **change))


def test_a_certificate_by_someone_else_may_have_another_order_and_other_numerals(
    tmp_path: Path,
) -> None:
    # min x + 2 y over 2 x + 2 y ≥ 3, both whole and ≥ 0; with y first, and its bounds as rows.
    given = program([[2, 2]], [INF], [1, 2], row_lower=[3], upper=INF)
    path = tmp_path / "other.vipr"
    path.write_text(
        "VER 1.0\nVAR 2\nx[1] x[0]\nINT 2\n1 0\nOBJ min\n2 0 2.0 1 3/3\nCON 3 0\n"
        "a G 3.00 2 0 2 1 4/2\nb G 0 1 1 1\nc G 0 1 0 1\nRTP range 2 2\nSOL 1\ns 1 1 2\n"
        "DER 2\nd G 2 2 0 1 1 1 { rnd 1 0 1/2 } 4\ne G 2 OBJ { lin 2 3 1 2 1 } -1\n"
    )
    assert mo.check_proof(path, given) == "minimum in [2, 2]"


def test_an_unreadable_or_refused_certificate_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        mo.check_proof(tmp_path / "none.vipr")
    path = tmp_path / "bad.vipr"
    path.write_text("VER 1.0\nVAR x\n")
    with pytest.raises(CheckError, match=r"bad.vipr: line 2: 'x' where the number of variables"):
        mo.check_proof(path)


def test_differences_are_told_one_by_one() -> None:
    given = subject(small()).program
    from msmrta_opt.certify.vipr import Certificate, Constraint

    found = Certificate(
        names=["x[0]", "x[1]", "objective_constant"], integer={0, 1, 2},
        objective={0: 7, 1: 10, 2: 5}, objective_under=10,
        constraints=[Constraint(1, {0: 1}, 0)], labels=[(9, "low:x[0]")],
    )  # fmt: skip
    wrong = differences(given, found)
    # As floats both are 0.7.
    assert f"the objective's coefficient of x[0] is 7/10, not {Fraction(0.7)}" in wrong[0]
    assert "upp:x[0] is missing" in wrong
