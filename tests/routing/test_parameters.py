"""Tuning parameters: read from TOML, refused by name, recorded where they are not the defaults."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from typing import Any

import pytest

import msmrta_opt as mo
from msmrta_opt.cli import run
from msmrta_opt.mission.errors import InputError
from msmrta_opt.routing.parameters import HeuristicsParameters, Parameters


def test_a_file_changes_what_it_names_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "tuning.toml"
    file.write_text(
        "[heuristics]\naverage_removed = 12\n"
        "[branch_and_cut]\nreduced_costs = [0, 0.5]\nseparation_tolerance = 1\n"
        "[branch_and_price]\nmaximum_labels = 7\n"
    )
    read = Parameters.read(file)
    assert read.heuristics == replace(HeuristicsParameters(), average_removed=12)
    assert read.changed() == {
        "heuristics": {"average_removed": 12},
        "branch_and_cut": {"reduced_costs": (0.0, 0.5), "separation_tolerance": 1.0},
        "branch_and_price": {"maximum_labels": 7},
    }
    assert Parameters.of(read) is read
    assert Parameters.of(None) == Parameters.of({}) == Parameters()
    assert Parameters().changed() == {}


def test_parameters_cannot_be_changed_once_made() -> None:
    with pytest.raises(FrozenInstanceError):
        Parameters().heuristics.blink = 0.5  # type: ignore[misc]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"heuristic": {}}, "heuristic: {}; there is no such field"),
        ({"heuristics": {"blinks": 1}}, "heuristics.blinks: 1; there is no such field"),
        ({"heuristics": {"blink": 1.5}}, "heuristics.blink: 1.5; give 1 or less"),
        ({"heuristics": {"blink": True}}, "heuristics.blink: true; give a finite number"),
        ({"heuristics": {"blink": "0.1"}}, "heuristics.blink: .*; give a finite number"),
        ({"heuristics": {"longest_string": 2.5}}, "longest_string: 2.5; give a whole number"),
        ({"heuristics": {"longest_string": 0}}, "longest_string: 0; give 1 or more"),
        ({"heuristics": 3}, "heuristics: 3; give an object"),
        ({"branch_and_cut": {"reduced_costs": [1, -1]}}, r"reduced_costs\[1\]: -1; give 0 or more"),
        ({"branch_and_price": {"smoothing": 1}}, "smoothing: 1; give a number below 1"),
        ({"branch_and_price": {"first_tolerance": float("nan")}}, "NaN; give a finite number"),
    ],
)
def test_a_wrong_parameter_is_named_with_its_value(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        Parameters.of(given)
    assert "\n" not in str(refused.value)


def test_a_wrong_file_is_refused_in_one_line_before_any_work(
    tmp_path: Path, instances_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    corridor = str(instances_dir / "corridor.json")
    file = tmp_path / "tuning.toml"
    for text, message in {
        "[branch_and_cut]\nneighbours = 'many'\n": "branch_and_cut.neighbours: 'many'; give a whole",
        "[branch_and_cut\n": "broken TOML",
    }.items():
        file.write_text(text)
        assert run(["exact", corridor, "--parameters", str(file)]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert str(file) in error
        assert message in error
    assert run(["exact", corridor, "--parameters", str(tmp_path / "none.toml")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_a_plan_records_the_parameters_that_were_given(tmp_path: Path, instances_dir: Path) -> None:
    corridor, file = instances_dir / "corridor.json", tmp_path / "tuning.toml"
    file.write_text("[branch_and_cut]\nneighbours = 2\n")
    written = tmp_path / "plan.json"
    line = ["exact", str(corridor), "--parameters", str(file), "--json", str(written)]
    assert run(line) == 0
    recorded = mo.Plan.read(written).options
    assert recorded["parameters"] == {"branch_and_cut": {"neighbours": 2}}
    again = mo.plan(mo.read(str(corridor)), planner="exact", **recorded)
    assert again.options == recorded
    assert "parameters" not in mo.plan(mo.read(str(corridor)), planner="exact").options


def test_a_planner_that_searches_for_nothing_takes_none(instances_dir: Path) -> None:
    corridor = mo.read(str(instances_dir / "corridor.json"))
    with pytest.raises(InputError, match="parameters: planner greedy has no parameters of its own"):
        mo.plan(corridor, planner="greedy", parameters={"heuristics": {"blink": 0.0}})
    improved = mo.plan(
        corridor, planner="greedy", improve=True, parameters={"heuristics": {"blink": 0.0}}
    )
    assert improved.options["parameters"] == {"heuristics": {"blink": 0.0}}
