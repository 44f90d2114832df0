"""The command run: what it refuses, and where its numbers come from."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.scenario import Scenario

Command = Callable[..., int]

REFUSED = {
    "--runs 0": "--runs: 0; give 1 or more",
    "--jobs 0": "--jobs: 0; give 1 or more",
    "--runs 2 --by nan": "--by: nan; give a time, 0 or more",
    "--runs 2 --by inf": "--by: inf; give a time, 0 or more",
    "--runs 2 --by -5": "--by: -5.0; give a time, 0 or more",
    "--by 5": "--by: is for several runs; give --runs with it",
    "--policy keep --policy keep": "--policy: 'keep' is repeated; give each policy once",
    "--policy kepp": "policy: 'kepp' (did you mean 'keep'?); give one of keep, repair, replan",
    "--runs 2 --regret 1": "--regret: is for one run; give one policy and no --runs",
    "--runs 2 --figure a.png": "--figure: is for one run; give one policy and no --runs",
    "--objective makespan": "--objective: says by what to judge; give --regret with it",
    "--regret 1 --objective time": "objective: 'time'; give one of total_time, makespan, latency",
    "--regret nan": "--regret: nan; give 0 or more",
}


@pytest.mark.parametrize("options", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(
    options: str, msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    assert msmrta("run", tmp_path / "plan.json", *options.split()) == 2
    assert capsys.readouterr().err == f"error: {REFUSED[options]}\n"


def test_a_file_of_another_kind_is_told_by_that_alone(
    msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    run = tmp_path / "run.json"
    assert msmrta("run", tmp_path / "plan.json", "--json", run) == 0
    capsys.readouterr()
    for command in (["run", run], ["export-plan", run, "-o", tmp_path / "a.csv"]):
        assert msmrta(*command) == 2
        said = capsys.readouterr().err
        assert said == f"error: {run}: format: 'msmrta-run/1'; give 'msmrta-plan/1'\n"


def test_regret_is_in_the_file_by_the_objective_that_is_asked_for(
    msmrta: Command, plan: Plan, tmp_path: Path
) -> None:
    plan.save(tmp_path / "plan.json")
    run = tmp_path / "run.json"
    asked = ("--regret", 5, "--objective", "makespan", "--json", run)
    assert msmrta("run", tmp_path / "plan.json", *asked) == 0
    document = json.loads(run.read_text())
    found = document["hindsight"]
    assert (found["objective"], found["run"]) == ("makespan", document["figures"]["makespan"])
    assert 0 < found["bound"] <= found["best"] <= found["run"]
    assert msmrta("check", run) == 0
    assert msmrta("check", run, "--proof", tmp_path / "none.vipr") == 2
    for name, value in {"run": 1.0, "best": found["run"] + 1, "bound": found["best"] + 1}.items():
        run.write_text(json.dumps({**document, "hindsight": {**found, name: value}}))
        assert msmrta("check", run) == 1


EMPTY = "{file}: is empty; give what may happen, or format = 'msmrta-scenario/1' alone for nothing"
SCENARIOS = {
    'format = "msmrta-scenario/1"\nuntil = 300.0\n[[lost]]\nrobot = 0\ntime = 300.0\n': (
        "{file}: lost[0].time: 300; the run ends then: give another time"
    ),
    "": EMPTY,
    "# nothing\n": EMPTY,
    '[[victims]]\nid = 50\ncell = HERE\nrequirements = ["A", "A"]': (
        "{file}: victims[0].requirements[1]: 'A' is repeated; each kind is listed once"
    ),
    "[[victims]]\nid = 50\ncell = HERE\nrequirements = []\nservice_time = {B = 3}": (
        "{file}: victims[0].service_time: a time for 'B', which victim 50 does not need (it needs "
        "nothing); remove it, or add the kind to its requirements"
    ),
    "until = nan\nnotce = 'before'\n[[lost]]\nrobot = 0\ntime = -5\n[[speed]]\nvalue = inf": (
        "{file}: until: NaN; give a finite number\n"
        "error: {file}: speed[0].value: Infinity; give a finite number\n"
        "error: {file}: lost[0].time: -5; give 0 or more\n"
        "error: {file}: notce: 'before'; there is no such field; correct its name or remove it (did "
        "you mean 'notice'?)"
    ),
    "[[corridors]]\ncells = [HERE]\nblocked = 20\nopened = 10": (
        "{file}: corridors[0].opened: 10; HERE is free until it is blocked at 20: give a later time, "
        "or leave it out"
    ),
    "[[corridors]]\ncells = [HERE, WALL]\nblocked = 20\nopened = 30": (
        "{file}: corridors[0].cells[1]: WALL is a wall of the map, which blocking does not change; "
        "give a free cell, or one that is opened before"
    ),
}


@pytest.mark.parametrize("text", SCENARIOS)
def test_a_mistake_in_a_scenario_is_told_of_its_file(
    text: str, msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    file = tmp_path / "scenario.toml"
    wall = str(np.argwhere(~plan.instance.map.free)[0].tolist())
    here = str(list(plan.instance.robots[0].start))
    file.write_text(text.replace("HERE", here).replace("WALL", wall))
    assert msmrta("run", tmp_path / "plan.json", "--scenario", file) == 2
    said = SCENARIOS[text].format(file=file).replace("HERE", here).replace("WALL", wall)
    assert capsys.readouterr().err == f"error: {said}\n"


def test_a_wall_that_is_opened_may_be_blocked_again(plan: Plan) -> None:
    wall = np.argwhere(~plan.instance.map.free)[0].tolist()
    tables = [{"cells": [wall], "opened": 10}, {"cells": [wall], "blocked": 50}]
    Scenario.from_document({"corridors": tables}).check_for(plan.instance)


def test_a_scenario_in_which_nothing_happens_is_said_to_be_one(
    msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    file = tmp_path / "scenario.toml"
    file.write_text('format = "msmrta-scenario/1"\n')
    assert msmrta("run", tmp_path / "plan.json", "--scenario", file) == 0
    assert f"Nothing happens: {file} has no table.\n" in capsys.readouterr().out


def test_tables_of_many_runs_and_proofs_are_refused_by_check_in_a_line(
    msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    runs, proof = tmp_path / "runs.json", tmp_path / "proof.json"
    assert msmrta("run", tmp_path / "plan.json", "--runs", 2, "--json", runs) == 0
    proof.write_text('{"format": "msmrta-latency-proof/1", "nodes": []}')
    capsys.readouterr()
    kinds = "msmrta-instance/1, msmrta-plan/1, msmrta-run/1"
    for file, said in {
        runs: f"{runs}: has no format, map or robots; give an instance, a plan or a run",
        proof: f"{proof}: format: 'msmrta-latency-proof/1'; give {kinds}",
    }.items():
        assert msmrta("check", file) == 2
        assert capsys.readouterr().err == f"error: {said}\n"


def test_what_comes_of_a_seed_does_not_depend_on_the_number_of_processes(
    msmrta: Command, plan: Plan, tmp_path: Path
) -> None:
    plan.save(tmp_path / "plan.json")
    scenario = tmp_path / "noise.toml"
    scenario.write_text('[[speed]]\ndistribution = "lognormal"\nsigma = 0.3\n')
    files = [tmp_path / "one.json", tmp_path / "two.json"]
    for jobs, file in enumerate(files, start=1):
        asked = ("--scenario", scenario, "--runs", 3, "--jobs", jobs, "--json", file)
        assert msmrta("run", tmp_path / "plan.json", *asked) == 0
    assert json.loads(files[0].read_text()) == json.loads(files[1].read_text())


TURNS_UP = """format = "msmrta-scenario/1"
[[victims]]
id = 50
cell = [0, 1]
requirements = ["Aid"]
announced = 0.5
"""


def test_of_a_victim_that_turns_up_it_is_told_who_gets_it_and_how_likely_it_is_served(
    msmrta: Command, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    scenario = tmp_path / "scenario.toml"
    kind = plan.instance.robots[0].capabilities[0]
    scenario.write_text(TURNS_UP.replace("Aid", kind), encoding="utf-8")
    asked = ("run", tmp_path / "plan.json", "--scenario", scenario)
    assert msmrta(*asked, "--policy", "repair") == 0
    assert f"decided: victim 50 {kind} to robot" in capsys.readouterr().out
    told = tmp_path / "runs.json"
    assert msmrta(*asked, "--policy", "keep", "--runs", 2, "--json", told) == 0
    served = {row["victim"]: row["value"] for row in json.loads(told.read_text())["served"]}
    assert served[50] == 0
    # 4 of 6: nobody has D, and behind its walls nobody reaches victim 30.
    assert "66.67" in capsys.readouterr().out.split("served share")[1]
