"""A study in Python: run, resumed, counted, as rows, and as a report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError

DOCUMENT: dict[str, Any] = {
    "title": "two planners",
    "instances": [{"files": ["corridor", "split"]}],
    "planners": [{"planner": "random"}, {"planner": "greedy", "name": "nearest first"}],
}


def test_a_study_of_a_document_is_run_counted_read_and_reported(tmp_path: Path) -> None:
    study = mo.study(DOCUMENT, tmp_path / "mine.toml")
    assert "not run yet" in repr(study)
    with pytest.raises(InputError, match="no ledger yet; run the study first"):
        study.status()
    rows = study.run()
    assert list(rows["contender"]) == ["random", "nearest first"] * 2
    assert list(rows["instance"]) == ["corridor", "corridor", "split", "split"]
    assert rows["outcome"].eq("finished").all()
    assert study.status().to_dict("records") == [
        {"contender": "random", "all": 2, "finished": 2, "failed": 0, "open": 0},
        {"contender": "nearest first", "all": 2, "finished": 2, "failed": 0, "open": 0},
    ]
    # Run again, nothing is done anew: the times that were kept are the same.
    assert list(study.run()["finished_at"]) == list(rows["finished_at"])
    assert study.to_frame().equals(study.rows())
    assert study.report() == tmp_path / "mine-report" / "report.html"
    assert "nearest first" in study._repr_html_()
    more = mo.study({**DOCUMENT, "planners": [{"planner": "mrga"}]}, tmp_path / "mine.toml")
    assert more.status().to_dict("records") == [
        {"contender": "mrga", "all": 2, "finished": 0, "failed": 0, "open": 2}
    ]
    assert more.state().n_others == 4


@pytest.mark.parametrize(
    ("what", "path", "said"),
    [
        (DOCUMENT, None, "path: is missing; a document needs one"),
        ("none.toml", None, "none.toml: no such file"),
        ("none.toml", "other.toml", "path: goes with a document"),
        ({"title": "t"}, "mine.toml", "mine.toml: instances: is missing"),
    ],
)
def test_what_is_no_study_is_told_in_a_line(what: Any, path: str | None, said: str) -> None:
    with pytest.raises(InputError, match=said):
        mo.study(what, path)


def test_jobs_are_a_whole_number(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="jobs: 0; give a whole number, 1 or more"):
        mo.study(DOCUMENT, tmp_path / "mine.toml").run(jobs=0)


def test_a_misspelt_shipped_name_is_told(tmp_path: Path) -> None:
    study = mo.study({**DOCUMENT, "instances": [{"files": "corrido"}]}, tmp_path / "mine.toml")
    with pytest.raises(InputError, match=r"matches no file \(did you mean 'corridor'\?\)"):
        study.run()
