"""The checkers stand on the mission alone: no planner, no solver, no scipy, on import or in use."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import msmrta_opt.certify as certify
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan as make_plan

MODULES = sorted(path.stem for path in Path(certify.__path__[0]).glob("[!_]*.py"))
FOREIGN = (
    *(
        "cvxpy",
        "scipy",
        "highspy",
        "pyscipopt",
        "ortools",
        "swiglpk",
        "networkx",
        "sklearn",
        "pandas",
    ),
    *(f"msmrta_opt.{name}" for name in ("optimise", "routing", "stages", "planners", "plots")),
    *(f"msmrta_opt.{name}" for name in ("studies", "cli", "formulations")),
)


def loaded(code: str) -> list[str]:
    """What of `FOREIGN` a fresh process has loaded once it has run `code`."""
    seen = f"import json, sys\n{code}\nprint(json.dumps(sorted(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", seen], capture_output=True, text=True, check=True)
    modules = json.loads(run.stdout.splitlines()[-1])
    return [m for m in modules if any(m == name or m.startswith(f"{name}.") for name in FOREIGN)]


def test_no_checker_loads_anything_but_the_mission() -> None:
    assert "plan" in MODULES
    assert loaded("\n".join(f"import msmrta_opt.certify.{module}" for module in MODULES)) == []


@pytest.mark.parametrize("objective", ["total_time", "latency"])
def test_checking_a_plan_with_its_bound_loads_nothing_more(
    objective: str, instances_dir: Path, tmp_path: Path
) -> None:
    mission = Instance.read(instances_dir / "scouted.json")
    plan = make_plan(mission, planner="exact", objective=objective)  # type: ignore[arg-type]
    plan.save(tmp_path / "plan.json")
    code = f"""
from msmrta_opt.certify.certificates import recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.plan import Plan
plan = Plan.read({str(tmp_path / "plan.json")!r})
assert plan.scouting is not None
assert problems(plan) == []
assert recheck(plan)[0].problems == ()
"""
    assert loaded(code) == []


def test_this_test_would_see_scipy() -> None:
    assert "scipy" in loaded("import scipy.optimize")
