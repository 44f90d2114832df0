"""A right model with one edit: told in one true line by `solve` and `plan` alike, and gives no plan.

The model has loads, a big M and two parameters; those of ``wrong/`` are edits of another.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path

import pytest

from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.solve import solve
from msmrta_opt.stages.data import stage_data

OFFICE = Path(__file__).parent / "wrong" / "office.json"
RIGHT = '''"""Victims to robots, with overtime paid for."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="overtime beyond a common shift is paid for",
    parameters={
        "shift": Parameter(0, 1000, 100, "length of the shift, time units"),
        "kappa": Parameter(0, 1000, 50, "price of overtime"),
    },
)


def build(data: VictimData) -> cp.Problem:
    n, m = data.success.shape
    shift = cp.Parameter(nonneg=True, name="shift")
    kappa = cp.Parameter(nonneg=True, name="kappa")
    x = cp.Variable((n, m), boolean=True, bounds=[0, data.can_serve], name="x")
    z = cp.Variable(n, boolean=True, name="z")
    load = cp.Variable(n, nonneg=True, name="load")
    extra = (data.success - data.busy[:, None]) * data.can_serve
    big = float((data.busy + extra.sum(axis=1)).max())
    return cp.Problem(
        cp.Minimize(cp.sum(load) + kappa * cp.sum(z)),
        [
            (cp.sum(x, axis=0) == data.can_serve.any(axis=0)).set_label("victim {v} is served"),
            (load == data.busy + cp.sum(cp.multiply(extra, x), axis=1)).set_label("load of {r}"),
            (load <= shift + big * z).set_label("robot {r} in its shift or overtime"),
        ],
    )
'''
MATRIX = '(n, m), boolean=True, bounds=[0, data.can_serve], name="x"'
SIZE = "float((data.busy + extra.sum(axis=1)).max())"
LOADS = "cp.sum(cp.multiply(extra, x), axis=1)"
LAST = "load <= shift + big * z"
Edits = list[tuple[str, str]]
WRONG: dict[str, tuple[Edits, int, str]] = {
    # The edits, the exit status, and what is said.
    "shape": ([(MATRIX, '(m, n), boolean=True, name="x"')], 2, "build(data) failed: "),
    "transposed": (
        [
            (MATRIX, '(m, n), boolean=True, name="x"'),
            ("cp.sum(x, axis=0)", "cp.sum(x, axis=1)"),
            (LOADS, "cp.sum(cp.multiply(extra.T, x), axis=0)"),
        ],
        2,
        "has shape (7, 3), transposed, where the stage reads robots by victims, (3, 7)",
    ),
    "no_boolean": (
        [("(n, m), boolean=True,", "(n, m),")],
        2,
        "x is continuous, but the stage reads 0 or 1 and rounds nothing",
    ),
    "field": ([("== data.busy", "== data.bussy")], 2, "no attribute 'bussy'; did you mean busy?"),
    "infeasible": ([(LAST, "load <= 0.001 * shift + 0 * z")], 1, "infeasible"),
    "unused": (
        [
            ('    shift = cp.Parameter(nonneg=True, name="shift")\n', ""),
            (LAST, "load <= 100 + big * z"),
        ],
        2,
        "nothing uses parameter shift that SPEC declares",
    ),
    "stage": ([('"victim",', '"victims",')], 2, "stage 'victims'; give one of clustering, cluster"),
    "no_name": ([(', name="x")', ")")], 2, "no variable is called 'x'"),
    "small_m": ([(SIZE, "1.0")], 1, "infeasible"),
    "unbounded": (
        [
            ("Minimize", "Maximize"),
            ("load == data", "load >= data"),
            (LAST, "0 <= shift + big * z"),
        ],
        1,
        "improves without end by more load[0]",
    ),
    "label": (
        [("victim {v} is", "victim {v} of {r} is")],
        2,
        "does not fit its constraint, of shape (7,); name in braces what that runs over: {v}",
    ),
    "unservable": (
        [(", bounds=[0, data.can_serve]", "")],
        2,
        "x[1,1] may be 1 where data.can_serve is false (robot 1, victim 1)",
    ),
    # Neighbours.
    "huge_m": ([(SIZE, "1e9")], 2, "a big M through whose tolerance a solution slips"),
    "name_twice": ([('name="load"', 'name="z"')], 2, "two variables are called 'z'"),
}
SAME: dict[str, Edits] = {
    "as_it_is": [],
    "kappa_of_any_sign": [('nonneg=True, name="kappa"', 'name="kappa"')],
    "m_just_enough": [(SIZE, f"{SIZE} - 100")],
    "boolean_by_bounds": [("boolean=True, bounds=[0, d", "integer=True, bounds=[0, d")],
}
"""Edits that leave the model right."""


def edited(folder: Path, name: str, edits: Edits) -> str:
    """Write the model after `edits`; its name."""
    text = RIGHT
    for old, new in edits:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (folder / f"{name}.py").write_text(text)
    return name


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_edit_is_told_and_gives_no_plan(
    name: str, folder: Path, told: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    edits, right, words = WRONG[name]
    model = edited(folder, f"office_{name}", edits)
    written = tmp_path / "plan.json"
    for line in (
        ("solve", model, OFFICE),
        ("plan", OFFICE, "--victim-model", model, "--json", written),
    ):
        status, said = told(*line)
        assert (status, words in said) == (right, True), said
    assert not written.exists()


@pytest.mark.parametrize("name", SAME)
def test_a_right_edit_leaves_the_optimum_of_all_assignments(name: str, folder: Path) -> None:
    data = stage_data(Instance.read(OFFICE), "victim")
    able = [[r for r in range(3) if data.can_serve[r, v]] for v in range(7)]
    worth = []
    for takers in product(*(robots for robots in able if robots)):
        load = data.busy.copy()
        for v, r in zip((v for v in range(7) if able[v]), takers, strict=True):
            load[r] += data.success[r, v] - data.busy[r]
        worth.append(load.sum() + 50 * (load > 100).sum())
    assert min(worth) == pytest.approx(1276 / 3)
    found = solve(edited(folder, f"right_{name}", SAME[name]), data)
    assert (found.status, found.objective) == ("optimal", pytest.approx(1276 / 3))
