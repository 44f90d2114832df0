"""Ways to get a model wrong: each is told in one true line, in every command, and gives no plan.

The files of ``wrong/`` are a right model with one mistake each. The first line says when it is told, and
in what words: on importing the file, on building the program, or on solving it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from support.commands import commands

from msmrta_opt import cli
from msmrta_opt.cli import watch
from msmrta_opt.mission.errors import MsmrtaError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.axes import StageData
from msmrta_opt.optimise.solve import solve
from msmrta_opt.planners import plan
from msmrta_opt.stages.data import stage_data
from msmrta_opt.studies import comparison, runner
from msmrta_opt.studies.comparison import cases, solve_here

WRONG = Path(__file__).parent / "wrong"
MISSION = WRONG / "mission.json"
FILES = sorted(WRONG.glob("*.py"))
RIGHT = '''"""The model that the wrong ones are edits of."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x)) + charge * cp.sum(sent)),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label("victim {v} has one robot if it can"),
            (x <= sent[:, None]).set_label("robot {r} takes victim {v} only if it is sent"),
        ],
    )
'''
Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


def said_of(file: Path) -> tuple[str, str]:
    """When the mistake is told, and in what words."""
    found = re.match(r"# Told when (\w+): (.+)", file.read_text())
    assert found is not None
    return found[1], found[2]


def of(*moments: str) -> list[Path]:
    return [file for file in FILES if said_of(file)[0] in moments]


@pytest.fixture(scope="module")
def mission() -> Instance:
    return Instance.read(MISSION)


@pytest.fixture(scope="module")
def data(mission: Instance) -> StageData:
    found: StageData = stage_data(mission, "victim")
    return found


def test_there_are_at_least_thirty_and_each_is_another() -> None:
    assert len(FILES) >= 30
    assert len({said_of(file) for file in FILES}) >= 30


def test_the_right_model_is_right(folder: Path, told: Callable[..., tuple[int, str]]) -> None:
    (folder / "right.py").write_text(RIGHT)
    for command in ("show", "solve", "explain"):
        status, said = told(command, "right", MISSION)
        assert status == 0, said
    status, said = told("plan", MISSION, "--victim-model", "right")
    assert (status, "right" in said) == (0, True)


def test_the_list_of_models_tells_every_mistake_that_solving_does_not(
    folder: Path, told: Callable[..., tuple[int, str]]
) -> None:
    for file in FILES:
        shutil.copy(file, folder)
    status, said = told("models", MISSION, "--stage", "victim")
    assert status == 0
    for file in of("importing", "building"):
        if file.stem in ("empty_file", "stage_of_another"):
            continue  # no formulation, and one of another stage
        _, words = said_of(file)
        row = [line for line in said.splitlines() if line.split()[:1] == [file.stem]]
        assert row, file.stem
        assert words in row[0], file.stem


@dataclass(frozen=True)
class Case:
    """A wrong model, and a command that is given it."""

    file: Path
    command: str

    def line(self, folder: Path, proof: Path) -> list[object]:
        """What is typed; what is written goes to `folder`."""
        name, written = self.file.stem, folder / "written.json"
        what: dict[str, list[object]] = {
            "show": [name, MISSION],
            "solve": [name, MISSION, "--json", folder / "told.json"],
            "export": [name, MISSION, "-o", folder / "written.lp"],
            "explain": [name, MISSION],
            "diff": [name, "victim_covering", MISSION],
            "diff --search": ["victim_covering", name, "--tries", "9"],
            "watch": [name, MISSION],
            "check": [proof, name, MISSION],
            "plan": [MISSION, "--victim-model", name, "--json", written],
            "compare-plans": [
                *(MISSION, "--victim-model", name, "--seconds", "0", "--json", written),
            ],
            "tradeoff": [MISSION, "--over", "charge", "--model", name, "--json", written],
            "compare": [
                *(MISSION, "--stage", "victim", "--models", name, "--solvers", "auto"),
                *("--no-scores", "--json", folder / "told.json"),
            ],
            "study run": [folder / "study.toml", "--json", folder / "told.json"],
        }
        return [*self.command.split(), *what[self.command]]


BROKEN = {"watch": 0, "compare": 1, "study run": 1}
"""Exit statuses where a model cannot be built; of other commands 2. A study of failures alone is one."""
UNSOLVED = dict.fromkeys(("show", "export", "explain", "diff", "diff --search", "watch"), 0)
UNSOLVED["study run"] = 0  # that there is no solution is a result of the solve beside the plan
"""Exit statuses where a model has no solution; of other commands 1."""
STUDY = """
title = "a wrong model"
instances = [{{ files = ["{mission}"] }}]
planners = [{{ planner = "msmrta", victim_model = "{name}" }}]
formulations = [{{ stage = "victim", models = ["{name}"] }}]
"""
COMMANDS = (
    *("show", "solve", "export", "explain", "diff", "diff --search", "watch", "check", "plan"),
    *("compare-plans", "tradeoff", "compare", "study run"),
)
FEW = ("syntax", "no_boolean", "infeasible")
CASES = [
    pytest.param(
        Case(file, command),
        id=f"{file.stem} {command}",
        marks=() if command in ("solve", "plan") or file.stem in FEW else pytest.mark.slow,
    )
    for file in FILES
    for command in COMMANDS
    if command != "diff --search" or file.stem in ("syntax", "parameter_unused", "infeasible")
]
"""Each wrong model by two commands, and a few by all; in the slow set all by all.

On the missions of a search, which are tiny, only some of them are wrong.
"""


def test_every_command_that_takes_a_formulation_is_tried() -> None:
    takes = {name for name, options in commands().items() if "--models" in options}
    lists = {"models", "new-model"}  # which show and copy files, wrong or right
    assert takes - lists == {name.removesuffix(" --search") for name in COMMANDS} - {"study run"}


@pytest.fixture(scope="module")
def proof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A proof of another program."""
    path = tmp_path_factory.mktemp("proof") / "covering.vipr"
    assert cli.run(["solve", "victim_covering", str(MISSION), "--proof", str(path)]) == 0
    return path


@pytest.fixture
def tried(
    folder: Path,
    told: Callable[..., tuple[int, str]],
    tmp_path: Path,
    proof: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Callable[[Case], tuple[int, str]]:
    """Run a case; a comparison and a study solve in this process, a watch ends after its first solve."""

    def run(case: Case) -> tuple[int, str]:
        shutil.copy(case.file, folder)
        text = STUDY.format(mission=MISSION, name=case.file.stem)
        (tmp_path / "study.toml").write_text(text)
        for module in (comparison, runner):
            monkeypatch.setattr(module, "locally", lambda jobs=1: runner.here)
        monkeypatch.setattr(watch.time, "sleep", lambda _: os.kill(os.getpid(), signal.SIGINT))
        status, said = told(*case.line(tmp_path, proof))
        found = tmp_path / "told.json"
        return status, f"{said}\n{json.loads(found.read_text()) if found.exists() else ''}"

    return run


@pytest.mark.parametrize("case", CASES)
def test_a_wrong_model_is_told_by_every_command_and_none_gives_a_plan(
    case: Case, tried: Callable[[Case], tuple[int, str]], tmp_path: Path
) -> None:
    when, words = said_of(case.file)
    status, said = tried(case)
    if case.file.stem == "parameter_undeclared" and case.command == "tradeoff":
        words = "'charge' is no parameter"
    if case.file.stem == "empty_program" and case.command == "plan":
        words = "reads nothing of its data"
    if when == "solving":
        assert status == UNSOLVED.get(case.command, 1), said
        if case.command not in ("show", "export", "check"):
            # A comparison of two programs says the status of each.
            assert (f": {case.file.stem}." if "diff" in case.command else words) in said
    elif case.file.stem == "empty_file" and case.command in ("compare", "study run"):
        assert (status, words in said) == (2, True)
    else:
        right = 2 if when == "importing" and case.command == "watch" else None
        assert status == (right or BROKEN.get(case.command, 2)), said
        if case.file.stem != "stage_of_another":
            assert words in said
        else:
            assert "cluster" in said
    assert not (tmp_path / "written.json").exists()
    assert (tmp_path / "written.lp").exists() == (when == "solving" and case.command == "export")
    assert not re.search(r"'objective': [-\d]", said)


def test_what_is_infeasible_points_to_the_command_that_explains(
    folder: Path, told: Callable[..., tuple[int, str]]
) -> None:
    shutil.copy(WRONG / "infeasible.py", folder)
    status, said = told("plan", MISSION, "--victim-model", "infeasible")
    assert (status, "`msmrta explain infeasible INSTANCE`" in said) == (1, True)
    status, said = told("explain", "infeasible", MISSION)
    assert (status, "cannot hold together" in said) == (0, True)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_wrong_model_gives_no_solution_and_no_plan_in_python(
    file: Path, folder: Path, mission: Instance, data: StageData
) -> None:
    shutil.copy(file, folder)
    when, words = said_of(file)
    if when == "solving":
        solution = solve(file.stem, data)
        assert not solution.found
        assert words in f"{solution.status} {solution.reason}"
    elif file.stem != "stage_of_another":
        with pytest.raises(MsmrtaError, match=re.escape(words)) as caught:
            solve(file.stem, data)
        assert "\n" not in str(caught.value)
    with pytest.raises(MsmrtaError):
        plan(mission, victim_model=file.stem)


@pytest.mark.parametrize("file", of("importing", "building"), ids=lambda file: file.stem)
def test_a_wrong_model_is_a_row_of_a_comparison_without_a_solution(
    file: Path, folder: Path, mission: Instance
) -> None:
    shutil.copy(file, folder)
    if file.stem == "empty_file":
        with pytest.raises(MsmrtaError, match="not a formulation"):
            cases([mission], stage="victim", models=[file.stem])
        return
    (todo,) = cases([mission], stage="victim", models=[file.stem], solver_names=["auto"])
    record = solve_here(todo)
    assert record.objective is None
    assert record.verdict == "error"
    if file.stem != "stage_of_another":
        assert said_of(file)[1] in record.reason


def test_data_of_another_stage_is_refused_with_what_to_give(mission: Instance) -> None:
    with pytest.raises(MsmrtaError, match=r"victim_covering: .*mo.stage_data\(mission, 'victim'\)"):
        solve("victim_covering", stage_data(mission, "cluster"))
    with pytest.raises(MsmrtaError, match=r"victim_covering: .*mo.stage_data\(mission, 'victim'\)"):
        solve("victim_covering", mission)
