"""Proofs of plans: what they prove is true by brute force, and nothing false passes their check."""

from __future__ import annotations

import contextlib
import hashlib
import random
import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.amounts import sample
from support.joint_cases import MAPS
from support.joint_oracle import minimum

from msmrta_opt.certify.certificates import claim_problems
from msmrta_opt.certify.joint_proof import check_joint_proof
from msmrta_opt.certify.vipr import verify
from msmrta_opt.mission.errors import CheckError, InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.planners.support.explicit_model import problem_of
from msmrta_opt.planners.support.improvement import routes_of
from msmrta_opt.planners.support.plan_proof import prove_plan, with_proof
from msmrta_opt.proofs.relaxation import Relaxed
from msmrta_opt.proofs.stated import check_proof
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation
from msmrta_opt.routing.objectives import objective_of
from msmrta_opt.routing.proofs.priorities import binding_first
from msmrta_opt.routing.proofs.statement import Statement

OBJECTIVES = ("total_time", "makespan")
BRANCHED = 2
"""A seed of a mission whose makespan takes branching."""


def mission(seed: int) -> Instance:
    """Two or three robots and a few victims on a map with walls."""
    n_robots, n_victims = (3, 7) if seed == BRANCHED else (2 + seed % 2, 4)
    grid = read_map(MAPS / "map2.map")
    return generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False)


def optimum(seed: int, objective: str, **limits: object) -> Plan:
    """A best plan, by the exact planner."""
    made = make_plan(mission(seed), planner="exact", objective=objective, time_limit=60, **limits)
    assert made.certificates[0].status == "optimal"
    return made


@cache
def branched() -> Plan:
    """A plan whose proof has a tree and cuts."""
    return optimum(BRANCHED, "makespan")


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The proof of `branched`."""
    path = tmp_path_factory.mktemp("proof") / "proof.vipr"
    proof = prove_plan(branched(), path=path)
    assert proof.status == "proved"
    assert proof.leaves > 1
    return path.read_text().splitlines()


def refusal(lines: list[str], plan: Plan, tmp_path: Path) -> str:
    """Why the lines are no proof of the plan."""
    path = tmp_path / "tampered.vipr"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(CheckError) as refused:
        check_joint_proof(path, plan)
    return str(refused.value).removeprefix(f"{path}: ")


def place(lines: list[str], holds: Callable[[str], bool]) -> int:
    """The first line that is so."""
    return next(i for i, line in enumerate(lines) if holds(line))


LIMITS: dict[str, dict[str, object]] = {
    "open": {},
    "returning": {"return_to_start": True},
    "limited": {"endurance": 650.0, "longest_walk": 90.0},
}


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS)
@pytest.mark.parametrize("seed", sample(range(25), 2))
def test_the_best_value_is_proved_and_it_is_that_of_brute_force(
    seed: int, limits: dict[str, object], objective: str, tmp_path: Path
) -> None:
    made = optimum(seed, objective, **limits)
    proof = prove_plan(made, path=tmp_path / "proof.vipr")
    assert proof.status == "proved", proof.summary
    assert proof.exact_bound is not None
    best = minimum(problem_of(made), objective)
    assert float(proof.exact_bound) == pytest.approx(best, rel=1e-9)


def test_a_tree_is_proved_too_and_its_value_is_that_of_brute_force(
    lines: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "proof.vipr"
    path.write_text("\n".join(lines) + "\n")
    checked = check_joint_proof(path, branched())
    assert checked.whole
    assert float(checked.bound) == pytest.approx(minimum(problem_of(branched()), "makespan"))
    assert "the makespan of 250 is optimal" in check_proof(path, branched())


def test_a_worse_plan_is_not_proved_and_that_it_is_called_optimal_is_contradicted(
    tmp_path: Path,
) -> None:
    worse = make_plan(mission(BRANCHED), planner="greedy")
    claimed = branched().certificates[0].model_copy(update={"root": None})
    proof = prove_plan(
        worse.model_copy(update={"certificates": (claimed,)}), path=tmp_path / "proof.vipr"
    )
    assert proof.status == "partial"
    assert proof.bound is not None
    assert proof.bound <= 250
    assert proof.remark == "there are better routes"
    assert "it claims that" in proof.contradiction


def test_a_proof_that_is_stopped_proves_the_bound_of_its_open_tree(tmp_path: Path) -> None:
    path = tmp_path / "proof.vipr"
    bounds = []
    for size in (1, 5000):  # nothing but the root, then a part of the tree
        proof = prove_plan(branched(), path=path, size_limit=size)
        assert proof.status == "partial"
        assert proof.remark == "size limit"
        checked = check_joint_proof(path, branched())
        assert "no plan has a makespan below" in checked.summary
        assert checked.bound == proof.exact_bound
        bounds.append(checked.bound)
    assert 0 < bounds[0] < bounds[1] < minimum(problem_of(branched()), "makespan")
    at_once = prove_plan(branched(), path=path, time_limit=0)
    assert at_once.remark == "time limit"
    assert check_joint_proof(path, branched()).bound == at_once.exact_bound


def test_a_plan_tells_what_is_proved_of_it_and_by_which_file(tmp_path: Path) -> None:
    path, told = tmp_path / "proof.vipr", tmp_path / "plan.json"
    for size, status in ((None, "proved"), (1, "partial")):
        proof = prove_plan(branched(), path=path, size_limit=size)
        plan = with_proof(branched(), proof)
        plan.save(told)
        assert Plan.read(told).same_as(branched())
        (certificate,) = Plan.read(told).certificates
        assert certificate.proved is not None
        assert certificate.proved.status == status
        assert certificate.proved.digest == hashlib.sha256(path.read_bytes()).hexdigest()
        assert certificate.proved.size == path.stat().st_size
        assert (certificate.proved.leaves, certificate.proved.bound) == (proof.leaves, proof.bound)
        assert not claim_problems(plan)
    assert certificate.how.startswith("claimed by branch and cut")
    assert "; proved up to 232.5 (1 leaf, " in certificate.how
    assert certificate.how.endswith("size limit")
    # What is said to be proved must at least agree with the plan.
    for changes, why in (
        ({"bound": 260.0}, "260 is said to be proved, above"),
        ({"status": "proved"}, "said to be proved at 250, above what is, 232.5"),
    ):
        said = certificate.proved.model_copy(update=changes)
        wrong = certificate.model_copy(update={"proved": said})
        (problem,) = claim_problems(plan.model_copy(update={"certificates": (wrong,)}))
        assert why in problem
    other = prove_plan(branched(), path=path, objective="total_time", time_limit=0)
    with pytest.raises(InputError, match="no certificate that the proof could be of"):
        with_proof(branched(), other)


def test_a_makespan_is_branched_on_where_a_load_binds() -> None:
    made = branched()
    data, routes = problem_of(made), routes_of(made)
    aim = objective_of("makespan")
    formulation = EdgeFormulation.of(data, aim, aim.value(data, routes))
    statement = Statement(formulation, made.known)
    columns = np.arange(5, formulation.n_columns)
    first = binding_first(statement, columns)
    rows = statement.program.rows
    for robot in made.known.robots:
        duals = np.zeros(len(rows))
        (at,) = [
            i for i, row in enumerate(rows)
            if row.at_upper >= 0
            and statement.program.stated[row.at_upper].name == f"makespan:{robot.id}"
        ]  # fmt: skip
        duals[at] = -0.5
        served, own, others = first(Relaxed("optimal", duals=duals))
        names = np.array(statement.program.names)[columns]
        mine = [re.match(rf"[yaflev]:{robot.id}:", name) is not None for name in names]
        assert own.tolist() == mine
        assert others.tolist() == [name[0] in "ya" for name in names]
        assert served.tolist() == (own & others).tolist()


def test_a_certificate_speaks_of_time_units(lines: list[str], tmp_path: Path) -> None:
    path = tmp_path / "proof.vipr"
    path.write_text("\n".join(lines) + "\n")
    assert verify(str(path)).claim == "minimum in [250, 250]"
    made = optimum(0, "total_time")  # all service is a part of it
    prove_plan(made, path=path)
    assert verify(str(path)).lower == verify(str(path)).upper
    assert float(verify(str(path)).best or 0) == pytest.approx(made.metrics.total_time)


# What is tampered with.


def test_a_claim_that_is_one_step_too_high_is_refused(lines: list[str], tmp_path: Path) -> None:
    # At a speed of 2/5 a cell takes 5/2, which divides all service times: 250 are 100 steps.
    at = place(lines, lambda line: line.startswith("RTP range"))
    assert lines[at] == "RTP range 250 250"
    lines = [*lines]
    lines[at] = "RTP range 505/2 505/2"
    assert "line" in refusal(lines, branched(), tmp_path)
    lines[at] = "RTP range 505/2 inf"
    assert "line" in refusal(lines, branched(), tmp_path)
    # … also without the solution that contradicts it, and where all that follows is raised with it.
    start = place(lines, lambda line: line.startswith("SOL"))
    lines[start : start + 2] = ["SOL 0"]
    raised = [line.replace(" G 250 OBJ", " G 505/2 OBJ") for line in lines]
    assert "by lin" in refusal(raised, branched(), tmp_path)
    raised = [re.sub(r"^(d\d+) G 100 1", r"\1 G 101 1", line) for line in raised]
    assert "by uns" in refusal(raised, branched(), tmp_path)
    assumed = place(raised, lambda line: "{ asm }" in line)
    raised[assumed] = raised[assumed].replace(" L 99 ", " L 100 ", 1)
    assert re.match(r"line \d+: constraint \d+ by", refusal(raised, branched(), tmp_path))


def test_a_branch_that_is_left_out_is_refused(lines: list[str], tmp_path: Path) -> None:
    at = max(i for i, line in enumerate(lines) if "{ uns" in line and " 1 0 {" in line)
    words = lines[at].split()
    first = words.index("uns") + 1
    words[first + 2 : first + 4] = words[first : first + 2]  # the other branch is this one again
    tampered = [*lines[:at], " ".join(words), *lines[at + 1 :]]
    assert refusal(tampered, branched(), tmp_path).startswith(f"line {at + 1}: ")
    leaf = place(lines, lambda line: line.startswith("d") and "{ lin" in line and "G 1 0" in line)
    assert "line" in refusal([*lines[:leaf], *lines[leaf + 1 :]], branched(), tmp_path)


def test_a_multiplier_that_is_changed_is_refused_where_it_stands(
    lines: list[str], tmp_path: Path
) -> None:
    leaf = place(lines, lambda line: line.startswith("d") and "{ lin" in line and "G 1 0" in line)
    words = lines[leaf].split()
    at = words.index("lin") + 3
    words[at] = str(2 * Fraction(words[at]) + 1)
    tampered = [*lines[:leaf], " ".join(words), *lines[leaf + 1 :]]
    assert refusal(tampered, branched(), tmp_path).startswith(f"line {leaf + 1}: ")


@pytest.mark.parametrize("kind", ["subtour", "first", "degree", "served", "makespan", "upp"])
def test_a_row_that_the_mission_does_not_imply_is_refused_where_it_stands(
    kind: str, lines: list[str], tmp_path: Path
) -> None:
    at = place(lines, lambda line: line.startswith(f"{kind}:"))
    name, sense, side, size, *terms = lines[at].split()
    coefficients = [*terms]
    coefficients[1] = str(int(terms[1]) + (1 if sense != "G" else -1))
    nearer = str(int(side) + (1 if sense == "G" else -1))
    other = [victim for victim in "0123456" if f":{victim}" not in name and victim not in name]
    for changed in (
        f"{name} {sense} {nearer} {size} {' '.join(terms)}",
        f"{name} {sense} {side} {size} {' '.join(coefficients)}",
        f"{name}:{other[0]} {sense} {side} {size} {' '.join(terms)}",
    ):
        tampered = [*lines[:at], changed, *lines[at + 1 :]]
        assert refusal(tampered, branched(), tmp_path).startswith(f"line {at + 1}: ")


def test_a_cut_of_another_set_or_victim_is_refused(lines: list[str], tmp_path: Path) -> None:
    kind = "subtour"
    is_one = re.compile(rf"{kind}:\d+:\d+:\d")
    found = [i for i, line in enumerate(lines) if is_one.match(line)]
    assert found
    for at in found[:2]:
        name, rest = lines[at].split(" ", 1)
        _, robot, victim, members = name.split(":")
        inside = members.split(",")
        outside = next(v for v in "0123456" if v not in (*inside, victim))
        for new in (
            f"{kind}:{robot}:{outside}:{members}",
            f"{kind}:{robot}:{victim}:{members},{outside}",
            f"{kind}:{robot}:{victim}:{members},{inside[0]}",
            f"{kind}:9:{victim}:{members}",
        ):
            wrong = refusal([*lines[:at], f"{new} {rest}", *lines[at + 1 :]], branched(), tmp_path)
            assert wrong.startswith(f"line {at + 1}: ")


OTHERS: dict[str, dict[str, object]] = {
    "slower": {"speed": 0.2},
    "twice as fast": {"speed": 0.8},
    "faster": {"speed": 0.6},
    "elsewhere": {"start": (0, 0)},
    "more able": {"capabilities": frozenset(mission(BRANCHED).capabilities)},
    "less able": {"capabilities": frozenset()},
}


@pytest.mark.parametrize("changes", OTHERS.values(), ids=OTHERS)
def test_of_another_mission_no_proof_is_accepted_unless_it_is_true_of_it_too(
    changes: dict[str, object], lines: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "proof.vipr"
    path.write_text("\n".join(lines) + "\n")
    verify(str(path))  # as a proof of a program it is sound
    own = branched()
    robots = (own.instance.robots[0].model_copy(update=changes), *own.instance.robots[1:])
    other = own.instance.model_copy(update={"robots": robots})
    plan = Plan(instance=other, planner="exact", routes=own.routes)
    # A slower robot makes nothing better, and times are still multiples of the same.
    if changes != OTHERS["slower"]:
        with pytest.raises(CheckError, match=r"line \d+: "):
            check_joint_proof(path, plan)
    else:
        found = check_joint_proof(path, plan)
        assert float(found.bound) <= minimum(problem_of(plan), "makespan")


@pytest.mark.parametrize("seeds", sample([range(40), range(40, 2000)], 1), ids=str)
def test_whatever_is_changed_what_is_still_accepted_is_true(
    seeds: range, lines: list[str], tmp_path: Path
) -> None:
    best = minimum(problem_of(branched()), "makespan")
    path = tmp_path / "tampered.vipr"
    accepted = 0
    for seed in seeds:
        path.write_text("\n".join(tampered(random.Random(seed), lines)) + "\n")
        with contextlib.suppress(CheckError):
            found = check_joint_proof(path, branched())
            accepted += 1
            assert float(found.bound) <= best + 1e-9
    assert accepted < len(seeds) / 2


def tampered(chance: random.Random, lines: list[str]) -> list[str]:
    """The lines with something changed."""
    lines = [*lines]
    at = chance.randrange(len(lines))
    kind = chance.choice(["word", "word", "number", "number", "drop", "twice", "swap"])
    words = lines[at].split() or [""]
    if kind == "drop":
        del lines[at]
    elif kind == "twice":
        lines.insert(at, lines[at])
    elif kind == "swap":
        other = chance.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == "word":
        words[chance.randrange(len(words))] = chance.choice(
            ["0", "1", "-1", "2", "G", "L", "E", "lin", "rnd", "asm", "uns", "OBJ", "inf"]
        )
        lines[at] = " ".join(words)
    else:
        numbers = [i for i, word in enumerate(words) if word.lstrip("-").isdigit()]
        if numbers:
            i = chance.choice(numbers)
            words[i] = str(int(words[i]) + chance.choice([-1, 1]))
            lines[at] = " ".join(words)
    return lines
