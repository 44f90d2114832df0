"""Solver regression in one call, as a fixture of pytest, and from the command line."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.studies import solved_here

import msmrta_opt as mo
from msmrta_opt import cli
from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.analysis.regression import read_baseline
from msmrta_opt.studies.baselines import faults
from msmrta_opt.studies.solves import documents_of, record_of_row

WHAT: dict[str, Any] = {"models": ["cluster_printed"], "solvers": ["auto", "highs"]}
COMPARE = ["compare", "corridor", "--models", "cluster_printed", "--solvers", "auto,highs"]


@pytest.fixture(autouse=True, scope="module")
def here() -> Iterator[None]:
    with solved_here():
        yield


@pytest.fixture
def baseline(tmp_path: Path) -> Path:
    path = tmp_path / "baseline.json"
    assert mo.against_baseline(path, ["corridor"], update=True, **WHAT).written
    return path


def edit(path: Path, **changes: Any) -> None:
    """Change the first row of a baseline."""
    document = json.loads(path.read_text())
    document["rows"][0] |= changes
    path.write_text(json.dumps(document))


def test_a_baseline_is_one_row_a_line_without_what_is_not_known(baseline: Path) -> None:
    first, *rows, last = baseline.read_text().splitlines()
    assert first == '{"format": "msmrta-comparison/1", "rows": ['
    assert last == "]}"
    solvers = [json.loads(row.rstrip(","))["solver"] for row in rows]
    assert solvers == ["auto", "highs"]
    assert "null" not in baseline.read_text()


def test_a_baseline_of_before_still_reads(baseline: Path, tmp_path: Path) -> None:
    rows = read_baseline(baseline)
    old = {"format": "msmrta-comparison/1", "rows": documents_of(rows)}
    (tmp_path / "old.json").write_text(json.dumps(old, indent=1) + "\n")
    assert documents_of(read_baseline(tmp_path / "old.json")) == documents_of(rows)


def test_nothing_has_changed_against_what_was_just_written(baseline: Path) -> None:
    found = mo.against_baseline(baseline, ["corridor"], **WHAT)
    assert found.lines == []
    assert repr(found) == "Verdict(2 solves: nothing wrong or changed)"
    assert not found.written


def test_a_change_is_told_and_update_writes_that_row_alone(baseline: Path) -> None:
    kept = baseline.read_text().splitlines()
    edit(baseline, objective=99.0)
    found = mo.against_baseline(baseline, ["corridor"], **WHAT)
    assert [line.split(": objective")[0] for line in found.lines] == [
        "cluster_printed on corridor by auto"
    ]
    assert mo.against_baseline(baseline, ["corridor"], update=True, **WHAT).written
    now = baseline.read_text().splitlines()
    assert now[2] == kept[2]  # its times are those of before, too
    assert json.loads(now[1].rstrip(","))["objective"] != 99.0


def test_another_version_or_node_count_is_information(baseline: Path) -> None:
    edit(baseline, solver_version="0.1", n_rows=77)
    found = mo.against_baseline(baseline, ["corridor"], **WHAT)
    assert found.lines == []
    assert found.regression is not None
    assert any(line.endswith("was 0.1") for line in found.regression.information)
    assert any("was 77" in line for line in found.regression.information)


def test_without_a_baseline_it_is_said_how_to_write_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no baseline yet; write it with update=True"):
        mo.against_baseline(tmp_path / "none.json", ["corridor"], **WHAT)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"solve_seconds": -1.0}, "solve_seconds: -1.0; give a number, 0 or more"),
        ({"total_seconds": -0.5}, "total_seconds: -0.5; give a number, 0 or more"),
        ({"nodes": -2}, "nodes: -2; give a number, 0 or more"),
        ({"sense": "least"}, "sense: 'least'; give one of min, max"),
    ],
)
def test_a_row_that_no_solve_can_have_is_refused(
    wrong: dict[str, Any], field: str, baseline: Path
) -> None:
    edit(baseline, **wrong)
    with pytest.raises(InputError) as caught:
        read_baseline(baseline)
    assert str(caught.value) == f"{baseline}: rows[0].{field}"


def test_a_solve_that_a_baseline_has_twice_is_refused(baseline: Path) -> None:
    edit(baseline, solver="highs", objective=1e9)
    with pytest.raises(InputError) as caught:
        read_baseline(baseline)
    assert str(caught.value) == (
        f"{baseline}: rows[1]: cluster_printed on corridor by highs is given twice; "
        "give each solve once"
    )


def test_contradictions_failed_checks_and_errors_are_no_baseline() -> None:
    row = {
        "instance": "paper", "stage": "cluster", "model": "m", "solver": "a", "status": "optimal",
        "sense": "max", "objective": 5.0, "bound": 5.0, "check": "passed",
    }  # fmt: skip
    rows = [
        record_of_row(row),
        record_of_row({**row, "solver": "b", "objective": 4.0, "bound": 4.0}),
        record_of_row({**row, "solver": "c", "check": "row 1 is missed"}),
        record_of_row({**row, "solver": "d", "status": "error", "message": "no licence"}),
    ]
    found = faults(rows)
    assert any("a has 5, but b proves that nothing is better than 4" in line for line in found)
    assert "m on paper by c: check: row 1 is missed" in found
    assert "m on paper by d: no licence" in found
    assert faults(rows[:1]) == []


# From the command line


def test_update_shows_the_change_then_writes_it(
    baseline: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    edit(baseline, objective=99.0)
    line = [*COMPARE, "--no-scores", "--against", str(baseline)]
    assert cli.run(line) == 1
    assert cli.run([*line, "--update"]) == 0
    told = capsys.readouterr().out
    assert told.count("changed: cluster_printed on corridor by auto: objective") == 2
    assert f"baseline written to {baseline}" in told
    assert cli.run(line) == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--update"], "--update: goes with a baseline; give --against FILE"),
        (["--update", "--against", "BASELINE", "--save", "x.json"], "leave out --save"),
        (["--against", "BASELINE", "--junit", "BASELINE"], "would overwrite what is read"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    options: list[str], said: str, baseline: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(baseline) if word == "BASELINE" else word for word in options]
    assert cli.run([*COMPARE, *words]) == 2
    assert said in capsys.readouterr().err


# As a fixture of pytest

TEST = """
def test_it(msmrta_baseline):
    msmrta_baseline("b.json", ["corridor"], models=["cluster_printed"], solvers=["auto"])
"""
pytest_plugins = ["pytester"]


@pytest.fixture
def suite(pytester: pytest.Pytester) -> Callable[..., pytest.RunResult]:
    """Run a test suite of one test; the plugin is loaded by name, as it is by its entry point."""
    pytester.makepyfile(TEST)
    plugin = ("-p", "msmrta_opt.studies.pytest_plugin", "-p", "no:cacheprovider")
    return lambda *options: pytester.runpytest_inprocess(*plugin, *options)


def test_the_fixture_writes_holds_and_fails_with_a_line_a_change(
    suite: Callable[..., pytest.RunResult], pytester: pytest.Pytester
) -> None:
    missing = suite()
    missing.assert_outcomes(failed=1)
    missing.stdout.fnmatch_lines(["*no baseline yet; pytest --msmrta-update writes it*"])
    suite("--msmrta-update").assert_outcomes(passed=1)
    suite().assert_outcomes(passed=1)
    edit(pytester.path / "b.json", status="infeasible")
    changed = suite()
    changed.assert_outcomes(failed=1)
    changed.stdout.fnmatch_lines(
        ["*cluster_printed on corridor by auto: status optimal, was infeas*"]
    )
