"""The one call for all planners: what it finds, and what it refuses."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.amounts import sample

from msmrta_opt import cli
from msmrta_opt.mission.errors import CheckError, InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan, planners
from msmrta_opt.planners.support.planner import Planner
from msmrta_opt.studies.specification import Study


@pytest.fixture
def corridor(instances_dir: object) -> Instance:
    return Instance.read(f"{instances_dir}/corridor.json")


def test_planners_are_known_by_their_names() -> None:
    found = planners()
    assert {"msmrta", "mrga", "greedy", "ssi", "random"} <= set(found)
    assert all(name == planner.name and planner.title for name, planner in found.items())


def test_the_staged_method_is_the_default(corridor: Instance) -> None:
    assert plan(corridor).planner == "msmrta"


def test_an_unknown_planner_is_refused_with_those_there_are(corridor: Instance) -> None:
    with pytest.raises(InputError, match=r"^planner: 'best'; give one of .*greedy.*msmrta"):
        plan(corridor, planner="best")


@pytest.mark.parametrize(
    ("planner", "there"),
    [
        ("mrga", "distances, alpha, beta, seed"),
        ("greedy", "seed"),
        ("msmrta", "psi, beta, .*shared_table"),
    ],
)
def test_an_unknown_option_is_refused_with_those_there_are(
    planner: str, there: str, corridor: Instance
) -> None:
    with pytest.raises(InputError, match=rf"^colour: .*{there}"):
        plan(corridor, planner=planner, colour="red")


@pytest.mark.parametrize("planner", ["greedy", "mrga", "random", "ssi"])
@pytest.mark.parametrize("seed", [-1, 2**32, 0.5, "x", True])
def test_a_seed_out_of_range_is_refused(planner: str, seed: object, corridor: Instance) -> None:
    with pytest.raises(InputError, match=r"^seed: ") as caught:
        plan(corridor, planner=planner, seed=seed)
    assert repr(seed) in str(caught.value)


@pytest.mark.parametrize("improve", [-1, float("nan"), float("inf"), "long", None, [1]])
def test_an_improve_that_is_no_duration_is_refused(improve: object, corridor: Instance) -> None:
    with pytest.raises(InputError, match=r"^improve: .* give true, false, or a finite number"):
        plan(corridor, improve=improve)  # type: ignore[arg-type]


@pytest.mark.parametrize("objective", ["cost", "", 3, ["latency"]])
def test_an_unknown_objective_is_refused(objective: object, corridor: Instance) -> None:
    with pytest.raises(InputError, match=r"^objective: .* total_time, makespan, latency"):
        plan(corridor, improve=True, objective=objective)  # type: ignore[arg-type]


def test_an_objective_that_nothing_would_heed_is_refused(corridor: Instance) -> None:
    with pytest.raises(InputError, match=r"^objective: .* give improve with it"):
        plan(corridor, planner="greedy", objective="makespan")


def test_a_plan_that_fails_its_check_is_never_returned(
    corridor: Instance, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lazy(instance: Instance) -> Plan:
        """Serve nobody, and do not say so."""
        made = plan(instance)
        return made.model_copy(update={"routes": (), "planner": "lazy"})

    known = {**planners(), "lazy": Planner("lazy", "does nothing", lazy)}
    monkeypatch.setattr("msmrta_opt.planners.planners", lambda: known)
    with pytest.raises(CheckError, match="the plan of 'lazy' fails its check"):
        plan(corridor, planner="lazy")


# What a planner declares of itself, so that nobody else has to know it.


def test_options_are_those_of_the_call_without_functions_to_call_back() -> None:
    known = planners()
    assert known["greedy"].options == {"seed": 0}
    assert known["msmrta"].options["psi"] == 0.95
    assert "callbacks" not in known["exact"].options
    assert [name for name in known if known[name].heeds_objective] == ["exact"]
    assert [name for name in known if known[name].improves_itself] == ["exact"]


@pytest.mark.parametrize(
    ("planner", "options", "names"),
    [
        ("msmrta", {}, ("cluster_one_to_one", "victim_one_to_one")),
        (
            "msmrta",
            {"clustering_model": "clustering_pmedian", "preset": "authors", "improve": 1},
            ("clustering_pmedian", "cluster_one_to_one", "victim_one_to_one"),
        ),
        ("exact", {}, ()),
        ("exact", {"return_to_start": True, "endurance": None}, ()),
        ("exact", {"endurance": 100}, ("joint_routing_flow",)),
        ("exact", {"longest_walk": 100}, ("joint_routing_flow",)),
        ("greedy", {}, ()),
    ],
)
def test_a_planner_knows_which_formulations_its_plans_depend_on(
    planner: str, options: dict[str, Any], names: tuple[str, ...]
) -> None:
    assert planners()[planner].formulations_of(options) == names


WATCH = """
import os, sys
import msmrta_opt as mo
from msmrta_opt.planners import planners

mission, known = mo.read(sys.argv[1]), planners()
for name, options in eval(sys.argv[2]):
    if os.fork() == 0:  # so that no planner finds what another has loaded
        planner = known[name]
        planner.load(options)
        before = set(sys.modules)
        planner.run(mission, **options)
        print(name, options, sorted(set(sys.modules) - before), flush=True)
        os._exit(0)
    os.wait()
"""
LOADING: dict[str, list[tuple[str, dict[str, Any]]]] = {
    "on": [("msmrta", {}), ("exact", {}), ("exact", {"objective": "latency"})],
    "off": [("msmrta", {}), ("exact", {})],
    "on, others": [
        *((name, {}) for name in planners() if name not in ("msmrta", "exact")),
        ("msmrta", {"clustering_model": "clustering_pmedian", "pinned_clusters": False}),
        ("mrga", {"distances": "search"}),
        ("exact", {"endurance": 600}),
    ],
}
"""Planners with options that make them need more than by default; without numba, those that use it."""


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot be forked on Windows")
@pytest.mark.parametrize("numba", sample(list(LOADING), 2))
def test_planning_imports_nothing_that_was_not_loaded_before_the_clock(
    numba: str, instances_dir: Path
) -> None:
    """Each planner in a process that has loaded nothing else, on a mission with scouts and walls."""
    ended = subprocess.run(
        [sys.executable, "-c", WATCH, str(instances_dir / "paper.json"), repr(LOADING[numba])],
        capture_output=True,
        text=True,
        check=False,
        env={
            **os.environ,
            "PYTHONPATH": str(instances_dir.parent),
            **({"NUMBA_DISABLE_JIT": "1"} if numba == "off" else {}),
        },
    )
    assert ended.returncode == 0, ended.stderr
    lines = ended.stdout.splitlines()
    assert len(lines) == len(LOADING[numba]), ended.stderr
    assert [line for line in lines if not line.endswith(" []")] == []


OWN = '''
from msmrta_opt.planners import greedy
from msmrta_opt.planners.support.baseline import plan_by
from msmrta_opt.planners.support.planner import Planner


def run(instance, *, seed=0, patience=3):
    """Plan as the greedy planner does."""
    options = {"patience": patience}
    return plan_by(greedy.allocate, instance, planner=PLANNER, seed=seed, options=options)


PLANNER = Planner("patient", "waits for nothing", run, formulations=lambda _: ["cluster_fair"])
'''


def test_a_planner_is_one_file(
    corridor: Instance,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Planning, commands and studies know it by what it declares."""
    (tmp_path / "patient.py").write_text(OWN)
    corridor.save(tmp_path / "corridor.json")
    (tmp_path / "study.toml").write_text(
        'title = "one"\n[[instances]]\nfiles = ["corridor.json"]\n'
        '[[planners]]\nplanner = "patient"\npatience = [1, 2]\n'
    )
    package = importlib.import_module("msmrta_opt.planners")
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
    monkeypatch.setattr(package, "planners", cache(package.planners.__wrapped__))
    for module in ("msmrta_opt.studies.runs", "msmrta_opt.planners.patient"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    made = plan(corridor, planner="patient", patience=5)
    assert (made.planner, made.options) == ("patient", {"seed": 0, "patience": 5})
    assert cli.run(["planners"]) == 0
    assert "waits for nothing" in capsys.readouterr().out
    runs = importlib.import_module("msmrta_opt.studies.runs").runs
    contenders = runs(Study.read(tmp_path / "study.toml"))
    assert [run.contender for run in contenders] == [
        "patient, patience = 1",
        "patient, patience = 2",
    ]
