"""The page of a replay, played in a browser: what it shows at a time is what the plan says."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.browser import PROGRAM, WITHOUT, Browser
from support.by_hand import PLAN

from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.visibility import FieldOfView
from msmrta_opt.planners import plan as make_plan

pytestmark = pytest.mark.skipif(PROGRAM is None, reason=WITHOUT)
NASTY = "</script><b>\"it's\" & <!-- <img src=x onerror=document.title='broken'>"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A browser that must have nothing to complain of, and ask no network, in all of these tests."""
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


@pytest.fixture(autouse=True)
def nothing_is_wrong_and_nothing_is_fetched(browser: Browser) -> Iterator[None]:
    browser.complaints.clear()
    browser.requests.clear()
    browser.prefer(prefers_color_scheme="light", prefers_reduced_motion="no-preference")
    yield
    assert browser.complaints == []
    assert [url for url in browser.requests if not url.startswith("file:")] == []


@pytest.fixture(scope="module")
def planned(paper: Instance) -> Plan:
    return make_plan(paper)


@pytest.fixture
def returning(plan: Plan) -> Plan:
    """The plan by hand in which robot 3 walks back, three cells at half a cell per time unit."""
    route = plan.routes[1].model_copy(update={"back": ((2, 2), (2, 3), (2, 4), (2, 5))})
    return plan.model_copy(update={"routes": (plan.routes[0], route)})


@pytest.fixture
def page(tmp_path: Path, plan: Plan) -> Path:
    plan.replay().save(tmp_path / "page.html")
    return tmp_path / "page.html"


def rows(browser: Browser, which: str) -> dict[int, dict[str, str]]:
    """What the rows of robots or victims say, by id."""
    found = f"[...document.querySelectorAll('[data-{which}]')]"
    listed: list[dict[str, str]] = browser.run(f"{found}.map((x) => ({{...x.dataset}}))")
    return {int(row[which]): row for row in listed}


def text(browser: Browser, selector: str) -> str:
    found: str = browser.run(f"document.querySelector({json.dumps(selector)}).textContent")
    return found


def clock(browser: Browser) -> float:
    return float(browser.run("document.getElementById('time').value"))


def box(browser: Browser, selector: str) -> dict[str, float]:
    found: dict[str, float] = browser.run(
        f"document.querySelector({json.dumps(selector)}).getBoundingClientRect().toJSON()"
    )
    return found


def moment(plan: Plan, robot: int, t: float) -> tuple[Cell, str, str]:
    """Where a robot is, what it does and for which victim, from the plan, exactly."""
    (data,) = [item for item in plan.instance.robots if item.id == robot]
    route, speed, clock = plan.route(robot), Fraction(data.speed), Fraction(0)
    here = data.start
    for visit in route.visits:
        if t < visit.arrival:
            passed = math.floor((Fraction(t) - clock) * speed + Fraction(1, 10**6))
            return visit.cells[passed], "walking", str(visit.victim)
        here, clock = visit.cells[-1], Fraction(visit.departure)
        if t < visit.departure:
            return here, "serving", str(visit.victim)
    if not route.visits:
        return here, "unused", ""
    passed = math.floor((Fraction(t) - clock) * speed + Fraction(1, 10**6))
    if passed < len(route.back) - 1:
        return route.back[passed], "returning", ""
    return route.back[-1] if route.back else here, "finished", ""


def agree(browser: Browser, plan: Plan, t: float) -> None:
    """The tables of the page say where all are at `t`, and what is served."""
    for robot, row in rows(browser, "robot").items():
        (r, c), state, victim = moment(plan, robot, t)
        assert (row["cell"], row["state"], row["at"]) == (f"{r},{c}", state, victim), (robot, t)
    visits = [visit for route in plan.routes for visit in route.visits]
    for victim, row in rows(browser, "victim").items():
        mine = [visit for visit in visits if visit.victim == victim]
        served = {kind for v in mine if v.departure <= t for kind in v.served}
        serving = {kind for v in mine if v.arrival <= t < v.departure for kind in v.served}
        assert set(json.loads(row["served"])) == served, (victim, t)
        assert set(json.loads(row["serving"])) == serving, (victim, t)
        unserved = {item.kind for item in plan.unserved if item.victim == victim}
        assert set(json.loads(row["unserved"])) == unserved
    n = sum(len(visit.served) for visit in visits if visit.departure <= t)
    said = f"{n} of {plan.metrics.n_available} available requirements served"
    assert text(browser, ".progress") == said
    assert said in text(browser, "#now")


@pytest.mark.parametrize("t", [0, 1, 2, 5.5, 6, 7, 8, 9, 12.5, 14])
def test_at_a_time_of_the_address_the_page_shows_what_the_plan_says(
    browser: Browser, returning: Plan, tmp_path: Path, t: float
) -> None:
    returning.replay().save(tmp_path / "page.html")
    browser.open(tmp_path / "page.html", at=f"t={t}")
    assert clock(browser) == t
    agree(browser, returning, t)


def test_from_event_to_event_the_page_shows_what_the_plan_says(
    browser: Browser, planned: Plan, tmp_path: Path
) -> None:
    planned.replay().save(tmp_path / "page.html")
    browser.open(tmp_path / "page.html", at="t=0")
    visits = [visit for route in planned.routes for visit in route.visits]
    times = sorted({time for visit in visits for time in (visit.arrival, visit.departure)})
    for time in times:
        browser.press("ArrowRight", shift=True)
        assert clock(browser) == pytest.approx(time, abs=1e-9)
        agree(browser, planned, time)
    assert clock(browser) == pytest.approx(planned.metrics.makespan)


def test_scouting_shows_what_was_in_sight_and_who_was_found(
    browser: Browser, planned: Plan, tmp_path: Path
) -> None:
    planned.replay().save(tmp_path / "page.html")
    report = planned.scouting
    assert report is not None
    steps = len(report.coverage) - 1
    for step in (0, 20, steps):
        browser.open(tmp_path / "page.html", at=f"step={step}")
        seen = 0
        for track in report.tracks:
            look = FieldOfView(planned.instance.map, track.visual_field_depth)
            for cell in track.cells[: step + 1]:
                seen = look(cell) | seen
        assert int(browser.run("document.querySelector('.plan').dataset.seen")) == int(seen.sum())
        found = sum(find.step <= step for find in report.finds)
        said = f"{found} of 10 victims found"
        assert said in text(browser, ".progress")
        assert said in text(browser, "#now")
        table = text(browser, ".victims tbody")
        assert table.count("found by S") == found
    assert text(browser, "#clock") == f"step {steps} of {steps}"


def test_without_an_address_scouting_comes_first_and_then_the_mission(
    browser: Browser, page: Path
) -> None:
    browser.open(page)
    assert text(browser, "#clock") == "step 0 of 6"
    browser.run("document.querySelector('[data-phase=mission]').click()")
    assert text(browser, "#clock") == "t = 0 of 14"


def test_keys_move_through_time_and_the_address_follows(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=2")
    for key, time in (
        *(("ArrowRight", 2.14), ("ArrowLeft", 2.0), ("End", 14.0)),
        *(("ArrowRight", 14.0), ("Home", 0.0), ("ArrowLeft", 0.0)),
    ):
        browser.press(key)
        assert clock(browser) == pytest.approx(time)
    browser.press("End")
    assert browser.run("location.hash") == "#t=14"
    browser.run("location.hash = '#t=7'; new Promise((done) => setTimeout(done, 50))")
    assert clock(browser) == 7.0


def wait_for(browser: Browser, condition: str) -> None:
    look = f"const look = () => {condition} ? done() : setTimeout(look, 5);"
    browser.run(f"new Promise((done) => {{ {look} look(); }})")


def test_space_plays_and_pauses(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=1")
    browser.run("document.getElementById('speed').value = '8'")
    browser.press(" ")
    assert text(browser, "#play") == "Pause"
    wait_for(browser, "+document.getElementById('time').value > 1")
    browser.press(" ")
    assert text(browser, "#play") == "Play"
    paused = clock(browser)
    browser.run("new Promise((done) => setTimeout(done, 60))")
    assert clock(browser) == paused


def test_playing_ends_with_the_mission(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=13.9")
    browser.run("document.getElementById('speed').value = '8'")
    browser.press(" ")
    wait_for(browser, "document.getElementById('play').textContent === 'Play'")
    assert clock(browser) == 14.0


def test_after_scouting_the_mission_is_played(browser: Browser, page: Path) -> None:
    browser.open(page, at="step=6")
    browser.press(" ")
    wait_for(browser, "document.getElementById('clock').textContent.startsWith('t = ')")
    browser.press(" ")
    assert browser.run("location.hash").startswith("#t=")


def test_where_motion_is_reduced_playing_goes_from_event_to_event(
    browser: Browser, page: Path
) -> None:
    browser.prefer(prefers_reduced_motion="reduce")
    browser.open(page, at="t=0")
    browser.run(
        "window.times = new Set(); document.getElementById('speed').value = '8';"
        "new MutationObserver(() => times.add(+document.getElementById('time').value))"
        ".observe(document.getElementById('clock'), {childList: true})"
    )
    browser.press(" ")
    wait_for(browser, "times.size >= 4")
    assert set(browser.run("[...times]")) <= {0, 2, 6, 7, 8, 12, 14}


def test_a_click_on_a_bar_goes_to_its_time_and_its_robot(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=0")
    chart = box(browser, ".gantt canvas")
    # The row of the second robot, whose only visit is from 6 to 7 of 14.
    long = chart["width"] - 40 - 14
    browser.click(chart["x"] + 40 + long * 6.5 / 14, chart["y"] + 30)
    assert clock(browser) == 6.0
    assert "Robot 3: serving v10: C" in text(browser, ".detail")
    assert browser.run("location.hash") == "#t=6&robot=3"
    assert "decided by first" in text(browser, "#tip")


def test_the_timeline_can_be_dragged(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=0")
    chart = box(browser, ".gantt canvas")
    y, long = chart["y"] + chart["height"] - 5, chart["width"] - 40 - 14
    browser.mouse("Moved", chart["x"] + 50, y)
    browser.mouse("Pressed", chart["x"] + 50, y)
    browser.mouse("Moved", chart["x"] + 40 + long / 2, y)
    browser.mouse("Released", chart["x"] + 40 + long / 2, y)
    assert clock(browser) == pytest.approx(7, abs=0.1)


def test_details_come_on_hover_and_stay_on_a_click(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=14")
    place = box(browser, ".map canvas")
    # Victim 10 is in the middle of row 2 of 3, column 2 of 6; both its visits are done.
    cell = min((place["width"] - 24) / 6, (place["height"] - 24) / 3)
    x, y = place["x"] + place["width"] / 2 - 0.5 * cell, place["y"] + place["height"] / 2 + cell
    browser.mouse("Moved", x, y)
    assert "Victim 10 at row 2, column 2" in text(browser, "#tip")
    assert "C ✓ R3 (first, time 6 to 7)" in text(browser, "#tip")
    browser.click(x, y)
    assert "Victim 10 at row 2, column 2" in text(browser, ".detail")
    assert "priority 2" in text(browser, ".detail")


def test_the_colours_follow_the_system_and_the_switch(browser: Browser, page: Path) -> None:
    theme = "document.documentElement.dataset.theme"
    browser.prefer(prefers_color_scheme="dark")
    browser.open(page)
    assert browser.run(theme) == "dark"
    browser.run("document.getElementById('theme').click()")
    assert browser.run(theme) == "light"


def test_two_plans_are_played_in_step(
    browser: Browser, plan: Plan, returning: Plan, tmp_path: Path
) -> None:
    plan.replay(returning, labels=["one", "two"]).save(tmp_path / "page.html")
    browser.open(tmp_path / "page.html", at="t=9")
    script = "[...document.querySelectorAll('[data-robot=\"3\"]')].map((x) => x.dataset.state)"
    assert browser.run(script) == ["finished", "returning"]
    assert "one: 3 of 4 available" in text(browser, "#now")
    assert "two: 3 of 4 available" in text(browser, "#now")


def test_stages_can_be_switched_off(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=14")
    shot = "document.querySelector('.map canvas').toDataURL()"
    before = browser.run(shot)
    assert text(browser, "#stages").split() == ["first", "second"]
    browser.run("document.querySelector('#stages input').click()")
    assert browser.run(shot) != before
    browser.run("document.querySelector('#stages input').click()")
    assert browser.run(shot) == before


def test_names_are_shown_as_they_are_written(browser: Browser, tmp_path: Path) -> None:
    text_of = json.dumps(PLAN | {"instance": None})
    document: dict[str, Any] = json.loads(text_of.replace('"A"', json.dumps(NASTY)))
    from support.by_hand import MISSION

    mission = json.loads(json.dumps(MISSION).replace('"A"', json.dumps(NASTY)))
    named = Instance.from_document(mission | {"name": NASTY})
    plan = Plan.model_validate(document | {"instance": named})
    plan.replay(labels=[NASTY]).save(tmp_path / "page.html")
    browser.open(tmp_path / "page.html", at="t=14")
    assert text(browser, "h1") == f"{NASTY} · {NASTY}"
    assert text(browser, "h2").startswith(f"{NASTY}: makespan 14")
    assert json.loads(rows(browser, "victim")[20]["served"]) == [NASTY, "B"]
    assert browser.run("document.title") == f"{NASTY} · {NASTY}"
    assert browser.run("document.querySelectorAll('img, b').length") == 0


def test_the_page_fits_a_telephone(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=5", width=400)
    assert browser.run("document.documentElement.scrollWidth") == 400


def test_everything_has_a_name_for_a_screen_reader(browser: Browser, page: Path) -> None:
    browser.open(page, at="t=5")
    tree = browser.ask("Accessibility.getFullAXTree")["nodes"]
    roles = ("button", "slider", "combobox", "checkbox", "image", "status", "table", "region")
    named = {
        (node["role"]["value"], node.get("name", {}).get("value", ""))
        for node in tree
        if not node["ignored"] and node["role"]["value"] in roles
    }
    assert {role for role, name in named if not name} <= {"status", "table"}
    assert ("slider", "Time") in named
    assert ("button", "Play") in named
    live = browser.run("document.getElementById('now').getAttribute('aria-live')")
    assert live == "polite"
