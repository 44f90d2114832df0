"""Solves and their changes as JUnit's XML and as Markdown."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

from msmrta_opt.studies.analysis.regression import regression
from msmrta_opt.studies.analysis.regression_files import junit, markdown
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.solves import record_of_row


def row(**changes: Any) -> Record:
    return record_of_row(
        {
            "instance": "paper", "stage": "cluster", "model": "m", "solver": "a", "sense": "max",
            "status": "optimal", "objective": 5.0, "bound": 5.0, "check": "passed", "nodes": 3,
            "total_seconds": 0.25,
        }
        | changes
    )  # fmt: skip


BEFORE = [row(), row(solver="gone")]
AFTER = [
    row(objective=4.0, bound=4.0, nodes=7),
    row(solver="b", status="skipped", message="it cannot", objective=None, bound=None, check=None),
    row(solver="c", status="error", message="no licence", objective=None, bound=None, check=None),
    row(solver="d", check="row 1 is missed", seed=2),
]


def cases(text: str) -> dict[str, ElementTree.Element]:
    return {str(case.get("name")): case for case in ElementTree.fromstring(text)}


def test_a_case_a_solve_with_its_failure_error_or_skip() -> None:
    found = cases(junit(AFTER))
    assert list(found) == ["a", "b", "c", "d, seed 2"]
    assert {case.get("classname") for case in found.values()} == {"paper.m"}
    assert [len(found["a"]), found["a"].get("time")] == [0, "0.250000"]
    assert [child.tag for child in found["b"]] == ["skipped"]
    assert found["c"][0].tag == "error"
    assert found["c"][0].get("message") == "no licence"
    assert found["d, seed 2"][0].get("message") == "check: row 1 is missed"


def test_changes_fail_their_solves_notes_are_output_and_what_is_missing_is_a_case() -> None:
    text = junit(AFTER, regression(BEFORE, AFTER), ["a has 5, but b proves 4"])
    found = cases(text)
    failure, output = found["a"]
    assert failure.get("message") == "objective 4, was 5"
    assert failure.text == "objective 4, was 5\nbound 4, was 5"
    assert output.text == "nodes 7, was 3"
    assert found["m on paper by gone"][0].get("message") == "was there before, is missing"
    assert found["a has 5, but b proves 4"].get("classname") == "agreement"
    suite = ElementTree.fromstring(text)
    counts = {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")}
    # a and d fail, and so do b and c, which were not there before; then what is gone, and the clash.
    assert counts == {"tests": "6", "failures": "6", "errors": "0", "skipped": "0"}


def test_characters_that_xml_has_not_are_replaced() -> None:
    (case,) = cases(
        junit([row(solver="a\x00<b>\x1f", status="error", message="\x0c & <x>")])
    ).values()
    assert case.get("name") == "a?<b>?"
    assert case[0].get("message") == "? & <x>"


def test_markdown_has_what_is_wrong_first_then_a_table_of_all() -> None:
    text = markdown(AFTER, regression(BEFORE, AFTER), ["a | b"])
    lines = text.splitlines()
    assert lines[0] == "# Solver regression"
    order = [
        lines.index(f"## {title}") for title in ("Wrong", "Changed", "For information", "Solves")
    ]
    assert order == sorted(order)
    assert "- a \\| b" in lines
    assert "- m on paper by a: objective 4, was 5" in lines
    table = lines[order[-1] + 2 :]
    assert table[0] == "| instance | model | solver | status | objective | bound | ms |"
    assert table[2] == "| paper | m | a | optimal | 4 | 4 | 250 |"
    assert len(table) == 2 + len(AFTER)


def test_where_nothing_changed_markdown_says_so() -> None:
    text = markdown(BEFORE, regression(BEFORE, BEFORE))
    assert "2 solves against 2 rows of the baseline: all is as it should be." in text
    assert "## Changed" not in text


def test_information_that_many_solves_share_is_told_once() -> None:
    old = [row(model=name, solver_version="1.0") for name in "mno"]
    new = [row(model=name, solver_version="2.0") for name in "mno"]
    assert regression(old, new).information == ["a 2.0, was 1.0 (in 3 solves)"]
    assert regression(old[:1], new[:1]).information == ["m on paper by a: a 2.0, was 1.0"]
    assert regression(old, new).changes == ()
