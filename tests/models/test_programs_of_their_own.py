"""Models that read nothing of the mission: programs of their own, which every command but plans takes.

Each has a value by hand. They are of the sizes at which solvers and tolerances slip.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from msmrta_opt import cli, formulations
from msmrta_opt.mission.errors import ModelError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.studies.analysis.score import scores

PAPER = "paper"
HEAD = '''"""A program of its own."""
import cvxpy as cp
import numpy as np
from msmrta_opt.optimise.formulation import Parameter, Spec

SPEC = Spec(stage="cluster", title="a program of its own"{more})


def build(data):
'''
COVER = """
    x = cp.Variable(4, boolean=True, name="x")
    cost = {unit} * np.array([3.0, 5.0, 4.0, 9.0])
    enough = (np.array([2.0, 3.0, 2.0, 5.0]) @ x >= 5).set_label("enough")
    return cp.Problem(cp.Minimize(cost @ x + {constant}), [enough, x[0] + x[2] <= 1])
"""
SWITCH = """
    x = cp.Variable(bounds=[0, 10], name="x")
    z = cp.Variable(boolean=True, name="z")
    return cp.Problem(cp.Maximize(x - 3 * z), [(x <= {big} * z).set_label("switch")])
"""
STEPS = """
    x = cp.Variable(integer=True, bounds=[0, 5], name="x")
    y = cp.Variable(boolean=True, name="y")
    return cp.Problem(cp.Maximize(x - y), [(x <= {big} * y).set_label("open")])
"""
WEIGH = """
    x = cp.Variable(4, boolean=True, name="x")
    weights = np.array([{heavy}, {heavy}, {heavy}, {light}])
    return cp.Problem(cp.Minimize(x[0]), [(weights @ x == {whole}).set_label("balance")])
"""
SHIFT = """
    x = cp.Variable(2, boolean=True, name="x")
    shift = (np.array([{first}, {second}]) @ x <= {length}).set_label("the shift")
    return cp.Problem(cp.Minimize(cp.sum(x)), [(x >= 1).set_label("task {{t}} is done"), shift])
"""
WAIT = """
    x = cp.Variable(integer=True, bounds=[0, 1e12], name="x")
    return cp.Problem(cp.Minimize(x), [({unit} * x >= {second}).set_label("long enough")])
"""
LEVEL = """
    a, b, d, e = (cp.Variable(boolean=True, name=name) for name in "abde")
    c = cp.Variable(integer=True, bounds=[0, 4], name="c")
    z = cp.Variable(bounds=[0, 24], name="z")
    rows = [
        7 * b + 4 * d + z == 14,
        5 * z <= 17 + 5 * c,
        6 * a + 2 * c + 7 * e + 8 * z >= 67,
        7 * z >= 44 + 9 * a,
    ]
    return cp.Problem({sense}({cost} * (a + b + c + d + e + z)), rows)
"""
RIGHT: dict[str, tuple[str, float | None]] = {
    "level_max": (LEVEL.format(sense="cp.Maximize", cost=1), 13),
    "level_min": (LEVEL.format(sense="cp.Minimize", cost=1), 13),
    "level_any": (LEVEL.format(sense="cp.Maximize", cost=0), 0),
    "level_less": (LEVEL.format(sense="cp.Maximize", cost=-0.5), -6.5),
    "cover": (COVER.format(unit=1, constant=0), 8),
    "cover_tiny": (COVER.format(unit=1e-7, constant=0), 8e-7),
    "cover_tinier": (COVER.format(unit=1e-10, constant=0), 8e-10),
    "cover_huge": (COVER.format(unit=1e8, constant=0), 8e8),
    "cover_and_1e9": (COVER.format(unit=1, constant=1e9), 1e9 + 8),
    "cover_less_1e9": (COVER.format(unit=1, constant=-1e9), 8 - 1e9),
    "cover_and_1e12": (COVER.format(unit=1, constant=1e12), 1e12 + 8),
    "switch_1e4": (SWITCH.format(big=1e4), 7),
    "switch_1e7": (SWITCH.format(big=1e7), 7),
    "switch_1e9": (SWITCH.format(big=1e9), 7),
    "steps_1e9": (STEPS.format(big=1e9), 4),
    "steps_1e16": (STEPS.format(big=1e16), 4),
    "steps_1e20": (STEPS.format(big=1e20), 4),
    "weigh": (WEIGH.format(heavy=1e9, light=100.0, whole=999999998), None),
    "weigh_less": (WEIGH.format(heavy=1e9, light=1.0, whole=1000000002), None),
    "weigh_more": (WEIGH.format(heavy=1e9, light=100.0, whole=1000000100), 0),
    "weigh_all": (WEIGH.format(heavy=1e9, light=1.0, whole=3000000001), 1),
    "shift": (SHIFT.format(first=14400001.0, second=14400000.0, length=28800000), None),
    "shift_8_hours": (SHIFT.format(first=28800000.0, second=1.0, length=28800000), None),
    "shift_just": (SHIFT.format(first=14400000.0, second=14400000.0, length=28800000), 2),
    "wait": (WAIT.format(unit=1e-9, second=1), 1e9),
    "wait_half": (WAIT.format(unit=1e-8, second=0.5), 5e7),
    "wait_a_little": (WAIT.format(unit=1e-9, second=3e-9), 3),
}
DECLARED = ', parameters={"k": Parameter(0, 3, 1, "how many")}'
QUOTA = """
    k = cp.Parameter(integer=True, name="k")
    x = cp.Variable(3, boolean=True, name="x")
    return cp.Problem(cp.Maximize(cp.sum(x)), [(cp.sum(x) <= k).set_label("quota")])
"""


@pytest.fixture(autouse=True)
def nothing_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The folder of a test, and what it loads from there, are gone afterwards."""
    monkeypatch.setattr(formulations, "__path__", list(formulations.__path__))
    yield
    for path in tmp_path.glob("*.py"):
        sys.modules.pop(f"{formulations.__name__}.{path.stem}", None)


@pytest.fixture
def solved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[dict, str]]:
    """What `msmrta solve` says of a program, as JSON has it, and on the screen."""

    def run(name: str, *more: str) -> tuple[dict, str]:
        (tmp_path / f"{name}.py").write_text(HEAD.format(more="") + RIGHT[name][0])
        found = tmp_path / "found.json"
        line = ["solve", name, PAPER, "--models", str(tmp_path), "--json", str(found), *more]
        assert cli.run(line) in (0, 1)
        return json.loads(found.read_text()), capsys.readouterr().out

    return run


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
def test_a_program_of_its_own_has_its_optimum_or_none_that_passes(
    name: str, solver: str, solved: Callable[..., tuple[dict, str]]
) -> None:
    found, shown = solved(name, "--solver", solver)
    right = RIGHT[name][1]
    assert "reads nothing of the mission" in shown
    if right is None:
        assert found["status"] == "infeasible" if solver == "auto" else found["objective"] is None
    elif solver == "auto":
        assert found["status"] == "optimal"
    if right is not None and found["status"] in ("optimal", "claimed"):
        # Relative to itself, without the constant: 8 in 1e12 + 8, too.
        assert found["objective"] == pytest.approx(right, rel=1e-13, abs=1e-15)
        assert found["bound"] == pytest.approx(right, rel=1e-13, abs=1e-15)


def test_a_value_with_a_large_constant_is_shown_in_full(
    solved: Callable[..., tuple[dict, str]],
) -> None:
    assert " 1000000008 (min)" in solved("cover_and_1e9")[1]


@pytest.mark.parametrize(
    ("name", "why"),
    [("switch_1e7", "with a big M reduced to what is needed"), ("level_max", "by branching")],
)
def test_where_there_are_no_dual_values_it_is_said_why(
    name: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / f"{name}.py").write_text(HEAD.format(more="") + RIGHT[name][0])
    assert cli.run(["explain", name, PAPER, "--models", str(tmp_path)]) == 0
    assert f"No dual values: the optimum was found {why}." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("value", "right"), [("2", 2), ("0", 0), ("3", 3), ("0.5", None), ("2.999", None), ("4", None)]
)
def test_a_whole_number_parameter_takes_no_fraction_and_keeps_to_its_range(
    value: str, right: float | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "quota.py").write_text(HEAD.format(more=DECLARED) + QUOTA)
    found = tmp_path / "found.json"
    asked = ["quota", PAPER, "--models", str(tmp_path), "--param", f"k={value}"]
    assert cli.run(["solve", *asked, "--json", str(found)]) == (2 if right is None else 0)
    if right is None:
        assert cli.run(["explain", *asked]) == 2
        errors = capsys.readouterr().err.splitlines()
        assert len(errors) == 2
        assert all("k: " in error for error in errors)
        assert not found.exists()
    else:
        assert json.loads(found.read_text())["objective"] == right


@pytest.mark.parametrize(
    "line",
    [
        ("plan", PAPER, "--cluster-model", "quota"),
        ("tradeoff", PAPER, "--over", "k", "--model", "quota"),
    ],
    ids=lambda line: line[0],
)
def test_no_plan_follows_from_it(
    line: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "quota.py").write_text(HEAD.format(more=DECLARED) + QUOTA)
    assert cli.run([*line, "--models", str(tmp_path)]) == 2
    assert "reads nothing of its data" in capsys.readouterr().err


def test_there_is_no_plan_of_it_to_measure(tmp_path: Path, instances_dir: Path) -> None:
    (tmp_path / "cover.py").write_text(HEAD.format(more="") + RIGHT["cover"][0])
    registry.add_models(tmp_path)
    paper = Instance.read(instances_dir / "paper.json")
    found = scores([paper], stage="cluster", models=["cover"], options=StagedOptions())
    assert list(found) == []


@pytest.mark.parametrize(
    ("body", "reads"),
    [
        ("    return data.w", True),
        ("    return [data.w[i] for i in range(2)]", True),
        ("    def inner():\n        return data.w\n    return inner()", True),
        ("    return (lambda: data)()", True),
        ("    w = data\n    return w", True),
        ("    pass", False),
        ("    name = 'data'\n    return name", False),
        ("    return (lambda data: data)(1)", False),
    ],
)
def test_whether_a_model_reads_its_data(body: str, reads: bool, tmp_path: Path) -> None:
    (tmp_path / "probe.py").write_text(HEAD.format(more="") + body + "\n")
    registry.add_models(tmp_path)
    assert registry.get("probe").reads_data == reads
    if not reads:
        with pytest.raises(ModelError, match="reads nothing of its data"):
            registry.for_plans("probe", "cluster")


def test_every_shipped_model_reads_its_data() -> None:
    found = [item.formulation for item in registry.models() if item.formulation]
    assert len(found) >= 18
    assert all(item.reads_data for item in found if registry.is_shipped(item))
