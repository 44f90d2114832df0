"""A new user's path: from a blank formulation to a report, without a line of the package's source."""

from __future__ import annotations

import json
import os
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from msmrta_opt import cli, formulations
from msmrta_opt.cli import watch
from msmrta_opt.mission.plan import Plan
from msmrta_opt.optimise import registry
from msmrta_opt.studies import comparison, runner

INSTANCES = Path(__file__).parents[2] / "instances"
STUDY = """
title = "How much a cell of walking is worth"
models = ["."]

[[instances]]
files = ["two_rooms.json"]

[[planners]]
name = "near"
planner = "msmrta"
cluster_model = "cluster_near"
kappa = [0.0, 0.5]

[[formulations]]
stage = "cluster"
models = ["cluster_near"]
solvers = ["auto"]
kappa = 0.5
"""
EDITS = (
    ("import ClusterData, Spec", "import ClusterData, Parameter, Spec"),
    (
        'title="what it is, in a line for lists")',
        'title="near", parameters={"kappa": Parameter(0, 1, 0.1, "worth of a cell")})',
    ),
    ('name="x")\n', 'name="x")\n    kappa = cp.Parameter(nonneg=True, name="kappa")\n'),
    (
        "cp.Maximize(cp.sum(cp.multiply(data.w, x)))",
        "cp.Maximize(cp.sum(cp.multiply(data.w, x))"
        " - kappa * cp.sum(cp.multiply(data.walk_to_cluster, x)))",
    ),
)
"""What a user writes into the blank file: a distance, and a weight on it."""


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a mission; runs are done in this process, which is all that is unlike a user's."""
    shutil.copy(INSTANCES / "two_rooms.json", tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    for module in (comparison, runner):
        monkeypatch.setattr(module, "locally", lambda jobs=1: runner.here)
    yield tmp_path
    registry.reload_models()


def saved_while_watching(patch: pytest.MonkeyPatch, file: Path) -> None:
    """Save `file` with one edit after the other, each at a look of the watch; then Ctrl-C."""
    edits = list(EDITS)

    def saves() -> Iterator[None]:
        text = file.read_text()
        for old, new in edits:
            assert text.count(old) == 1
            text = text.replace(old, new)
            before = file.stat().st_mtime_ns
            file.write_text(text)
            os.utime(file, ns=(before + 10**9, before + 10**9))
            yield  # a look sees that it is another,
            yield  # and the next that it is whole
        os.kill(os.getpid(), signal.SIGINT)
        yield

    saving = saves()
    patch.setattr(watch.time, "sleep", lambda _: next(saving))


def test_a_new_user_gets_from_a_blank_file_to_a_report(
    workplace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def msmrta(*arguments: str) -> str:
        status = cli.run(list(arguments))
        told = capsys.readouterr()
        assert status == 0, told.err
        return told.out

    mission, own = "two_rooms.json", ["--models", "."]
    msmrta("new-model", "cluster_near", "--blank", "cluster", "--to", ".")
    before = msmrta("solve", "cluster_near", mission, *own)
    saved_while_watching(monkeypatch, workplace / "cluster_near.py")
    watched = msmrta("watch", "cluster_near", mission, *own)
    assert "broken: " in watched  # the weight is used before it is declared
    assert "cluster_near.py, save 4:" in watched
    assert "  costs changed (" in watched
    assert "  objective: " in watched
    assert msmrta("solve", "cluster_near", mission, *own, "--param", "kappa=1") != before

    three = ["--solvers", "auto,highs,scip", "--json", "rows.json"]
    given = [*own, "--models", "cluster_printed", "--stage", "cluster", "--param", "kappa=0.5"]
    msmrta("compare", mission, *given, *three, "--no-scores")
    rows = json.loads((workplace / "rows.json").read_text())
    worth: dict[str, set[float]] = {}
    for row in rows:
        worth.setdefault(row["model"], set()).add(round(row["objective"], 6))
    assert {name: len(values) for name, values in worth.items()} == {
        "cluster_near": 1,
        "cluster_printed": 1,
    }
    assert len(rows) == 6

    pieces = msmrta("tradeoff", mission, *own, "--over", "kappa", "--model", "cluster_near")
    assert "cluster_near over kappa" in pieces
    chosen = ["--cluster-model", "cluster_near", "--param", "kappa=0.5", "--json", "plan.json"]
    msmrta("plan", mission, *own, *chosen)
    plan = Plan.read(workplace / "plan.json")
    assert plan.certificates[0].parameters == {"kappa": 0.5}
    assert plan.options["kappa"] == 0.5
    assert "the plan holds" in msmrta("check", "plan.json", mission, *own)

    (workplace / "study.toml").write_text(STUDY)
    msmrta("study", "run", "study.toml")
    msmrta("study", "report", "study.toml")
    assert "kappa = 0.5" in (workplace / "study-report" / "report.html").read_text()
