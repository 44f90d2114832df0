"""Runs shown: in a replay and in a picture is what happened, by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from PIL import Image
from support.browser import PROGRAM, WITHOUT, Browser
from support.legible import extents, illegible, overlaps, written
from support.small_run import SCENARIO, small_plan, small_run

from msmrta_opt.execution.execute import execute
from msmrta_opt.mission.run import Decision, Event, Queue, Queued, Run
from msmrta_opt.plots.canvas import plot_map
from msmrta_opt.plots.replay import film
from msmrta_opt.plots.replay.run_data import document_of_run
from msmrta_opt.plots.replay.run_scene import RunScene, schedules
from msmrta_opt.plots.walked import walked


@pytest.fixture(scope="module")
def run() -> Run:
    return small_run()


@pytest.fixture(scope="module")
def decided(run: Run) -> Run:
    """The run in which robot 1 is given victim 30, too, at 2.5."""
    decision = Decision(
        time=2.5,
        before=(Queue(robot=1, visits=(Queued(victim=10, served=("A",)),)),),
        after=(Queue(robot=1, visits=tuple(Queued(victim=v, served=("A",)) for v in (10, 30))),),
        changed=0,
    )
    events = (*run.events, Event(time=2.5, what="decided"))
    return run.model_copy(update={"decisions": (decision,), "events": events})


def test_the_data_of_a_run_says_where_robots_were_and_what_came(run: Run) -> None:
    data = document_of_run(run)
    one, two = data["robots"]
    assert one["walks"] == [(0.0, 3.0, "R3", 0)]
    assert [(v["victim"], v["arrival"], v["departure"], v["cut"]) for v in one["visits"]] == [
        (0, 3, 5, False)
    ]
    assert two["walks"] == [(0.0, 2.0, "L2", None)]
    assert (one["lost"], two["lost"], two["visits"]) == (None, 2.5, [])
    assert [victim["appears"] for victim in data["victims"]] == [0, 0, 1.5]
    assert [list(victim["unserved"].values()) for victim in data["victims"]] == [
        [], ["was not served"], ["was not served"],
    ]  # fmt: skip
    assert data["run"]["changes"] == [[4.0, 1, 0, False]]
    assert [text for _, text, _ in data["run"]["events"]] == [
        "v30 is announced", "R2 is lost at row 1, column 3", "row 1, column 0 is blocked",
    ]  # fmt: skip


def test_a_decision_is_told_by_the_queues_that_it_changed(decided: Run) -> None:
    told = document_of_run(decided)["run"]
    assert told["planned"] == [[0], [1]]
    assert [(x["time"], x["queues"]) for x in told["decisions"]] == [(2.5, [(0, [0], [0, 2])])]
    assert [number for *_, number in told["events"]].count(0) == 1


def test_what_was_walked_is_drawn_as_a_plan(run: Run) -> None:
    one, two = walked(run).routes
    assert [(v.victim, v.served, v.arrival, v.departure) for v in one.visits] == [
        (10, ("A",), 3.0, 5.0)
    ]
    assert one.cells == [(0, 0), (0, 1), (0, 2), (0, 3)]
    assert (two.visits, two.cells) == ((), [(1, 5), (1, 4), (1, 3)])
    assert [victim.id for victim in walked(run).instance.victims] == [10, 20, 30]


def test_the_picture_of_a_run_says_what_it_shows(run: Run) -> None:
    assert run.plan.metrics.n_served == 2  # known before the picture is drawn
    figure = run.plot()
    said = {text.get_text() for text in figure.findobj(match=Text)}
    for expected in (
        "R2 lost", "a robot was lost there", "a cell was blocked", "the victim turned up on the way",
        "planned: by hand\n2 served, 7 cells walked, makespan 6",
        "walked: keep, seed 0\n1 served, 5 cells walked, makespan 5",
        "not all served: 2 victims (0 in the plan)", "available, but not served: 2 requirements",
    ):  # fmt: skip
        assert expected in said
    assert any(text.startswith("1 of 3 available requirements served") for text in said)


def test_the_timeline_of_a_run_marks_what_came_in_between(decided: Run) -> None:
    *_, timeline = decided.plot().axes
    found = {
        (line.get_marker(), round(line.get_xdata()[0], 6), line.get_ydata()[0] < -0.5)
        for line in timeline.get_lines()
        if line.get_marker() != "None"
    }
    # Robot 2, in its row, is lost at 2.5; above the rows victim 30 at 1.5, the blocked cell at 4.
    assert found == {("X", 2.5, False), ("o", 1.5, True), ("s", 4.0, True)}
    lines = [line.get_xdata()[0] for line in timeline.get_lines() if line.get_marker() == "None"]
    assert lines == [2.5, 5.0]  # decided, and the makespan


def test_a_service_that_was_cut_short_is_no_whole_bar_in_the_timeline() -> None:
    run = execute(small_plan(), {"until": 4})  # robot 1 serves victim 10 from 3 on
    cut = [
        group
        for group in run.plot().axes[-1].collections
        if len(group.get_facecolor()) and to_hex(group.get_facecolor()[0]) == "#ffffff"
    ]
    assert [(box.x0, box.x1) for box in (path.get_extents() for path in cut[0].get_paths())] == [
        (3, 4)
    ]
    said = {text.get_text() for text in run.plot().findobj(match=Text)}
    assert "service cut short" in said


def test_badges_of_robots_that_meet_in_a_film_lie_beside_each_other(run: Run) -> None:
    figure = Figure(figsize=(6, 4), dpi=80)
    axes = figure.subplots(2)
    plot_map(run.plan.instance.map, axes[0])
    scene = RunScene(run, *axes)
    assert scene.named
    looks = [("R1 lost", "black", "white"), ("R3", "red", "white"), ("R12", "red", "white")]
    scene._badges(looks, [(0, 2), (0, 2), (0, 2.1)])
    boxes = extents(box for said, box in written(figure) if said.startswith("R"))
    assert len(boxes) == 3
    assert overlaps(boxes, boxes).sum() == 3  # each with itself


def test_rings_of_a_run_are_around_those_whom_it_did_not_serve(run: Run) -> None:
    planned, done = run.plot().axes[:2]
    assert [rings(ax) for ax in (planned, done)] == [0, 2]  # victims 20 and 30


def rings(ax: Axes) -> int:
    found = [x for x in ax.collections if isinstance(x, PatchCollection) and x.get_zorder() == 5.1]
    return sum(len(x.get_paths()) for x in found)


def test_a_lost_robot_a_blocked_cell_and_one_that_was_opened_look_different() -> None:
    scenario = {**SCENARIO, "corridors": [{"cells": [[1, 0]], "blocked": 2, "opened": 4},
                                          {"cells": [[0, 4]], "blocked": 3}]}  # fmt: skip
    _, done = execute(small_plan(), scenario).plot().axes[:2]
    marks = [x for x in done.patches if isinstance(x, Rectangle) and x.get_width() == 1]
    cells = {(x.get_x() + 0.5, x.get_y() + 0.5, bool(x.get_hatch())) for x in marks}
    assert cells == {(0, 1, True), (0, 1, False), (4, 0, True)}
    assert [text.get_text() for text in done.texts if "lost" in text.get_text()] == ["R2 lost"]


@pytest.mark.parametrize("slower", [1, 0.1])
def test_no_text_of_the_picture_of_a_run_lies_outside_or_on_another(slower: float) -> None:
    scenario = {**SCENARIO, "speed": [{"value": slower}]}
    assert illegible(execute(small_plan(), scenario).plot()) == []


@pytest.mark.parametrize(
    ("robot", "t", "place"),
    [
        *((1, 0, (0, 0)), (1, 1.5, (0, 1.5)), (1, 3, (0, 3)), (1, 9, (0, 3))),
        *((2, 1.5, (1, 3.5)), (2, 2, (1, 3)), (2, 2.4, (1, 3)), (2, 9, (1, 3))),
    ],
)
def test_in_a_film_a_robot_is_where_the_run_had_it(
    run: Run, robot: int, t: float, place: tuple[float, float]
) -> None:
    assert schedules(run)[robot].walked(t)[-1] == pytest.approx(place)


def test_in_a_film_a_robot_waits_where_it_waited() -> None:
    # It stands before [0, 2], which is blocked, from 1 to 4.
    scenario = {"corridors": [{"cells": [[0, 2]], "blocked": 0.5, "opened": 4}]}
    here = schedules(execute(small_plan(), scenario, blocked="wait"))[1]
    assert [tuple(here.walked(t)[-1]) for t in (1, 3.9, 5)] == [(0, 1), (0, 1), (0, 2)]


def test_a_film_of_a_run_says_who_was_lost_what_was_served_and_who_turned_up(run: Run) -> None:
    figure = Figure()
    scene = RunScene(run, *figure.subplots(2))
    scene.named = True

    def said(t: float) -> set[str]:
        return {x.get_text() for _, x in scene.mission(t) if isinstance(x, Text)}

    assert said(1) == {"R1", "R2", "time 1 of 5: 0 of 3 available requirements served"}
    assert said(2.5) == {
        "R1",
        "R2 lost",
        "v30",
        "time 2.5 of 5: 0 of 3 available requirements served",
    }
    assert {"R2 lost", "time 5 of 5: 1 of 3 available requirements served"} <= said(5)


def test_a_run_and_its_plan_make_a_film(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film, "RATES", {".gif": 1, ".mp4": 1})
    run.replay(run.plan).save(tmp_path / "run.gif")
    with Image.open(tmp_path / "run.gif") as gif:
        assert gif.n_frames > 5  # type: ignore[attr-defined]


@pytest.mark.skipif(PROGRAM is None, reason=WITHOUT)
def test_a_page_plays_two_runs_in_step(run: Run, decided: Run, tmp_path: Path) -> None:
    decided.replay(run).save(tmp_path / "page.html")
    browser = Browser(tmp_path / "profile")
    try:
        found: dict[float, list[dict[str, Any]]] = {}
        for t in (1, 2.75, 4.5, 5):
            browser.open(tmp_path / "page.html", at=f"t={t}", width=400)
            rows = "[...document.querySelectorAll('[data-robot]')].map((x) => ({...x.dataset}))"
            found[t] = browser.run(rows)
            assert browser.run("document.documentElement.scrollWidth") == 400
        opened = "document.querySelectorAll('details').forEach((x) => { x.open = true; });"
        shown = "[...document.querySelectorAll('.events tbody')].map((x) => x.innerText)"
        events = browser.run(f"{opened} {shown}")
        victims = browser.run(
            "[...document.querySelectorAll('[data-victim]')].map((x) => x.dataset.unserved)"
        )
        assert browser.complaints == []
    finally:
        browser.close()
    state = {t: [(row["cell"], row["state"]) for row in rows[:2]] for t, rows in found.items()}
    assert state == {
        1: [("0,1", "walking"), ("1,4", "walking")],
        2.75: [("0,2", "walking"), ("1,3", "lost")],
        4.5: [("0,3", "serving"), ("1,3", "lost")],
        5: [("0,3", "finished"), ("1,3", "lost")],
    }
    assert all(rows[:2] == rows[2:] for rows in found.values())
    assert "R1: v10 became v10 v30" in events[0]
    assert "became" not in events[1]
    assert victims[:3] == ["[]", '["A"]', '["A"]']


def test_the_command_replays_a_run_and_no_run_that_does_not_hold(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from msmrta_opt import cli

    run.save(tmp_path / "run.json")
    small_plan().save(tmp_path / "plan.json")
    page = str(tmp_path / "both.html")
    assert (
        cli.run(["replay", str(tmp_path / "plan.json"), str(tmp_path / "run.json"), "-o", page])
        == 0
    )
    wrong = run.model_copy(update={"services": ()})
    wrong.save(tmp_path / "wrong.json")
    capsys.readouterr()
    assert cli.run(["replay", str(tmp_path / "wrong.json"), "-o", str(tmp_path / "x.html")]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "x.html").exists()
