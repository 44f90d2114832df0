"""The command check --bound, as a user types it: what is proved again, and by whom; forgeries."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from support.corridor import DUALS, Document, backwards

from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]

NO_DUALS: Document = {"objective": "total_time", "bound": 7, "solver": "highs by hand"}


@pytest.fixture
def document(corridor_file: Path) -> Document:
    """The corridor's best plan, its bound proved by the dual values of `support.corridor`."""
    found = make_plan(Instance.read(corridor_file), planner="exact").document()
    found["certificates"][0].update(root=DUALS, proof="root LP")
    return found


def written(document: Document, folder: Path, **certificate: object) -> Path:
    file = folder / "plan.json"
    changed = copy.deepcopy(document)
    changed["certificates"][0].update(certificate)
    file.write_text(json.dumps(changed))
    return file


@pytest.mark.parametrize("solver", ["glpk", "scip"])
def test_a_root_bound_is_proved_again_in_exact_numbers_and_by_another_solver(
    solver: str,
    msmrta: Run,
    document: Document,
    corridor_file: Path,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    file = written(document, tmp_path)
    assert msmrta("check", file, corridor_file, "--bound", "--solver", solver) == 0
    told = capsys.readouterr()
    assert told.err == ""
    holds, root, again, claim, instance = told.out.splitlines()
    assert holds == f"{file}: the plan holds (2 requirements served)"
    assert root == (
        f"{file}: root bound 9 on the total_time proved again, in exact numbers from the dual "
        "values of highs by hand (0 cuts)"
    )
    assert re.fullmatch(
        rf"{file}: {solver} \S+ solves the same relaxation to 9; the dual values prove 9", again
    )
    assert claim == f"{file}: the certificate claims 9 by root LP: all of it is proved again"
    assert instance.startswith(f"{corridor_file}: a valid instance")


def test_what_branch_and_cut_proved_is_said_not_to_be_checked(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    file = written(document, tmp_path, root=NO_DUALS, proof="branch and cut")
    assert msmrta("check", file, "--bound") == 3
    told = capsys.readouterr()
    assert "root bound 7 on the total_time proved again" in told.out
    assert told.err == ""
    assert told.out.splitlines()[-1] == (
        f"{file}: the certificate claims 9 by branch and cut: what is beyond the root was proved by "
        "branch and cut, and is not re-checked"
    )
    assert msmrta("check", file) == 0


def test_strictly_what_is_only_claimed_is_wrong(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    file = written(document, tmp_path, root=NO_DUALS, proof="branch and cut")
    assert msmrta("check", file, "--bound", "--strict") == 1
    assert capsys.readouterr().err == (
        f"{file}: the certificate claims 9 by branch and cut: it is not proved again\n"
    )
    arguments = ("--bound", "--strict", "--time-limit", "60", "--solver", "glpk")
    assert msmrta("check", file, *arguments) == 0
    assert msmrta("check", written(document, tmp_path), "--bound", "--strict") == 0


@pytest.mark.parametrize("solver", [[], ["--solver", "glpk"]])
def test_with_time_the_explicit_model_proves_the_rest_again(
    solver: list[str], msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    file = written(document, tmp_path, root=NO_DUALS, proof="branch and cut")
    assert msmrta("check", file, "--bound", "--time-limit", "60", *solver) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    who = solver[-1] if solver else "highs"
    assert re.fullmatch(
        rf"{file}: {who} \S+ on joint_routing_flow proves 9: all of the claim is proved again", last
    )


def test_with_no_time_the_explicit_model_proves_nothing_and_says_so(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    changes = {"root": NO_DUALS, "proof": "branch and cut"}
    file = written(document, tmp_path, **changes)
    assert msmrta("check", file, "--bound", "--time-limit", "0", "--solver", "glpk") == 3
    assert capsys.readouterr().out.splitlines()[-1].endswith("the claim is not proved again")


@pytest.mark.parametrize(
    ("root", "bound", "proved"),
    [
        (NO_DUALS, 11.0, False),
        (DUALS, 11.0, False),  # the root's bound is right, and is all that is proved
        (DUALS, 9.5, False),
        (DUALS | {"bound": 8}, 10.0, False),
        (NO_DUALS, 9.0, True),
    ],
)
def test_what_is_beyond_the_root_is_only_claimed_until_the_explicit_model_confirms_or_contradicts_it(
    root: Document,
    bound: float,
    proved: bool,
    msmrta: Run,
    document: Document,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    """Of the plan worth 11, where 9 is the least."""
    status = "optimal" if bound == 11 else "feasible"
    changes: Document = {"root": root, "proof": "branch and cut", "bound": bound, "status": status}
    worse = backwards(document)
    del worse["search"]  # which has found better
    file = written(worse, tmp_path, **changes, gap=(11 - bound) / 11)
    assert msmrta("check", file, "--bound") == 3
    assert msmrta("check", file, "--bound", "--strict") == 1
    capsys.readouterr()
    assert msmrta("check", file, "--bound", "--time-limit", "60") == (0 if proved else 1)
    if not proved:
        (line,) = capsys.readouterr().err.splitlines()
        assert line.endswith(
            f"on joint_routing_flow finds 9, below the bound {bound:g} that is claimed"
        )


@pytest.mark.parametrize(
    ("certificate", "problem"),
    [
        ({"bound": 10.0}, "the bound 10 is above what the plan is worth, 9"),
        ({"root": DUALS | {"bound": 9.5}}, "the root bound is 9.5, but only 9 is proved"),
        ({"root": DUALS | {"served": []}}, "the root bound is 9, but only 7 is proved"),
        ({"root": None}, "nothing is stored that proves a bound by root LP"),
        (
            {"root": DUALS | {"first": [{"robot": 0, "victims": [1, 1], "dual": -1}]}},
            "cut first[0] holds a victim twice",
        ),
        (
            {"root": DUALS | {"outside": [{"robot": 0, "victims": [1], "victim": 1, "dual": -1}]}},
            "cut outside[0] holds only for a victim outside its set, not 1",
        ),
        (
            {"root": DUALS | {"last": [{"robot": 0, "victims": [1], "dual": 1}]}},
            "the dual value 1 of cut last[0] has the wrong sign",
        ),
    ],
)
def test_a_forgery_gets_one_line_and_status_1(
    certificate: Document,
    problem: str,
    msmrta: Run,
    document: Document,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    file = written(document, tmp_path, **certificate)
    # What the routes alone contradict is told without being asked.
    assert msmrta("check", file) == (1 if "bound" in certificate else 0)
    capsys.readouterr()
    assert msmrta("check", file, "--bound") == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{file}: ")
    assert problem in line


@pytest.mark.parametrize(
    ("certificate", "problem"),
    [
        ({"root": DUALS | {"rows": []}}, "certificates[0].root.rows: "),
        ({"root": DUALS | {"leaves": [{"robot": 0}]}}, "root.leaves[0].dual: is missing"),
        ({"root": DUALS | {"objective": "latency"}}, "root.objective: 'latency'; give"),
        ({"pricing": {"bound": 9, "solver": "me"}}, "pricing.time_steps: is missing; give it"),
    ],
)
def test_a_proof_that_is_none_gets_a_line_a_mistake_and_status_2(
    certificate: Document,
    problem: str,
    msmrta: Run,
    document: Document,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    assert msmrta("check", written(document, tmp_path, **certificate), "--bound") == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert all(line.startswith("error: ") for line in told.err.splitlines())
    assert problem in told.err


def test_a_truncated_plan_gets_one_line_and_status_2(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    file = written(document, tmp_path)
    file.write_text(file.read_text()[:-200])
    assert msmrta("check", file, "--bound") == 2
    told = capsys.readouterr().err
    assert told.startswith(f"error: {file}: broken JSON: ")
    assert told.count("\n") == 1


def test_a_plan_for_another_mission_than_the_one_beside_it_is_refused(
    msmrta: Run, document: Document, paper_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = written(document, tmp_path)
    assert msmrta("check", file, paper_file) == 1
    told = capsys.readouterr()
    assert told.out.startswith(f"{paper_file}: a valid instance")
    lines = told.err.splitlines()
    assert lines[0] == (
        f"{file}: the plan is for another mission: the map has another size, 1 × 5 in the plan and "
        "20 × 20 in the mission"
    )
    assert all(line.startswith(f"{file}: the plan is for another mission: ") for line in lines)
    assert f"{file}: the plan is for another mission: victim 9 is not in the plan" in lines


def test_a_plan_beside_several_missions_is_for_one_of_them_or_held_against_the_closest(
    msmrta: Run,
    document: Document,
    corridor_file: Path,
    paper_file: Path,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    file = written(document, tmp_path)
    assert msmrta("check", file, paper_file, corridor_file) == 0
    capsys.readouterr()
    corridor = Instance.read(corridor_file)
    moved = corridor.victims[1].model_copy(update={"cell": (0, 3)})
    near = tmp_path / "near.json"
    corridor.replace(victims=(corridor.victims[0], moved)).save(near)
    assert msmrta("check", paper_file, near, file) == 1
    assert capsys.readouterr().err == (
        f"{file}: the plan is for another mission: victim 1 stands elsewhere, (0, 4) in the plan and "
        "(0, 3) in the mission\n"
    )


def test_every_certificate_on_the_joint_problem_is_checked(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    (first,) = document["certificates"]
    document["certificates"] = [first, first | {"objective": 1e6, "bound": 1e6}]
    assert msmrta("check", written(document, tmp_path), "--bound") == 1
    told = capsys.readouterr()
    name = f"{tmp_path}/plan.json: certificate 1: "
    assert f"{name}the certificate says 1000000 for a plan worth 9" in told.err
    assert f"{name}the bound 1000000 is above what the plan is worth, 9" in told.err
    assert (
        "certificate 0: the certificate claims 9 by root LP: all of it is proved again" in told.out
    )


@pytest.mark.parametrize(
    ("order", "changes"),
    [
        ("wrong last", {"objective": 1e6, "bound": 1e6}),
        ("wrong first", {"objective": 1e6, "bound": 1e6}),
        ("wrong last", {"bound": 10.0}),
        ("wrong in the middle", {"objective": 8.0}),
        ("wrong in the middle", {"bound": 9.5, "proof": "branch and cut"}),
    ],
)
def test_one_wrong_certificate_among_right_ones_is_enough(
    order: str, changes: Document, msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    (right,) = document["certificates"]
    wrong = right | changes
    orders = {
        "wrong first": [wrong, right],
        "wrong last": [right, wrong],
        "wrong in the middle": [right, wrong, right],
    }
    document["certificates"] = orders[order]
    assert msmrta("check", written(document, tmp_path), "--bound") == 1
    told = capsys.readouterr()
    number = orders[order].index(wrong)
    assert all(f": certificate {number}: " in line for line in told.err.splitlines())
    assert told.out.count("all of it is proved again") == len(orders[order]) - 1


def test_a_plan_that_does_not_hold_has_no_bound_to_speak_of(
    msmrta: Run, document: Document, tmp_path: Path, capsys: Capture
) -> None:
    document["options"]["endurance"] = 8
    file = written(document, tmp_path)
    assert msmrta("check", file, "--bound") == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == f"{file}: robot 0 is busy for 9, beyond its 8\n"


def latency(corridor_file: Path, folder: Path, **certificate: object) -> Path:
    """The corridor's plan of least latency, 12; dual values prove it."""
    tasks = [
        {"victim": victim, "kinds": ["FirstAids"], "dual": reward, "densities": [1]}
        for victim, reward in ((0, 7), (1, 9))
    ]
    pricing = {
        "bound": 12,
        "solver": "highs by hand",
        "time_steps": [{"robot": 0, "length": 1}],
        "rounds": [{"tasks": tasks}],
    }
    made: Plan = make_plan(Instance.read(corridor_file), planner="exact", objective="latency")
    changes = {"pricing": pricing, "proof": "column generation"} | certificate
    return written(made.document(), folder, **changes)


def test_a_bound_on_latency_is_proved_again_from_its_dual_values(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = latency(corridor_file, tmp_path)
    assert msmrta("check", file, "--bound") == 0
    assert capsys.readouterr().out.splitlines()[1:] == [
        f"{file}: root bound 12 on the latency proved again, in exact numbers from the dual "
        "values of highs by hand (rounds: 1)",
        f"{file}: the certificate claims 12 by column generation: all of it is proved again",
    ]


def test_a_bound_on_latency_that_its_dual_values_do_not_prove_is_refused(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    file = latency(corridor_file, tmp_path)
    document = json.loads(file.read_text())
    document["certificates"][0]["pricing"]["rounds"][0]["tasks"][1]["dual"] = 2
    file.write_text(json.dumps(document))
    assert msmrta("check", file, "--bound") == 1
    assert "bound is 12, but only " in capsys.readouterr().err


def test_what_branching_proved_of_latency_can_be_proved_by_the_model(
    msmrta: Run, corridor_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    nothing = {
        "bound": 8,
        "solver": "highs by hand",
        "time_steps": [{"robot": 0, "length": 2}],
        "rounds": [{"tasks": []}],
    }
    file = latency(corridor_file, tmp_path, pricing=nothing, proof="branch and price")
    assert msmrta("check", file, "--bound", "--time-limit", "60") == 0
    claim, model = capsys.readouterr().out.splitlines()[2:]
    assert claim.endswith("was proved by branch and price, and is not re-checked")
    assert "on joint_routing_mtz proves 12: all of the claim is proved again" in model


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--time-limit", "5"], "--time-limit: is for bounds; give --bound with it"),
        (["--solver", "glpk"], "--solver: is for bounds; give --bound with it"),
        (["--strict"], "--strict: is for bounds; give --bound with it"),
        (["--bound", "--time-limit", "-1"], "--time-limit: -1.0; give 0 or more"),
        (["--bound", "--solver", "highs"], "--solver: highs made the bound itself; give glpk"),
        (["--bound", "--solver", "nobody"], "solver: no solver 'nobody'"),
        (["--bound"], "'greedy' claims no bound on the joint problem; give one of 'exact'"),
    ],
)
def test_options_that_make_no_sense_get_one_line_and_status_2(
    arguments: list[str],
    problem: str,
    msmrta: Run,
    corridor_file: Path,
    tmp_path: Path,
    capsys: Capture,
) -> None:
    file = tmp_path / "plan.json"
    make_plan(Instance.read(corridor_file), planner="greedy").save(file)
    assert msmrta("check", file, *arguments) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert problem in told
