"""A replay as a film: where robots are in it, and what is written."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from PIL import Image

from msmrta_opt import plots
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.plots.replay import film
from msmrta_opt.plots.replay.scene import clock, schedules


@pytest.fixture(autouse=True)
def few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(film, "RATES", {".gif": 2, ".mp4": 2})


@pytest.mark.parametrize(
    ("robot", "t", "place"),
    [
        *((7, 0, (0, 0)), (7, 1.5, (0, 1.5)), (7, 2, (0, 2)), (7, 5, (0, 2)), (7, 8, (0, 2))),
        *((7, 9, (0, 3)), (7, 10.5, (1.5, 3)), (7, 12, (2, 2)), (7, 99, (2, 2))),
        *((3, 0, (2, 5)), (3, 3, (2, 3.5)), (3, 6, (2, 2)), (3, 7, (2, 2))),
        *((3, 8, (2, 2.5)), (3, 13, (2, 5)), (3, 14, (2, 5))),  # its way back, at half a cell
    ],
)
def test_a_robot_is_where_its_plan_has_it(
    plan: Plan, robot: int, t: float, place: tuple[float, float]
) -> None:
    route = plan.routes[1].model_copy(update={"back": ((2, 2), (2, 3), (2, 4), (2, 5))})
    returning = plan.model_copy(update={"routes": (plan.routes[0], route)})
    assert schedules(returning)[robot].walked(t)[-1] == pytest.approx(place)


def test_a_trail_has_the_cells_walked_so_far(plan: Plan) -> None:
    walked = schedules(plan)[7].walked(10)
    assert list(dict.fromkeys(map(tuple, walked.tolist()))) == [
        *((0, 0), (0, 1), (0, 2), (0, 3), (1, 3)),
    ]
    assert schedules(plan)[7].walked(10, since=9).tolist() == [[0, 3], [1, 3], [1, 3]]


def test_a_gif_plays_scouting_and_the_mission_and_rests_on_its_end(
    plan: Plan, tmp_path: Path
) -> None:
    path = tmp_path / "film.gif"
    plan.replay().save(path)
    gif, lasted = Image.open(path), 0
    for frame in range(gif.n_frames):
        gif.seek(frame)
        lasted += gif.info["duration"]
    assert lasted == pytest.approx(1000 * (film.SCOUTING + film.MISSION + film.LAST), abs=250)
    assert path.stat().st_size < 2_000_000


def test_what_moves_has_the_colours_of_its_robot(plan: Plan) -> None:
    pictures = list(film.frames([plan], ["a plan"], 2))
    assert len(pictures) == 6 + 18 + 3
    start, end = (np.asarray(pictures[i], dtype=int) for i in (6, -1))
    for place in (0, 1):
        colour = np.round(255 * np.array(to_rgb(plots.robot_colour(place))))
        counts = [int((np.abs(x - colour).max(axis=2) <= 2).sum()) for x in (start, end)]
        assert counts[1] > counts[0] + 50


def test_two_plans_are_side_by_side(plan: Plan) -> None:
    one = next(film.frames([plan], ["one"], 2))
    both = next(film.frames([plan, plan], ["one", "two"], 2))
    assert (both.width, both.height) == (2 * one.width, one.height)


def test_the_same_plan_gives_the_same_film(plan: Plan, tmp_path: Path) -> None:
    for name in ("a.gif", "b.gif"):
        plan.replay().save(tmp_path / name)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="needs the program ffmpeg")
def test_an_mp4_is_one(plan: Plan, tmp_path: Path) -> None:
    plan.replay().save(tmp_path / "film.mp4")
    assert (tmp_path / "film.mp4").read_bytes()[4:8] == b"ftyp"


@pytest.mark.parametrize("ids", [0, 10**15])
def test_all_that_a_film_says_is_on_the_picture(
    plan: Plan, ids: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a corridor down and of a mission with long names and ids."""
    names = {"name": "a mission with a name that says it all " * 3}
    if ids:
        robots = [x.model_copy(update={"id": ids + x.id}) for x in plan.instance.robots]
        mission = plan.instance.replace(robots=tuple(robots), **names)
    else:
        mission = generate_mission(grid_from_rows(["."] * 90), 2, 4, seed=1, per_robot=(3, 6))
    boxes: list[tuple[str, Bbox]] = []
    draw = Text.draw

    def note(text: Text, *arguments: Any, **options: Any) -> None:
        boxes.append((text.get_text(), text.get_window_extent()))
        draw(text, *arguments, **options)

    monkeypatch.setattr(Text, "draw", note)
    picture = list(film.frames([make_plan(mission)], ["a planner and what it did then"], 1))[-1]
    outside = {
        said
        for said, box in boxes
        if said.strip() and (box.x0 < 0 or box.x1 > picture.width or box.y1 > picture.height)
    }
    assert outside == set()


@pytest.mark.parametrize(
    ("t", "makespan", "said"),
    [(195.04, 384, "195"), (0.00195, 0.00384, "0.00195"), (1.94e9, 4.6e9, "1.94e+09"), (0, 0, "0")],
)
def test_the_clock_of_a_film_goes_in_any_unit_of_time(t: float, makespan: float, said: str) -> None:
    assert clock(t, makespan) == said
