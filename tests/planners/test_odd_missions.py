"""Random missions with odd features, by every planner: checked by the package and by the tests' own.

What the exact planner claims is held against all plans there are.
"""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from support import small_checker
from support.odd_missions import odd_mission, odd_options

from msmrta_opt.certify.certificates import recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError, NoPlanError
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import planners

QUICK, LARGE = 20, 2_000
EACH = 20
"""Missions of one test."""
ROUNDING = Fraction(1, 10**6)


def wrong_with(plan: Plan) -> list[str]:
    """What either checker has against a plan and its claims."""
    document = json.loads(json.dumps(plan.document()))
    wrong = problems(plan) + small_checker.faults(document)
    if plan.planner != "exact" or wrong:
        return wrong
    (certificate,) = plan.certificates
    best = small_checker.minimum(document, certificate.model)
    worth = small_checker.worth(document, certificate.model)
    if best is None or worth < best * (1 - ROUNDING):
        wrong.append(f"a plan worth {float(worth)}, where the best is worth {best}")
        return wrong
    if certificate.bound is None or Fraction(certificate.bound) > best * (1 + ROUNDING):
        wrong.append(f"the bound {certificate.bound} is above the optimum {float(best)}")
    if certificate.status == "optimal" and worth > best * (1 + ROUNDING):
        wrong.append(f"{float(worth)} is called optimal, where {float(best)} is")
    return wrong + [line for found in recheck(plan) for line in found.problems]


def wrong_by(name: str, number: int) -> list[str]:
    """What is wrong with a planner's plan of a mission, or with its refusal."""
    mission, options = odd_mission(number), odd_options(number, name)
    try:
        return wrong_with(planners()[name].run(mission, **options))
    except InputError as error:
        scouted = planners()["greedy"].run(mission, seed=options["seed"])
        nothing = scouted.model_copy(update={"planner": name, "options": options})
        limited = isinstance(error, NoPlanError) and error.proven
        if limited and small_checker.minimum(nothing.document(), options["objective"]) is None:
            return []
        return [str(error)]


def findings(number: int) -> list[str]:
    """What is wrong with any planner's plan of a mission."""
    return [f"{number}, {name}: {line}" for name in planners() for line in wrong_by(name, number)]


@pytest.mark.parametrize("first", range(0, QUICK, EACH))
def test_no_planner_is_wrong_on_odd_missions(first: int) -> None:
    assert [line for n in range(first, first + EACH) for line in findings(n)] == []


@pytest.mark.parametrize(("number", "time_limit"), [(2111, 0), (3067, 5)])
def test_bounds_that_the_checker_did_not_prove_are_proved(number: int, time_limit: float) -> None:
    """One robot is so slow that its legs are no part of a good plan, nor to be counted in steps."""
    made = planners()["exact"].run(odd_mission(number), objective="latency", time_limit=time_limit)
    assert wrong_with(made) == []


@pytest.mark.slow
@pytest.mark.parametrize("first", range(QUICK, LARGE, EACH))
def test_no_planner_is_wrong_on_many_odd_missions(first: int) -> None:
    assert [line for n in range(first, first + EACH) for line in findings(n)] == []
