"""Pictures: composed anywhere, labelled, robots alike in all of them, the same bytes each time."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from msmrta_opt import plots
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan, Track
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.plots.figure import PictureAxes
from msmrta_opt.plots.marks import served_groups
from msmrta_opt.plots.scouting import first_seen
from msmrta_opt.plots.style import FADED, MISSED, robot_styles
from msmrta_opt.plots.titles import says

PANELS: list[Callable[..., Axes]] = [
    plots.plot_scouting,
    plots.plot_assignment,
    plots.plot_paths,
    plots.plot_gantt,
]


@pytest.fixture(scope="module")
def planned() -> Plan:
    return make_plan(Instance.read(Path(__file__).parents[2] / "instances" / "paper.json"))


def texts(ax: Axes) -> str:
    legends = [legend.get_texts() for legend in [ax.get_legend()] if legend]
    parts = [ax.get_title(), ax.get_title("left"), ax.get_xlabel(), ax.get_ylabel()]
    parts += [text.get_text() for text in ax.texts]
    parts += [label.get_text() for above in ax.child_axes for label in above.get_xticklabels()]
    return " ".join([*parts, *(text.get_text() for group in legends for text in group)])


@pytest.mark.parametrize("draw", PANELS)
def test_a_picture_is_drawn_into_given_axes_or_its_own(
    planned: Plan, draw: Callable[..., Axes]
) -> None:
    figure = Figure()
    ax = figure.subplots()
    assert draw(planned, ax) is ax
    assert ax.has_data()
    own = draw(planned)
    assert own is not ax
    assert own.has_data()


@pytest.mark.parametrize("draw", PANELS)
def test_axes_say_what_they_measure_and_in_what(planned: Plan, draw: Callable[..., Axes]) -> None:
    said = texts(draw(planned))
    units = ("time units",) if draw is plots.plot_gantt else ("row (cells)", "column (cells)")
    for unit in units:
        assert unit in said


def test_the_panels_say_what_the_plan_says(planned: Plan) -> None:
    assert "10 of 10 victims found" in texts(plots.plot_scouting(planned))
    assert f"makespan {planned.metrics.makespan:g}" in texts(plots.plot_gantt(planned))
    assert str(planned.metrics.distance) in texts(plots.plot_paths(planned))
    assert "no robot has it: 2 requirements" in texts(plots.plot_assignment(planned))


def test_a_map_is_drawn_with_its_first_row_on_top(planned: Plan) -> None:
    ax = plots.plot_map(planned.instance.map)
    low, high = ax.get_ylim()
    assert low > high
    assert ax.get_aspect() == 1


def test_robots_have_the_same_colour_in_every_picture(planned: Plan) -> None:
    n_robots = planned.instance.n_robots
    colours = [to_hex(plots.robot_colour(r)) for r in range(n_robots)]
    assert len(set(colours)) == n_robots
    paths = {to_hex(line.get_color()) for line in plots.plot_paths(planned).get_lines()}
    bars = {to_hex(c) for x in plots.plot_gantt(planned).collections for c in x.get_facecolor()}
    assert set(colours) <= paths
    assert set(colours) <= bars


def test_coverage_rises_to_what_the_report_says(planned: Plan) -> None:
    assert planned.scouting is not None
    ax = plots.plot_coverage(planned.scouting)
    assert "%" in texts(ax)
    ends = [float(line.get_ydata()[-1]) for line in ax.get_lines() if len(line.get_ydata())]
    assert 100 * planned.scouting.coverage[-1] in [pytest.approx(end) for end in ends]


def mission(n_robots: int, n_victims: int, **changes: Any) -> Instance:
    open_map = grid_from_rows(["." * 12] * 12)
    return generate_mission(open_map, n_robots, n_victims, seed=1, **changes, solvable=False)


@pytest.mark.parametrize(
    "instance",
    [
        mission(2, 0),
        mission(12, 30),
        mission(1, 1),
        generate_mission(grid_from_rows(["..", ".@", ".."]), 2, 2, seed=0, solvable=False),
    ],
    ids=["no victims", "twelve robots", "one of each", "3×2 cells"],
)
def test_any_plan_can_be_drawn(instance: Instance, tmp_path: Path) -> None:
    plots.save_figure(make_plan(instance).plot(), tmp_path / "plan.png", dpi=40)
    with Image.open(tmp_path / "plan.png") as picture:
        assert picture.size > (100, 100)


@pytest.mark.parametrize("planner", ["mrga", "random"])
def test_plans_of_other_planners_can_be_drawn(planned: Plan, planner: str) -> None:
    figure = make_plan(planned.instance, planner=planner).plot()
    titles = [ax.get_title().split("\n")[0] for ax in figure.axes]
    assert titles[:2] == ["Scouting", "Paths"]  # without stages there is no assignment to show


def test_the_same_plan_gives_the_same_bytes(planned: Plan, tmp_path: Path) -> None:
    for name in ("one.png", "two.png", "one.svg", "two.svg"):
        plots.save_figure(planned.plot(), tmp_path / name, dpi=40)
    for suffix in ("png", "svg"):
        one, two = (tmp_path / f"{name}.{suffix}" for name in ("one", "two"))
        assert one.read_bytes() == two.read_bytes()


def test_an_unknown_format_is_refused_and_nothing_is_written(planned: Plan, tmp_path: Path) -> None:
    path = tmp_path / "plan.gif"
    with pytest.raises(InputError, match=r"plan\.gif.*'\.gif'.*\.png, \.svg, \.pdf"):
        plots.save_figure(Figure(), path)
    assert list(tmp_path.iterdir()) == []


def test_pyplot_and_its_settings_are_left_alone(planned: Plan) -> None:
    before = dict(plt.rcParams)
    planned.plot()
    assert plt.get_fignums() == []
    assert dict(plt.rcParams) == before


def touches_an_edge(png: bytes) -> bool:
    pixels = np.asarray(Image.open(BytesIO(png)).convert("L"))
    frame = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    return bool((frame < 255).any())


def test_a_title_wider_than_its_map_is_not_cut(tmp_path: Path) -> None:
    narrow = generate_mission(grid_from_rows(["..", ".@", ".."]), 2, 2, seed=0, solvable=False)
    ax = plots.plot_paths(make_plan(narrow))
    ax.set_title("wider than any map of two columns is, by a good deal of words")
    assert isinstance(ax, PictureAxes)
    shown = ax._repr_png_()
    assert shown is not None
    assert not touches_an_edge(shown)
    plots.save_figure(ax.figure, tmp_path / "paths.png")
    assert not touches_an_edge((tmp_path / "paths.png").read_bytes())


def test_timelines_can_have_one_scale_which_cuts_none_of_them(planned: Plan) -> None:
    makespan = planned.metrics.makespan
    ends = [
        plots.plot_gantt(planned, until=until).get_xlim()[1]
        for until in (None, 0.5 * makespan, 2 * makespan)
    ]
    assert ends[0] == ends[1] >= makespan
    assert ends[2] == pytest.approx(2 * ends[0])


def test_a_title_of_ones_own_takes_the_place_of_the_timelines(planned: Plan) -> None:
    ax = plots.plot_gantt(planned)
    ax.set_title("mine")
    assert [ax.get_title(side) for side in ("left", "center", "right")] == ["", "mine", ""]


@pytest.mark.parametrize("own", [True, False], ids=["own figure", "low figure"])
def test_names_of_clusters_leave_those_of_victims_legible(planned: Plan, own: bool) -> None:
    given = None if own else Figure(figsize=(5.5, 6.3), layout="constrained").subplots()
    ax = plots.plot_assignment(planned, given)
    ax.figure.savefig(BytesIO())
    boxes = {text.get_text(): text.get_window_extent() for text in ax.texts}
    clusters = [box for name, box in boxes.items() if name.startswith("C")]
    names = {str(victim.id) for victim in planned.instance.victims}
    victims = [box for name, box in boxes.items() if name in names]
    assert len(clusters) == len(planned.clusters)
    assert len(victims) == planned.instance.n_victims
    assert not any(one.overlaps(other) for one in clusters for other in victims)


def test_what_a_scout_saw_is_cut_by_walls_and_dated_by_its_first_sight() -> None:
    # One row above a wall with a gap; the scout walks right, looking two cells far.
    grid = grid_from_rows(["....", "@@.@", "...."])
    track = Track(scout=0, visual_field_depth=2, cells=((0, 0), (0, 1), (0, 2)))
    seen = first_seen(grid, [track])
    never = np.inf
    assert seen[0].tolist() == [0, 0, 0, 1]
    # Down through the gap: on a diagonal that grazes its two corners, or straight from above it.
    assert seen[1].tolist() == [never, never, 1, never]
    assert seen[2].tolist() == [never, never, 2, 1]


def test_a_title_says_who_planned_and_what_was_done_or_proven(planned: Plan) -> None:
    assert says(planned) == "msmrta"
    improved = planned.model_copy(update={"options": {"improve": 1.0}})
    assert says(improved) == "msmrta + 1 s local search"
    proof = planned.certificates[0].model_copy(
        update={"stage": "joint problem", "status": "optimal", "bound": 3655 / 3, "gap": 0.0}
    )
    exact = planned.model_copy(update={"planner": "exact", "certificates": (proof,)})
    assert says(exact) == "exact: optimal, bound 1218.33"
    assert says(exact) in " ".join(text.get_text() for text in exact.plot().texts)


def test_clusters_are_outlined_only_while_they_say_who_serves_whom(planned: Plan) -> None:
    moved = [
        route.model_copy(
            update={
                "visits": tuple(v.model_copy(update={"stage": "improved"}) for v in route.visits)
            }
        )
        for route in planned.routes
    ]
    improved = planned.model_copy(update={"routes": tuple(moved)})
    for plan, outlined in ((planned, True), (improved, False)):
        names = [text.get_text() for text in plots.plot_assignment(plan).texts]
        assert any(name.startswith("C") for name in names) is outlined


def test_a_red_ring_is_around_each_unserved_victim_in_every_panel(planned: Plan) -> None:
    unserved = {item.victim for item in planned.unserved}
    assert len(unserved) == 2
    for draw in PANELS[:3]:
        red = [
            len(group.get_paths())
            for group in draw(planned).collections
            if [to_hex(c) for c in group.get_facecolor()] == [MISSED.lower()]
        ]
        assert red == [len(unserved)]


def test_a_large_mission_is_one_map_and_a_timeline_sorted_by_finish() -> None:
    plan = make_plan(mission(12, 30))
    page = plan.plot()
    paths, timeline = page.axes[:2]
    assert len(page.axes) == 2
    assert len(paths.texts) == 12  # the robots' starts
    done = {route.robot: route.visits[-1].departure for route in plan.routes if route.visits}
    rows = [int(label.get_text()[1:]) for label in timeline.get_yticklabels()]
    finished = [done.get(robot, 0.0) for robot in rows]
    assert finished == sorted(finished, reverse=True)


def test_letters_stay_letters_in_svg_and_truetype_in_pdf(planned: Plan, tmp_path: Path) -> None:
    ax = plots.plot_gantt(planned)
    for name in ("plan.svg", "plan.pdf"):
        plots.save_figure(ax, tmp_path / name)
    assert ">time (time units)</text>" in (tmp_path / "plan.svg").read_text(encoding="utf-8")
    pdf = (tmp_path / "plan.pdf").read_bytes()
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf


def test_a_small_mission_on_a_large_map_has_marks_and_names_of_its_own() -> None:
    wide = grid_from_rows(["." * 120] * 3)
    plan = make_plan(generate_mission(wide, 2, 3, seed=1))
    names = {text.get_text() for text in plots.plot_paths(plan).texts}
    assert {f"{victim.id}" for victim in plan.instance.victims} <= names
    assert {f"R{robot.id}" for robot in plan.instance.robots} <= names


def test_what_stayed_with_its_robot_is_grey_requirement_by_requirement(planned: Plan) -> None:
    route = next(r for r in planned.routes if any(len(v.served) > 1 for v in r.visits))
    visit = next(v for v in route.visits if len(v.served) > 1)
    stays = {(visit.victim, visit.served[0])}
    own, grey = to_hex(robot_styles(planned.instance)[route.robot].colour), FADED.lower()
    arcs = {
        group.cell: {colour.lower() for *_, colour in group.arcs}
        for group in served_groups(planned, stays)
    }
    cell = next(v.cell for v in planned.instance.victims if v.id == visit.victim)
    assert {own, grey} <= arcs[cell]
    bars = [
        (box.x0, box.x1, to_hex(face))
        for group in plots.plot_gantt(planned, faded=stays).collections
        for path, face in zip(group.get_paths(), group.get_facecolor(), strict=False)
        if (box := path.get_extents()).height > 0.5
    ]
    times = planned.instance.service_time
    until = visit.arrival + times[visit.served[0]]
    assert (visit.arrival, pytest.approx(until), grey) in bars
    assert (pytest.approx(until), pytest.approx(visit.departure), own) in bars


def test_a_bar_too_short_for_its_victims_number_has_it_beside_it() -> None:
    document = Instance.read(Path(__file__).parents[2] / "instances" / "paper.json")
    brief = dict.fromkeys(document.service_time, 0.5)
    victims = [v.model_copy(update={"service_time": {}}) for v in document.victims]
    plan = make_plan(document.replace(service_time=brief, victims=victims))
    ax = plots.plot_gantt(plan)
    shown = sorted(text.get_text() for text in ax.texts)
    assert shown == sorted(f"v{v.victim}" for route in plan.routes for v in route.visits)
    for row, route in enumerate(plan.routes):
        places = [text.get_position()[0] for text in ax.texts if text.get_position()[1] == row]
        assert not any(v.arrival < x < v.departure for x in places for v in route.visits)
