"""A baseline says what changed, and nothing else."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.analysis.agreement import disagreements
from msmrta_opt.studies.analysis.regression import FORMAT, changes, read_baseline, save_baseline
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.solves import documents_of, record_of_row

ROW = {
    "instance": "paper",
    "stage": "cluster",
    "model": "model",
    "solver": "highs",
    "seed": 3,
    "status": "optimal",
    "sense": "max",
    "objective": 5.0,
    "bound": 5.0,
    "gap": 0.0,
    "check": "passed",
    "total_seconds": 1.0,
}
OLD = record_of_row(ROW)


def now(**changes: Any) -> Record:
    return record_of_row(ROW | changes)


WHERE = "model on paper by highs, seed 3: "


def test_a_baseline_reads_as_it_was_saved(tmp_path: Path) -> None:
    rows = [OLD, now(seed=None, status="error", objective=None, message="“why”")]
    save_baseline(rows, tmp_path / "baseline.json")
    assert documents_of(read_baseline(tmp_path / "baseline.json")) == documents_of(rows)


def test_nothing_changed_is_nothing_said() -> None:
    assert changes([OLD], [OLD], slower=1.5) == []


@pytest.mark.parametrize(
    ("changed", "lines"),
    [
        ({"status": "feasible"}, ["status feasible, was optimal"]),
        ({"objective": 5.1}, ["objective 5.1, was 5"]),
        ({"objective": None}, ["objective none, was 5"]),
        ({"bound": 4.0}, ["bound 4, was 5"]),
        ({"check": "row 1"}, ["check row 1, was passed"]),
        ({"total_seconds": 2.1}, ["took 2.1 s, was 1 s"]),
        ({"status": "error", "check": ""}, ["status error, was optimal", "check none, was passed"]),
    ],
)
def test_a_change_is_one_line(changed: dict[str, Any], lines: list[str]) -> None:
    assert changes([OLD], [now(**changed)], slower=2.0) == [WHERE + line for line in lines]


@pytest.mark.parametrize(
    "changed",
    [
        {"objective": 5.0 + 4e-6, "bound": 5.0 - 4e-6},  # the tolerance is 1e-6 of 5
        {"total_seconds": 1.9},
        {"total_seconds": None},
        {"nodes": 7, "solver_version": "2", "machine": "other", "message": "other"},
    ],
)
def test_what_differs_from_run_to_run_is_no_change(changed: dict[str, Any]) -> None:
    assert changes([OLD], [now(**changed)], slower=2.0) == []


def test_times_are_compared_only_when_asked_for() -> None:
    assert changes([OLD], [now(total_seconds=100.0)]) == []


def test_a_quick_solve_is_never_called_slower() -> None:
    old, new = now(total_seconds=0.001), now(total_seconds=0.09)
    assert changes([old], [new], slower=2.0) == []


def test_where_a_limit_stopped_both_values_may_differ() -> None:
    old = now(status="feasible", bound=7.0)
    assert changes([old], [now(status="feasible", objective=4.0, bound=6.0)]) == []


@pytest.mark.parametrize("unit", [1e-6, 1e-3, 1e3, 1e9])
def test_a_change_is_found_in_any_unit_of_time(unit: float) -> None:
    old = now(objective=5 * unit, bound=5 * unit)
    assert changes([old], [old]) == []
    assert changes([old], [now(objective=5.1 * unit, bound=5 * unit)]) != []


@pytest.mark.parametrize("unit", [1e-12, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize("constant", [0.0, 1e9, -1e12])
def test_a_change_is_found_beside_any_constant(unit: float, constant: float) -> None:
    """A constant of 1e9 makes 176 and 300 alike to 1e-6 of both values."""
    if unit < 1e-9 * abs(constant):
        return  # which no float holds
    old, same, other = (
        now(objective=constant + x * unit, bound=constant + x * unit, objective_size=x * unit)
        for x in (176, 176 + 1e-5, 300)
    )
    assert changes([old], [same]) == []
    assert len(changes([old], [other])) == 2
    claim = replace(other, solver="scip")
    assert len(disagreements([old, claim])) == 1
    assert disagreements([old, replace(same, solver="scip")]) == []


def test_a_change_of_a_long_number_is_told_in_full() -> None:
    old, new = (now(objective=x, bound=x, objective_size=1.0) for x in (1e9 + 176, 1e10 + 300))
    assert changes([old], [new])[0] == f"{WHERE}objective 10000000300, was 1000000176"


@pytest.mark.parametrize("field", ["objective", "bound", "gap", "total_seconds"])
@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_numbers_that_are_not_finite_are_refused(tmp_path: Path, field: str, number: str) -> None:
    path = tmp_path / "baseline.json"
    rows = json.dumps({"format": FORMAT, "rows": [ROW | {field: "here"}]})
    path.write_text(rows.replace('"here"', number))
    with pytest.raises(InputError, match=field):
        read_baseline(path)


def test_missing_and_new_solves_are_listed() -> None:
    other = now(solver="scip")
    assert changes([OLD], [other]) == [
        WHERE + "was there before, is missing",
        "model on paper by scip, seed 3: was not there before",
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "broken JSON"),
        ("[]", "not a comparison"),
        ('{"format": "msmrta-plan/1"}', "not a comparison"),
        (json.dumps({"format": FORMAT}), "rows"),
        (json.dumps({"format": FORMAT, "rows": {}}), "rows"),
        (json.dumps({"format": FORMAT, "rows": [1]}), r"rows\[0\]"),
        (json.dumps({"format": FORMAT, "rows": [{"instance": "a"}]}), r"rows\[0\]\.stage"),
    ],
)
def test_a_broken_baseline_is_one_line_that_names_the_file(
    tmp_path: Path, text: str, said: str
) -> None:
    path = tmp_path / "baseline.json"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        read_baseline(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("field", "value"), [("objective", "five"), ("status", "splendid"), ("seed", 1.5)]
)
def test_a_baseline_with_a_wrong_value_is_refused(
    tmp_path: Path, field: str, value: object
) -> None:
    path = tmp_path / "baseline.json"
    save_baseline([OLD], path)
    document = json.loads(path.read_text())
    document["rows"][0][field] = value
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=rf"rows\[0\]\.{field}"):
        read_baseline(path)


def test_a_missing_baseline_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_baseline(tmp_path / "none.json")
