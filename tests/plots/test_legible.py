"""What is written on a picture can be read: inside the figure, over nothing else, in contrast."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from support.legible import illegible

from msmrta_opt import plots
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.layouts import rooms
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.plots.style import (
    FAINT,
    INK,
    NOBODY,
    PALETTE,
    WALL,
    contrast,
    readable_on,
    robot_style,
)

PAPER = Path(__file__).parents[2] / "instances" / "paper.json"
OPEN = grid_from_rows(["." * 24] * 18)


def generated(n_robots: int, n_victims: int, side: int) -> Instance:
    grid = rooms(side, side, seed=1)
    return generate_mission(grid, n_robots, n_victims, seed=1, priorities=(1, 5))


def unserved() -> Instance:
    return generate_mission(OPEN, 5, 20, seed=3, unmeetable=0.3)


def long_names() -> Instance:
    document = Instance.read(PAPER).model_dump(mode="json")
    words = {kind: f"{kind} {'and more of it ' * 8}" for kind in document["capabilities"]}
    document["name"] = "a mission with a name that says it all " * 4
    document["capabilities"] = list(words.values())
    document["service_time"] = {words[k]: t for k, t in document["service_time"].items()}
    for robot in document["robots"]:
        robot["id"] += 123_456_789
        robot["capabilities"] = [words[kind] for kind in robot["capabilities"]]
    for victim in document["victims"]:
        victim["requirements"] = [words[kind] for kind in victim["requirements"]]
        victim["service_time"] = {words[k]: t for k, t in victim["service_time"].items()}
    return Instance.from_document({**document, "clusters": None})


def five_scouts() -> Instance:
    document = Instance.read(PAPER).model_dump(mode="json")
    starts = [(0, 0), (0, 12), (12, 4), (10, 19), (19, 9)]
    document["scouts"] = [
        {"id": i, "start": start, "visual_field_depth": 1 + i} for i, start in enumerate(starts)
    ]
    return Instance.from_document(document)


def corridor(across: int, down: int) -> Instance:
    """One cell wide, with five victims along it."""
    return generate_mission(grid_from_rows(["." * across] * down), 2, 5, seed=2, per_robot=(3, 6))


MISSIONS = {
    "paper": lambda: Instance.read(PAPER),
    "one robot": lambda: generate_mission(OPEN, 1, 6, seed=1, per_robot=(6, 6)),
    "unserved victims": unserved,
    "long names": long_names,
    "five scouts": five_scouts,
    "corridor across": lambda: corridor(180, 1),
    "corridor down": lambda: corridor(1, 120),
    "10 × 100": lambda: generated(10, 100, 48),
    "20 × 200": lambda: generated(20, 200, 64),
}


@pytest.fixture(scope="module", params=MISSIONS)
def planned(request: pytest.FixtureRequest) -> Plan:
    return make_plan(MISSIONS[request.param]())


def test_no_text_of_a_page_lies_outside_or_on_another(planned: Plan) -> None:
    assert illegible(planned.plot()) == []


@pytest.mark.slow
def test_what_cannot_be_read_is_found() -> None:
    """On 400 × 400 pixels: two words in one place, and one that leaves the page."""
    figure = Figure(figsize=(4, 4), dpi=100)
    for i in range(12):
        figure.text(0.1, 0.05 + 0.07 * i, f"line {i}")
    figure.text(0.5, 0.5, "under")
    figure.text(0.52, 0.5, "over")
    figure.text(0.98, 0.9, "far out")
    assert illegible(figure) == ["'far out' is outside", "'under' is on 'over'"]


def test_no_text_of_a_page_of_a_hundred_robots_lies_outside_or_on_another() -> None:
    assert illegible(make_plan(generated(100, 1000, 128)).plot()) == []


def test_every_victim_of_a_small_mission_is_named_in_each_panel() -> None:
    plan = make_plan(Instance.read(PAPER))
    panels = [ax for ax in plan.plot().axes if ax.get_title().split("\n")[0] in PANELS]
    assert len(panels) == 3
    for ax in panels:
        said = {text.get_text() for text in ax.texts}
        assert {str(victim.id) for victim in plan.instance.victims} <= said


PANELS = ("Scouting", "Assignment", "Paths")


@pytest.mark.parametrize(("across", "down"), [(180, 1), (400, 1), (1, 120), (2, 90), (1, 1)])
def test_a_corridor_is_drawn_with_room_for_the_marks_on_it(across: int, down: int) -> None:
    """40 points across at 100 dots an inch are 55 dots; ticks are on the map alone."""
    ax = plots.plot_map(grid_from_rows(["." * across] * down))
    FigureCanvasAgg(ax.figure).draw()
    box = ax.get_window_extent()
    assert min(box.width, box.height) >= 50
    assert {*ax.get_xticks()} <= {*range(across)}
    assert {*ax.get_yticks()} <= {*range(down)}


def test_no_text_of_two_plans_side_by_side_lies_outside_or_on_another() -> None:
    plan = make_plan(Instance.read(PAPER))
    other = make_plan(plan.instance, planner="mrga")
    assert (
        illegible(plots.plot_two_plans(plan, other, moved=plan.diff(other).moved_requirements))
        == []
    )


# Contrast, and robots apart without colour


def test_black_and_white_are_as_far_apart_as_the_standard_says() -> None:
    assert contrast("white", "black") == pytest.approx(21)
    assert contrast("#777777", "white") == pytest.approx(4.48, abs=0.005)  # WCAG's own example


@pytest.mark.parametrize("colour", PALETTE)
def test_a_robot_stands_out_from_walls_and_its_number_from_it(colour: str) -> None:
    assert contrast(colour, WALL) >= 2
    assert contrast(colour, "white") >= 2
    assert contrast(readable_on(colour), colour) >= 4.5


@pytest.mark.parametrize("ink", [INK, FAINT, NOBODY])
def test_text_stands_out_from_the_page(ink: str) -> None:
    assert contrast(ink, "white") >= 4.5


def dashes(index: int) -> tuple[float, ...]:
    line = robot_style(index).line
    return () if isinstance(line, str) else line[1]


def test_ten_robots_are_apart_in_greyscale_by_dash_and_mark() -> None:
    looks = [(dashes(i), robot_style(i).mark) for i in range(10)]
    assert [dashed for dashed, _ in looks[:4]] == [()] * 4
    assert len({mark for _, mark in looks[:4]}) == 4
    for one, other in combinations([dashed for dashed, _ in looks[4:]], 2):
        # Patterns differ in the number of strokes, or by a third of their length or of their ink.
        ratios = [max(a, b) / min(a, b) for a, b in zip(period(one), period(other), strict=True)]
        assert len(one) != len(other) or max(ratios) >= 4 / 3


def period(dashed: tuple[float, ...]) -> tuple[float, float]:
    return sum(dashed), sum(dashed[::2])


def test_robots_of_one_colour_have_other_dashes_up_to_thirty() -> None:
    for place in range(10):
        looks = {dashes(index) for index in range(place, 30, 10)}
        assert len(looks) == 3
