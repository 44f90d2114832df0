"""Trade-offs of whole missions."""

from __future__ import annotations

import csv
import itertools
import os
import random
import signal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.legible import illegible

from msmrta_opt.cli import run
from msmrta_opt.interruption import interruptible
from msmrta_opt.mission.errors import InputError, ModelError, SolverError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.optimise.parametric import Family, Line, envelope
from msmrta_opt.optimise.solve import solve
from msmrta_opt.planners import plan
from msmrta_opt.stages.data import stage_data
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.studies.analysis import tradeoff as tradeoffs
from msmrta_opt.studies.analysis.tradeoff import _Problem, tradeoff, tradeoff_regions
from msmrta_opt.studies.analysis.tradeoff_pages import regions_figure, tradeoff_figure
from msmrta_opt.studies.analysis.tradeoff_pictures import apart, plot_value

INSTANCES = Path(__file__).parents[3] / "instances"
PAPER = INSTANCES / "paper.json"


def test_the_papers_mission_changes_once_at_one_third(paper: Instance) -> None:
    result = tradeoff(paper, "psi")
    assert result.exact
    assert result.breakpoints == [Fraction(1, 3)]
    before, after = result.segments
    assert (before.value(0), after.value(1)) == (10, 6)
    assert before.assignment == ((1,), (0,), (2,), (3,))
    assert after.assignment == ((0,), (2,), (1,), (3,))
    assert set(result.ties[Fraction(1, 3)]) == {before.assignment, after.assignment}


def test_each_piece_has_the_plan_that_planning_inside_it_gives(paper: Instance) -> None:
    for segment in tradeoff(paper, "beta").segments:
        inside = float(segment.low + (segment.high - segment.low) / 3)
        assert segment.unique
        assert plan(paper, beta=inside).routes == segment.plan.routes


MAP = read_map(INSTANCES / "maps" / "map2.map")


@pytest.mark.parametrize(
    "mission", [Instance.read(PAPER), generate_mission(MAP, 4, 12, seed=5, solvable=False)]
)
def test_regions_tile_the_square_and_hold_their_plan(mission: Instance) -> None:
    found = tradeoff_regions(mission)
    area = sum((r.psi[1] - r.psi[0]) * (r.beta[1] - r.beta[0]) for r in found.regions)
    assert area == 1
    for one, other in itertools.combinations(found.regions, 2):
        apart = [
            min(a[1], b[1]) <= max(a[0], b[0])
            for a, b in ((one.psi, other.psi), (one.beta, other.beta))
        ]
        assert any(apart)
    chance = random.Random(0)
    for region in found.regions:
        if region.unique:
            psi, beta = (
                float(low + (high - low) * Fraction(chance.randint(1, 9), 10))
                for low, high in (region.psi, region.beta)
            )
            assert plan(mission, psi=psi, beta=beta).routes == region.plan.routes


def test_both_parameters_at_once_give_the_regions(paper: Instance) -> None:
    both = tradeoff(paper, ("psi", "beta"))
    assert [plan.routes for plan in both.plans] == [p.routes for p in tradeoff_regions(paper).plans]


def test_what_has_no_pieces_is_refused(paper: Instance) -> None:
    with pytest.raises(ModelError, match="beta enters the rows"):
        tradeoff(paper, "beta", model="victim_balanced")
    with pytest.raises(InputError, match="over"):
        tradeoff(paper, "gamma")


def test_a_formulations_own_parameter_has_pieces_over_its_own_range(paper: Instance) -> None:
    own = tradeoff(paper, "delta", model="cluster_distance", psi=0)
    assert (own.segments[0].low, own.segments[-1].high) == own.span == (0, 1)
    free = tradeoff(paper, "psi", model="cluster_distance", delta=0)
    assert own.segments[0].value(0) == free.segments[0].value(0)
    for segment in own.segments:
        middle = float((segment.low + segment.high) / 2)
        data = stage_data(paper, "cluster")
        solution = solve("cluster_distance", data, psi=0, delta=middle)
        assert solution.objective == pytest.approx(float(segment.value(middle)))
    page = tradeoff_figure(own)
    assert illegible(page) == []
    assert any(text.get_text().startswith("delta in cluster_distance") for text in page.texts)


def test_the_command_prints_the_pieces_and_writes_table_and_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, picture = tmp_path / "pieces.csv", tmp_path / "pieces.png"
    assert run(["tradeoff", str(PAPER), "--csv", str(table), "--figure", str(picture)]) == 0
    told = capsys.readouterr().out
    assert "1/3 (0.333333)" in told
    assert "exact fractions" in told
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [row["cells"] for row in rows] == ["247", "258"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_command_shows_the_square(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "square.png"
    assert run(["tradeoff", str(PAPER), "--over", "psi,beta", "--figure", str(picture)]) == 0
    assert "3 regions, 3 different plans" in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("over", "plans", "rows"),
    [("psi", 1, 1), ("beta", 1, 1), ("beta", 2, 2), ("psi,beta", 2, 2)],
)
def test_ctrl_c_keeps_the_pieces_that_are_whole_by_then(
    over: str,
    plans: int,
    rows: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    made = 0

    def plan_and_interrupt(*arguments: Any, **options: Any) -> Plan:
        nonlocal made
        made += 1
        if made == plans:
            os.kill(os.getpid(), signal.SIGINT)
        return plan(*arguments, **options)

    monkeypatch.setattr(tradeoffs, "make_plan", plan_and_interrupt)
    table, picture = tmp_path / "pieces.csv", tmp_path / "pieces.png"
    outputs = ["--csv", str(table), "--figure", str(picture)]
    assert run(["tradeoff", str(PAPER), "--over", over, *outputs]) == 130
    assert made == plans
    with table.open() as file:
        assert len(list(csv.DictReader(file))) == rows
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert f"interrupted: what is shown of {over} is not all there is" in capsys.readouterr().out


@pytest.mark.parametrize("over", ["psi", "beta", "psi,beta"])
def test_ctrl_c_in_the_very_first_solve_is_an_interruption_and_no_error(
    over: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(family: Family, t: Fraction) -> Line:
        os.kill(os.getpid(), signal.SIGINT)
        raise SolverError("feasible: stopped by the user")

    monkeypatch.setattr(Family, "solve", stopped)
    assert run(["tradeoff", str(PAPER), "--over", over]) == 130
    assert capsys.readouterr().err.splitlines()[-1] == "interrupted"


def test_pieces_that_are_proved_before_ctrl_c_are_those_of_the_whole(
    paper: Instance, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = tradeoff(paper, "beta")
    solved = Family.solve

    def solve_and_interrupt(family: Family, t: Fraction) -> Line:
        if family.n_solves == 3:
            os.kill(os.getpid(), signal.SIGINT)
        return solved(family, t)

    monkeypatch.setattr(Family, "solve", solve_and_interrupt)
    with interruptible():
        found = envelope(_Problem(paper, "beta", "victim", whole.model, StagedOptions()).family)
    pieces = [(piece.low, piece.high) for piece in found.pieces]
    assert pieces == [(piece.low, piece.high) for piece in whole.segments][: len(pieces)]
    assert len(pieces) < len(whole.segments)


def test_no_text_of_a_page_lies_outside_or_on_another(paper: Instance) -> None:
    assert illegible(tradeoff_figure(tradeoff(paper, "psi"))) == []
    assert illegible(tradeoff_figure(tradeoff(paper, "beta"))) == []
    assert illegible(regions_figure(tradeoff_regions(paper))) == []


def test_a_parameter_without_effect_is_said_instead_of_drawn() -> None:
    mission = Instance.read(PAPER.parent / "two_rooms.json")
    page = tradeoff_figure(tradeoff(mission, "psi"))
    said = [text.get_text() for text in page.texts]
    assert any("ψ has no effect on this mission" in text for text in said)
    assert len(page.axes) == 1


def test_an_unknown_parameter_is_one_line_and_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tradeoff", str(PAPER), "--over", "gamma"]) == 2
    assert capsys.readouterr().err == (
        "error: over: 'gamma' is no parameter: cluster_one_to_one has psi; victim_one_to_one has beta\n"
    )


def test_names_of_close_breakpoints_are_moved_apart_by_hand() -> None:
    # 0.50 and 0.52 share their shortfall of 0.08; 0.9 is far enough and stays.
    found = apart(np.array([0.5, 0.52, 0.9]), 0.1)
    assert found == pytest.approx([0.46, 0.56, 0.9])
    assert apart(np.array([0.1, 0.5]), 0.1) == pytest.approx([0.1, 0.5])


def test_the_legend_of_the_value_leaves_the_lines_free(paper: Instance) -> None:
    ax = plot_value(tradeoff(paper, "psi"))
    ax.figure.canvas.draw()
    legend = ax.get_legend()
    assert legend is not None
    assert not legend.get_window_extent().overlaps(ax.get_window_extent())
