"""The space of plans: shares, dots and the square are those of the regions, and they are linked."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex
from support.browser import PROGRAM, WITHOUT, Browser
from support.legible import illegible

import msmrta_opt as mo
from msmrta_opt.cli import run
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.plan import Plan
from msmrta_opt.studies.analysis.plan_space import APART, PlanSpace
from msmrta_opt.studies.analysis.tradeoff_results import Region, Regions

HALF, ONE, NONE = Fraction(1, 2), Fraction(1), Fraction(0)


def found(plan: Plan) -> PlanSpace:
    """Plan 1 on the left half and the upper right quarter, plan 2, of one robot, on the rest."""
    fields = {name: getattr(plan, name) for name in Plan.model_fields}
    lazy = (plan.routes[0], plan.routes[1].model_copy(update={"visits": ()}))
    other = Plan.model_validate({**fields, "routes": lazy})
    regions = (
        Region((NONE, HALF), (NONE, ONE), plan, True),
        Region((HALF, ONE), (NONE, HALF), other, True),
        Region((HALF, ONE), (HALF, ONE), plan, False),
    )
    space: PlanSpace = mo.explore(Regions(regions, True, 7)).space
    return space


def test_shares_are_areas_of_the_square_and_metrics_those_of_the_plans(plan: Plan) -> None:
    first, second = found(plan).dots
    assert (first.share, second.share) == (Fraction(3, 4), Fraction(1, 4))
    # Robot 7 is busy for 14, robot 3 for 7.
    assert (first.metrics["makespan"], first.metrics["total_time"]) == (14, 21)
    assert (second.metrics["makespan"], second.metrics["total_time"]) == (14, 14)
    assert (first.unique, second.unique) == (False, True)


def test_the_sentence_says_the_largest_share_and_the_best(plan: Plan) -> None:
    assert found(plan).sentence == (
        "Plan 1 holds the largest part of the square, 75 % of it. All have the makespan 14."
        " The smallest total time is 14, by plan 2; the largest 21."
    )


def test_dots_have_the_area_of_their_share(plan: Plan) -> None:
    figure = found(plan).plot()
    dots = [x for x in figure.axes[0].collections if isinstance(x, PathCollection)]
    assert [tuple(map(float, x.get_offsets()[0])) for x in dots] == [(14, 21), (14, 14)]
    (large,), (small,) = (x.get_sizes() for x in dots)
    assert large == pytest.approx(3 * small)
    boxes = [(p.get_x(), p.get_y(), p.get_width(), p.get_height()) for p in figure.axes[1].patches]  # type: ignore[attr-defined]
    assert boxes == [(0, 0, 0.5, 1), (0.5, 0, 0.5, 0.5), (0.5, 0.5, 0.5, 0.5)]
    assert illegible(figure) == []


def test_no_two_plans_have_one_colour_and_those_at_one_place_stand_side_by_side(plan: Plan) -> None:
    space = found(plan)
    alike = [dataclasses.replace(dot, metrics=space.dots[0].metrics) for dot in space.dots]
    space.__dict__["dots"] = alike
    figure = space.plot()
    dots = [x for x in figure.axes[0].collections if isinstance(x, PathCollection)]
    assert len({to_hex(x.get_facecolor()[0]) for x in dots}) == 2
    figure.draw_without_rendering()
    one, other = (x.get_offset_transform().transform((14, 21))[0] for x in dots)
    assert abs(one - other) == pytest.approx(APART * figure.dpi / 72)


def test_one_parameter_alone_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match="result: is over one parameter; give what `tradeoff_reg"):
        mo.explore(mo.tradeoff(mo.example("corridor"))).save(tmp_path / "e.html")
    assert run(["tradeoff", "corridor", "--explore", str(tmp_path / "e.html")]) == 2
    assert "--explore: is of two parameters; give --over psi,beta" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    if PROGRAM is None:
        pytest.skip(WITHOUT)
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


def test_a_dot_of_the_page_and_its_parts_of_the_square_are_linked(
    plan: Plan, browser: Browser, tmp_path: Path
) -> None:
    page = tmp_path / "plans.html"
    found(plan).save(page)
    browser.requests.clear()
    browser.open(page, width=400)
    assert browser.run("document.documentElement.scrollWidth") <= 400
    radii = browser.run(
        "Object.fromEntries([...document.querySelectorAll('.dot')].map("
        "(dot) => [dot.dataset.plan, +dot.querySelector('.area').getAttribute('r')]))"
    )
    assert radii["1"] ** 2 == pytest.approx(3 * radii["2"] ** 2)
    fills = (
        "new Set([...document.querySelectorAll('.area')].map((x) => x.getAttribute('fill'))).size"
    )
    for across in ("makespan", "total_time"):  # the first is the same for both plans
        choose = "const x = document.getElementById('across');"
        browser.run(f"{{ {choose} x.value = '{across}'; x.dispatchEvent(new Event('change')) }}")
        assert browser.run(fills) == 2
    marked = "[...document.querySelectorAll('.region.on')].map((x) => +x.dataset.plan)"
    browser.run("document.querySelector('.dot[data-plan=\"1\"]').focus()")
    browser.press("Enter")
    assert browser.run(marked) == [1, 1]
    told = browser.run("document.getElementById('told').textContent")
    assert "optimal for ψ 0 to 1/2 with β 0 to 1; ψ 1/2 to 1 with β 1/2 to 1" in told
    assert "R7: v20 → v10" in told
    browser.press("Escape")
    assert browser.run(marked) == []
    browser.run("document.querySelectorAll('.region')[1].dispatchEvent(new Event('click'))")
    assert browser.run("document.querySelector('.dot.on').dataset.plan") == "2"
    assert browser.complaints == []
    assert all(url.startswith(("file:", "about:", "data:")) for url in browser.requests)
