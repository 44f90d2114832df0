"""What sliders over a trade-off point to, and the film strip in their place."""

from __future__ import annotations

import sys

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.studies.analysis.explore import MAX_FRAMES, Explorer, explore
from msmrta_opt.studies.analysis.tradeoff import tradeoff, tradeoff_regions
from msmrta_opt.studies.analysis.tradeoff_results import Regions, Tradeoff


@pytest.fixture(scope="module")
def over_psi(paper: Instance) -> Tradeoff:
    return tradeoff(paper, over="psi")


@pytest.fixture(scope="module")
def square(paper: Instance) -> Regions:
    return tradeoff_regions(paper)


def test_a_value_points_to_its_piece(over_psi: Tradeoff) -> None:
    # By hand: 10 - 6 psi and 9 - 3 psi cross at 1/3.
    explorer = explore(over_psi)
    assert explorer.parameters == {"ψ": (0, 1)}
    assert explorer.at(0.33).words.startswith("Piece 1 of 2, ψ from 0 to 1/3: robots take C1, C0")
    assert explorer.at(0.34).words.startswith("Piece 2 of 2, ψ from 1/3 to 1: robots take C0, C2")
    assert [frame.plan for frame in explorer.frames] == [s.plan for s in over_psi.segments]


def test_two_values_point_to_their_region(square: Regions) -> None:
    explorer = explore(square)
    for region in square.regions:
        middle = [float(sum(ends) / 2) for ends in (region.psi, region.beta)]
        assert explorer.at(*middle).plan.routes == region.plan.routes


def test_moving_a_slider_shows_another_map_and_says_which(over_psi: Tradeoff) -> None:
    image, side = explore(over_psi).controls().children
    slider, words = side.children
    before = (image.value, words.value)
    slider.value = 0.9
    assert words.value.startswith("Piece 2 of 2")
    assert before[1].startswith("Piece 1 of 2")
    assert image.value != before[0]


def test_the_film_has_a_map_for_each_plan_and_the_square_before_them(
    over_psi: Tradeoff, square: Regions
) -> None:
    titles = [ax.get_title() for ax in explore(over_psi).film().axes]
    assert [title.split("\n")[0] for title in titles] == ["ψ from 0 to 1/3", "ψ from 1/3 to 1"]
    maps = [ax.get_title() for ax in explore(square).film().axes if ax.get_title()]
    assert [title.split("\n")[0] for title in maps] == ["Makespan", "plan 1", "plan 2", "plan 3"]


def test_a_film_of_many_plans_says_how_many_it_leaves_out(over_psi: Tradeoff) -> None:
    explorer = Explorer(over_psi)
    explorer.frames = explorer.frames * MAX_FRAMES
    film = explorer.film()
    assert len(film.axes) == MAX_FRAMES
    assert film.get_suptitle() == f"{MAX_FRAMES} of {2 * MAX_FRAMES} plans"


def test_without_widgets_it_is_a_picture(
    over_psi: Tradeoff, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = explore(over_psi)._repr_mimebundle_()
    assert {"image/png", "application/vnd.jupyter.widget-view+json"} < set(shown)
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    alone = explore(over_psi)._repr_mimebundle_()
    assert set(alone) == {"image/png", "text/plain"}
    assert alone["image/png"].startswith(b"\x89PNG")


def test_what_cannot_be_explored_is_told(over_psi: Tradeoff, square: Regions) -> None:
    with pytest.raises(InputError, match="Plan; give what `tradeoff`"):
        explore(over_psi.segments[0].plan)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"ψ: 1\.5; it lies in \[0, 1\]"):
        explore(over_psi).at(1.5)
    with pytest.raises(InputError, match="1 values; give one each of ψ, β"):
        explore(square).at(0.5)
