"""The pages are for everybody: axe-core finds nothing wrong, in light and dark, wide and narrow."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import pytest
from support.axe import SCRIPT, WITHOUT_AXE, violations
from support.browser import PROGRAM, WITHOUT, Browser
from support.small_run import small_plan, small_run
from support.study_records import grid_records, study_of

from msmrta_opt.studies.analysis.plan_space import PlanSpace
from msmrta_opt.studies.analysis.tradeoff_results import Region, Regions
from msmrta_opt.studies.report import render, write_report

pytestmark = [
    pytest.mark.skipif(PROGRAM is None, reason=WITHOUT),
    pytest.mark.skipif(SCRIPT is None, reason=WITHOUT_AXE),
]


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


def replay_of_a_plan(folder: Path) -> Path:
    small_plan().replay().save(folder / "page.html")
    return folder / "page.html"


def replay_of_runs(folder: Path) -> Path:
    small_run().replay(small_run()).save(folder / "page.html")
    return folder / "page.html"


def plans_over_two_parameters(folder: Path) -> Path:
    whole = (Fraction(0), Fraction(1))
    PlanSpace(Regions((Region(whole, whole, small_plan(), True),), True, 1)).save(
        folder / "page.html"
    )
    return folder / "page.html"


def report(folder: Path) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(render, "DPI", 20)
        write_report(
            study_of(),
            grid_records(maps=["map0"], robots=[2, 4], victims=[10, 20]),
            folder / "report",
            expected=1,
        )
    return folder / "report" / "report.html"


@pytest.mark.parametrize(
    "made", [replay_of_a_plan, replay_of_runs, plans_over_two_parameters, report]
)
def test_axe_finds_nothing(made: Callable[[Path], Path], browser: Browser, tmp_path: Path) -> None:
    page = made(tmp_path)
    for scheme in ("light", "dark"):
        browser.prefer(prefers_color_scheme=scheme)
        for width in (1280, 400):
            browser.open(page, width=width)
            assert violations(browser) == []
    assert browser.complaints == []


def test_axe_finds_what_is_wrong(browser: Browser, tmp_path: Path) -> None:
    page = tmp_path / "wrong.html"
    page.write_text("<html><title>x</title><main><h1>x</h1><img src='data:,'></main></html>")
    browser.open(page)
    assert {line.partition(":")[0] for line in violations(browser)} >= {
        "html-has-lang",
        "image-alt",
    }
