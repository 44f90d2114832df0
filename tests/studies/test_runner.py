"""A study goes on from where it was, and no run takes another down."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.studies import do, kept, many_runs, write_study

from msmrta_opt import plan
from msmrta_opt.isolation import Limits
from msmrta_opt.mission.metrics import METRICS
from msmrta_opt.studies.ledger import Ledger
from msmrta_opt.studies.record import MEASURED, Record, frame
from msmrta_opt.studies.runner import pending, run_study
from msmrta_opt.studies.runs import Run, runs
from msmrta_opt.studies.specification import Study

BOTH = """
title = "Planners and formulations"
[[instances]]
maps = "open.map"
robots = 2
victims = [2, 3]
[[planners]]
[[planners]]
planner = "exact"
time_limit = 20
[[formulations]]
stage = "victim"
models = ["victim_one_to_one", "victim_none"]
beta = 0.25
"""

BREAKS = '''
"""Breaks in a way that cannot be caught."""

import os
import time

import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec, VictimData

SPEC = Spec(stage="victim", title="breaks")


def build(data: VictimData) -> cp.Problem:
    {how}
'''


def unmeasured(records: Iterable[Record]) -> list[Record]:
    """The records without what may differ from one time to the next, in the order of keys."""
    blank = {name: getattr(_BLANK, name) for name in MEASURED}
    return sorted((replace(record, **blank) for record in records), key=lambda r: r.key)


_BLANK = Record(instance="")


def test_records_say_what_the_planner_and_the_solver_say(tmp_path: Path) -> None:
    path = write_study(tmp_path, BOTH.replace(', "victim_none"', ""))
    done = do(path)
    assert len(done) == 6
    of = {(r.contender.split(" by ")[0], r.n_victims): r for r in done}
    todo = {(run.contender, run.instance.n_victims): run for run in runs(Study.read(path))}
    staged = plan(todo["msmrta", 3].instance)
    record = of["msmrta", 3]
    assert record.metrics == {name: getattr(staged.metrics, name) for name in METRICS}
    exact = of["exact", 3]
    assert exact.status == "optimal"
    assert exact.objective == pytest.approx(exact.bound)
    assert exact.objective == pytest.approx(exact.metrics["total_time"])
    assert exact.metrics["total_time"] <= record.metrics["total_time"]
    solved = of["victim_one_to_one", 2]
    assert (solved.status, solved.check, solved.beta) == ("optimal", "passed", 0.25)
    assert solved.objective == pytest.approx(solved.bound)
    table = frame(done)
    assert len(table) == 6
    assert list(table.columns)[:2] == ["key", "run"]
    assert all(record.seconds is not None and record.seconds > 0 for record in done)


def test_a_study_that_is_done_does_nothing_and_a_changed_option_redoes_what_it_touches(
    tmp_path: Path,
) -> None:
    path = many_runs(tmp_path, 3)
    assert len(do(path)) == 3
    assert do(path) == []
    write_study(tmp_path, path.read_text() + '\n[[planners]]\nplanner = "greedy"\n')
    assert [record.contender for record in do(path)] == ["greedy"]
    assert len(kept(path)) == 4


def test_repetitions_are_kept_with_their_median_and_spread(tmp_path: Path) -> None:
    text = many_runs(tmp_path, 1).read_text() + "[timing]\nwarm_up = 1\nrepetitions = 3\n"
    (record,) = do(write_study(tmp_path, text))
    import json

    seconds = json.loads(record.seconds_json)
    assert len(seconds) == 3
    assert (record.seconds_low, record.seconds, record.seconds_high) == tuple(sorted(seconds))
    assert (record.repetitions, record.warm_up) == (3, 1)


def test_a_failure_is_a_row_with_its_error_and_the_rest_is_whole(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    for name, how in {
        "crashes": "os.kill(os.getpid(), 9)",
        "raises": "raise ValueError('of no use')",
    }.items():
        (tmp_path / "mine" / f"{name}.py").write_text(BREAKS.format(how=how))
    text = BOTH.replace("[2, 3]", "3").replace('"victim_none"', '"crashes", "raises"')
    path = write_study(tmp_path, f'models = ["mine"]\n{text}')
    done = {record.contender.split(" by ")[0]: record for record in do(path, jobs=2)}
    assert {name: record.outcome for name, record in done.items()} == {
        "msmrta": "finished",
        "exact": "finished",
        "victim_one_to_one": "finished",
        "crashes": "crashed",
        "raises": "raised",
    }
    assert done["crashes"].error == "killed by SIGKILL"
    assert "of no use" in done["raises"].error

    study = Study.read(path)
    with Ledger(study.ledger) as ledger:
        assert pending(study, runs(study), ledger) == []
        again = pending(study, runs(study), ledger, retry=True)
        assert {run.contender.split(" by ")[0] for run in again} == {"crashes", "raises"}


def test_a_run_beyond_its_time_is_killed_and_done_again_only_with_more(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "hangs.py").write_text(BREAKS.format(how="time.sleep(600)"))
    text = """
title = "Hangs"
models = ["mine"]
[[instances]]
maps = "open.map"
robots = 2
victims = 3
[[formulations]]
stage = "victim"
models = ["hangs"]
[limits]
seconds = 1
"""
    path = write_study(tmp_path, text)
    (hung,) = do(path)
    assert (hung.outcome, hung.error, hung.limit) == ("timed out", "killed after 1 s", 1.0)
    study = Study.read(path)
    more = Study.read(write_study(tmp_path, text.replace("seconds = 1", "seconds = 2")))
    with Ledger(study.ledger) as ledger:
        assert pending(study, runs(study), ledger) == []
        (again,) = pending(study, runs(study), ledger, retry=True)
        (longer,) = pending(more, runs(more), ledger)
    assert again.contender == longer.contender == "hangs by auto"


def test_a_failed_run_is_done_again_on_request(tmp_path: Path) -> None:
    path = many_runs(tmp_path, 2)
    study = Study.read(path)
    first, second = runs(study)
    with Ledger(study.ledger) as ledger:
        failed = replace(_BLANK, key=first.key, run=first.run, outcome="crashed", error="once")
        ledger.add(failed)
        ledger.add(replace(_BLANK, key=second.key, run=second.run))
    assert do(path) == []
    (again,) = do(path, retry=True)
    assert (again.key, again.outcome) == (first.key, "finished")
    assert do(path, retry=True) == []


def test_runs_that_another_process_had_claimed_and_left_are_done(tmp_path: Path) -> None:
    path = many_runs(tmp_path, 3)
    study = Study.read(path)
    todo = runs(study)
    with Ledger(study.ledger) as ledger:
        gone = (ledger._owner[0], 2**22 + 1, 0.0)
        ledger._database.execute("INSERT INTO claims VALUES (?, ?, ?, ?)", (todo[1].key, *gone))
        assert {record.key for record in run_study(study, todo, ledger)} == {r.key for r in todo}


def test_jobs_do_not_change_the_rows(tmp_path: Path) -> None:
    found = []
    for jobs in (1, 2):
        folder = tmp_path / str(jobs)
        folder.mkdir()
        path = many_runs(folder, 6)
        do(path, jobs=jobs)
        found.append(unmeasured(kept(path)))
    assert found[0] == found[1]
    assert len(found[0]) == 6


@pytest.mark.parametrize("n_runs", [500, pytest.param(10_000, marks=pytest.mark.slow)])
def test_many_runs_are_claimed_kept_and_not_hoarded(tmp_path: Path, n_runs: int) -> None:
    path = many_runs(tmp_path, n_runs)
    study = Study.read(path)
    todo = runs(study)
    ahead = 0

    def execute(waiting: Iterable[Run], _: Limits) -> Generator[tuple[Run, Any], None, None]:
        nonlocal ahead
        for run in waiting:
            ahead += 1
            yield run, replace(_BLANK, key=run.key, run=run.run)

    with Ledger(study.ledger) as ledger:
        for n, _ in enumerate(run_study(study, todo, ledger, execute=execute)):
            assert ahead == n + 1, "a run is taken when its turn comes, not before"
        assert len(list(ledger.records())) == n_runs
