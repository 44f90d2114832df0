"""The guide to writing a formulation: all that it shows is run, in a new user's order."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from itertools import combinations, permutations
from pathlib import Path

import numpy as np
import pytest

from msmrta_opt import cli, formulations
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.optimise import new_models, registry
from msmrta_opt.optimise.blank import BLANK
from msmrta_opt.optimise.solve import solve
from msmrta_opt.planners import plan
from msmrta_opt.stages.data import stage_data

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "models" / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", GUIDE, flags=re.MULTILINE | re.DOTALL)
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with the instances, from which a user works; no folder of models is kept."""
    shutil.copytree(ROOT / "instances", tmp_path / "instances")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    yield tmp_path
    registry.reload_models()


def test_everything_that_the_guide_shows_runs(workplace: Path, capsys: Capture) -> None:
    assert [language for language, _ in BLOCKS] == ["sh", "python", "sh", "python", "text"]
    for language, text in BLOCKS:
        if language == "sh":
            for line in text.splitlines():
                program, *arguments = shlex.split(line)
                assert program == "msmrta"
                assert cli.run(arguments) == 0, f"{line}\n{capsys.readouterr().err}"
        elif "def build" in text:
            (workplace / "cluster_near.py").write_text(text)
            registry.reload_models()
        elif language == "python":
            exec(compile(text, "the guide", "exec"), {})
    (first, *_) = Plan.read(workplace / "near.json").certificates
    assert (first.model, first.parameters) == ("cluster_near", {"kappa": 0.2})
    assert first.digest == registry.get("cluster_near").digest


@pytest.mark.parametrize("stage", BLANK)
def test_a_blank_formulation_runs_as_it_is(stage: str, workplace: Path, capsys: Capture) -> None:
    name = f"{stage}_blank"
    assert cli.run(["new-model", name, "--blank", stage, "--to", "."]) == 0
    assert cli.run(["solve", name, "instances/two_rooms.json"]) == 0
    told = capsys.readouterr().out
    assert "optimal" in told
    if stage in ("clustering", "cluster", "victim"):
        option = f"{stage}_model={name}"
        assert cli.run(["plan", "instances/two_rooms.json", "--option", option]) == 0


@pytest.mark.parametrize("mission", ["two_rooms", "corridor"])
def test_the_blank_routing_formulation_has_the_optimum_of_the_exact_planner(
    mission: str, workplace: Path
) -> None:
    new_models.blank_model("routing", "routing_blank")
    instance = Instance.read(workplace / "instances" / f"{mission}.json")
    found = solve("routing_blank", stage_data(instance, "routing"))
    made = plan(instance, planner="exact", objective="total_time", time_limit=60)
    assert found.objective == pytest.approx(made.metrics.total_time)


@pytest.mark.parametrize("mission", ["two_rooms", "corridor", "paper"])
def test_the_blank_joint_formulation_takes_the_clusters_that_leave_the_minimum_of_service(
    mission: str, workplace: Path
) -> None:
    new_models.blank_model("joint", "joint_blank")
    data = stage_data(Instance.read(workplace / "instances" / f"{mission}.json"), "joint")
    n_robots, n_clusters = data.w.shape
    left = np.where(data.can_serve, data.service, np.inf).min(axis=0)  # by holder and victim
    left[np.isinf(left)] = 0.0
    minimum = np.inf
    for robots in permutations(range(n_robots), min(n_robots, n_clusters)):
        for clusters in combinations(range(n_clusters), len(robots)):
            holder = dict(zip(clusters, robots, strict=True))
            worth = sum(left[holder.get(c, n_robots), v] for v, c in enumerate(data.cluster))
            minimum = min(minimum, worth)
    assert solve("joint_blank", data).objective == pytest.approx(minimum)


def test_a_plan_says_when_a_formulation_has_changed_since(workplace: Path, capsys: Capture) -> None:
    assert cli.run(["new-model", "cluster_mine", "--from", "cluster_printed", "--to", "."]) == 0
    mission = "instances/two_rooms.json"
    given = ["--models", ".", "--cluster-model", "cluster_mine", "--json", "plan.json"]
    assert cli.run(["plan", mission, *given]) == 0
    capsys.readouterr()
    assert cli.run(["check", "plan.json", mission, "--models", "."]) == 0
    assert "changed" not in capsys.readouterr().out
    with (workplace / "cluster_mine.py").open("a") as file:
        file.write("# another thought\n")
    assert cli.run(["check", "plan.json", mission, "--models", "."]) == 0
    said = capsys.readouterr().out
    assert "formulation cluster_mine has changed since the plan was made" in said
    (workplace / "cluster_mine.py").unlink()
    assert cli.run(["check", "plan.json", mission, "--models", "."]) == 0
    assert "no formulation cluster_mine is found here" in capsys.readouterr().out
