"""Why not another solution: what forbids it, or what it costs and where that comes from."""

from __future__ import annotations

from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import best_value, feasible_points, formulation, program, structured_programs

from msmrta_opt.diagnosis.explain import explain
from msmrta_opt.diagnosis.fixings import fixings, with_bounds, with_rows
from msmrta_opt.diagnosis.forbidden import LACKS, UNREACHED, Forbidden, in_words
from msmrta_opt.diagnosis.why_not import why_not
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.data import ClusterData
from msmrta_opt.optimise.formulation import Parameter
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.stages.data import stage_data


@settings(max_examples=examples(80))
@given(trial=structured_programs(), data=st.data())
def test_the_cost_of_a_value_is_that_of_the_best_point_with_it(
    trial: Program, data: st.DataObject
) -> None:
    best = best_value(trial)
    if best is None:
        return
    column = data.draw(st.integers(0, trial.n_columns - 1))
    value = float(data.draw(st.integers(0, 3)))
    optimum = trial.flat(solve_program(trial).values)
    found = why_not(trial, {column: value}, optimum)
    points = feasible_points(trial)
    points = points[points[:, column] == value]
    if not len(points):
        assert found.status == "forbidden"
        assert found.conflicting == (f"x[{column}] = {value:g} (asked)",)
        return
    values = trial.sign * (points @ trial.cost + trial.offset)
    assert found.objective == pytest.approx(trial.sign * values.min())
    assert found.status == ("optimal" if found.objective == pytest.approx(best) else "costs")
    assert sum(term.change for term in found.terms) == pytest.approx(found.objective - best)


def knapsack() -> cp.Problem:
    """Weights 3, 4, 5 in 7, worth 4, 5, 7: the first two, 9; 3 and 5 are 8, too heavy."""
    x = cp.Variable(3, boolean=True, name="x")
    first = cp.sum(x[:2] @ np.array([4.0, 5])).set_label("small things")
    room = (np.array([3.0, 4, 5]) @ x <= 7).set_label("there is room for 7")
    return cp.Problem(cp.Maximize(first + 7 * x[2]), [room])


def test_the_cost_is_told_by_terms_of_the_objective() -> None:
    found = explain(knapsack(), why_not="x[2]=1").why_not
    assert found is not None
    assert found.text.splitlines() == [
        "Why not x[2] = 1: it costs 2, for the best with it is 7 where 9 is the optimum.",
        "By summands of the objective:",
        "  small things: 9 to 0 (-9)",
        "  7.0 * x[2]: 0 to 7 (+7)",
        "By variables of the objective:",
        "  x[2]: 0 to 7 (+7)",
        "  x[1]: 5 to 0 (-5)",
        "  x[0]: 4 to 0 (-4)",
    ]


def test_what_forbids_values_is_named_with_those_that_are_forbidden() -> None:
    found = explain(knapsack(), why_not={"x[0]": 1, "x[1]": 1, "x[2]": 1}).why_not
    assert found is not None
    assert found.status == "forbidden"
    assert found.against[0] == "there is room for 7"
    assert 1 <= len(found.conflicting) <= 3
    assert found.irreducible
    outside = explain(knapsack(), why_not="x[1]=2").why_not
    assert outside is not None
    assert outside.against == ("x[1] ≤ 1",)
    assert outside.text.splitlines()[1:] == ["  x[1] = 2 (asked)", "  x[1] ≤ 1"]


def test_a_fraction_of_an_integer_is_forbidden_in_whole_numbers() -> None:
    found = explain(knapsack(), why_not="x[1]=0.5").why_not
    assert found is not None
    assert (found.status, found.integrality) == ("forbidden", True)


def test_what_is_as_good_costs_nothing_and_what_is_so_is_said_to_be() -> None:
    ones = np.ones((2, 2))
    data = ClusterData(ones, ones, np.array([1, 1]), ids={"r": ["ada", "bob"], "c": [7, 8]})
    told = []
    for asked in ("x[ada,7]=1", "x[ada, 8] = 1"):
        found = explain("cluster_one_to_one", data, why_not=asked).why_not
        assert found is not None
        assert (found.status, found.cost) == ("optimal", 0)
        told.append(found.text.splitlines()[0].partition(": ")[2])
    assert sorted(told) == [
        "it costs nothing, 2 is the optimum, too.",
        "it is so in the optimum, 2.",
    ]


def test_a_maximum_that_costs_names_the_rows_that_make_it() -> None:
    # Jobs of 3, 2 and 2 on two machines: 4 at best; with the first two on one machine 5.
    x = cp.Variable((2, 3), boolean=True, name="x")
    longest = cp.Variable(name="longest")
    rows = [
        (cp.sum(x, axis=0) == 1).set_label("job {j} has a machine"),
        (x @ np.array([3.0, 2, 2]) <= longest).set_label("machine {m} ends by the longest"),
    ]
    problem = cp.Problem(cp.Minimize(longest), rows)
    found = explain(problem, why_not="x[0,0]=1;x[0,1]=1").why_not
    assert found is not None
    assert [term.name for term in found.terms] == ["longest"]
    assert found.cost == pytest.approx(1)
    assert found.binding == ("machine 0 ends by the longest",)


def test_with_parameters_summands_are_those_of_their_values() -> None:
    def build(data: object) -> cp.Problem:
        share = cp.Parameter(nonneg=True, name="share")
        x = cp.Variable(2, boolean=True, name="x")
        one = (cp.sum(x) == 1).set_label("one")
        return cp.Problem(cp.Maximize(share * x[0] + (1 - share) * x[1]), [one])

    trial = formulation(build, share=Parameter(0, 1, 0.5, "of the first"))
    for share in (0.25, 0.75):
        best = int(share > 0.5)
        found = explain(trial, None, why_not=f"x[{best}]=1", share=share).why_not
        assert found is not None
        assert found.cost == pytest.approx(0.5)
        assert sorted(term.change for term in found.summands) == pytest.approx([-0.75, 0.25])


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("some.txt", "# what I had in mind\nx[0] = 1\n\nx[2] = 0  # not that\n"),
        ("some.json", '{"x[0]": 1, "x[2]": 0}'),
    ],
)
def test_values_are_read_from_a_file(name: str, text: str, tmp_path: Path) -> None:
    trial = program([[1, 1, 1]], 2, 1)
    path = tmp_path / name
    path.write_text(text)
    assert fixings(trial, path) == fixings(trial, str(path)) == {0: 1.0, 2: 0.0}


@pytest.mark.parametrize(
    ("asked", "problem"),
    [
        ("x[3]=1", r"no variable 'x\[3\]'; did you mean x\[2\]\?"),
        ("pay=1", r"no variable 'pay'; there are x\[0\], x\[1\], x\[2\]"),
        ("x[1]=much", "'much' for x"),
        ("x[1]=nan", "'nan' for x"),
        ("x[1]=1;x[1]=0", r"x\[1\] is asked to be 1 and 0; give one"),
        ("=1", "'=1'; give for instance"),
        ({"x[1]": True}, "True for x"),
        ([], "nothing is asked for"),
        (" ", "why_not: ''; give NAME=VALUE"),
        ("none.txt", "none.txt: no such file"),
    ],
)
def test_what_cannot_be_read_is_one_line(asked: object, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        fixings(program([[1, 1, 1]], 2, 1), asked)  # type: ignore[arg-type]


def test_of_a_solution_that_is_not_proven_optimal_no_cost_is_claimed() -> None:
    trial = program([[1, 1]], 1, [1, 2], sense="max")
    found = why_not(trial, {0: 1.0}, np.array([0.0, 0.0]), is_proven=False)
    assert (found.status, found.objective, found.optimum) == ("unknown", 1, 0)
    assert found.text.splitlines()[0].endswith("not both are proven to be the best.")


def test_values_as_rows_and_as_bounds_leave_the_same_points() -> None:
    trial = program([[1, 1, 1]], 2, [1, 2, 3], row_lower=1)
    given = {0: 1.0, 2: 0.0}
    by_rows, by_bounds = (
        feasible_points(with_rows(trial, given)),
        feasible_points(with_bounds(trial, given)),
    )
    assert by_rows.tolist() == by_bounds.tolist() == [[1, 0, 0], [1, 1, 0]]


MISSION = {
    "map": {"rows": ["...@.", "...@."]},
    "capabilities": ["Aid", "Cut", "Lift"],
    "service_time": {"Aid": 1, "Cut": 1, "Lift": 1},
    "robots": [
        {"id": 4, "start": [0, 0], "speed": 1, "capabilities": ["Aid", "Lift"]},
        {"id": 5, "start": [1, 0], "speed": 1, "capabilities": ["Aid"]},
    ],
    "victims": [
        {"id": 20, "cell": [0, 2], "requirements": ["Cut"]},
        {"id": 21, "cell": [0, 4], "requirements": ["Aid"]},
        {"id": 22, "cell": [1, 1], "requirements": ["Aid", "Lift"]},
    ],
}


def test_a_pair_that_the_data_forbids_is_told_by_what_the_mission_lacks() -> None:
    data = stage_data(Instance.from_document(MISSION), "victim")

    def against(robot: int, victim: int) -> tuple[str, ...]:
        found = explain("victim_printed", data, why_not=f"x[{robot},{victim}]=1").why_not
        assert found is not None
        return found.against

    assert against(4, 20) == ("x[4,20] ≤ 0: robot 4 has nothing that is needed at victim 20 (Cut)",)
    assert against(5, 21) == ("x[5,21] ≤ 0: robot 5 cannot reach victim 21",)
    assert against(5, 22) == (
        "x[5,22] ≤ 0: robot 5 finds nothing left to do at victim 22 (an earlier stage took Aid)",
    )


def test_bounds_of_one_robot_are_told_together() -> None:
    why = {f"x[1,{v}] ≤ 0": Forbidden("1", LACKS, str(v), ("Cut",)) for v in (2, 3, 5)} | {
        "x[1,7] ≤ 0": Forbidden("1", UNREACHED, "7")
    }
    assert in_words([*why, "x[2,2] ≥ 0"], why) == (
        "robot 1 has nothing that is needed at victims 2, 3 and 5",
        "robot 1 cannot reach victim 7",
        "x[2,2] ≥ 0",
    )
