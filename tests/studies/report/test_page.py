"""The page of a report: whole, alone, safe, and with everything that it speaks of."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest
from support.browser import PROGRAM, WITHOUT, Browser
from support.study_records import grid_records, record, solve, solving_records, study_of

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.report import render, write_report

VOID = {"meta", "link", "img", "br"}
SMALL = {"maps": ("map0", "map1"), "robots": (2, 5, 10), "victims": (10, 50, 100), "seeds": (0, 1)}
JAVASCRIPT = Path(render.__file__).with_name("report.js").read_text(encoding="utf-8")
NASTY = '<script>alert("&")</script>'


@pytest.fixture(autouse=True, scope="module")
def few_dots() -> Iterator[None]:
    """Pictures of fewer dots, which are sooner drawn."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(render, "DPI", 20)
        yield


class Page(HTMLParser):
    """A page's elements and texts; that every element is closed is checked on the way."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = self.script = ""
        self.feed(path.read_text(encoding="utf-8"))
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] == ["script"]:
            self.script += data
        else:
            self.text += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]

    @property
    def headings(self) -> list[str]:
        return [str(item["id"]) for item in self.all("h2")]


def written(folder: Path, records: list[Record], **study: object) -> Page:
    return Page(write_report(study_of(**study), records, folder, expected=len(records) + 1))


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of planners on a grid, with failures and published figures."""
    folder = tmp_path_factory.mktemp("reports") / "grid"
    report = {"baseline": "mrga", "published": {"map0": 97.7}, "published_source": "the paper"}
    write_report(study_of(report=report), grid_records(**SMALL), folder, expected=108)
    return folder


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of formulations by solvers."""
    folder = tmp_path_factory.mktemp("reports") / "solving"
    write_report(study_of(), solving_records(), folder, expected=49)
    return folder


@pytest.fixture(params=["planned", "solved"])
def folder(request: pytest.FixtureRequest) -> Path:
    found: Path = request.getfixturevalue(request.param)
    return found


def test_the_page_loads_nothing_from_elsewhere_and_runs_its_own_script_alone(folder: Path) -> None:
    page = Page(folder / "report.html")
    assert len(page.all("script")) == 1
    assert page.script == JAVASCRIPT
    for _, attributes in page.elements:
        for name, value in attributes.items():
            assert not name.startswith("on")
            if name == "src":
                assert str(value).startswith("data:")
    for link in page.all("link"):
        assert str(link["href"]).startswith("data:")


def test_every_link_leads_somewhere(folder: Path) -> None:
    page = Page(folder / "report.html")
    ids = [str(item["id"]) for _, item in page.elements if "id" in item]
    assert len(ids) == len(set(ids))
    for link in page.all("a"):
        target = str(link["href"])
        assert target[1:] in ids if target.startswith("#") else (folder / target).is_file()


def test_every_picture_says_in_words_what_it_shows(folder: Path) -> None:
    page = Page(folder / "report.html")
    assert page.all("img")
    assert all(item["alt"] for item in page.all("img"))
    assert all(item["aria-label"] for item in page.all("svg") if item.get("role") == "img")


def test_every_figure_is_there_as_png_and_its_data_as_csv(folder: Path) -> None:
    page = Page(folder / "report.html")
    pictures = sorted(item.stem for item in (folder / "figures").iterdir())
    assert len(pictures) == len(page.all("figure"))
    for name in pictures:
        assert (folder / "figures" / f"{name}.png").read_bytes()[1:4] == b"PNG"
        assert (folder / "data" / f"{name}.csv").read_text(encoding="utf-8").count("\n") > 1


def test_planners_have_heat_maps_growth_profiles_and_failures(planned: Path) -> None:
    page = Page(planned / "report.html")
    assert page.headings == [
        "section-who-won",
        "section-results",
        "section-against-mrga",
        "section-times-over-robots-and-victims",
        "section-plans-over-robots-and-victims",
        "section-growth",
        "section-performance-profiles",
        "section-what-was-run-on-what",
        "section-failures",
    ]
    # A panel for each of 7 measures on 2 maps of 3 contenders.
    assert sum(item.get("role") == "img" for item in page.all("svg")) == 7 * 2 * 3
    assert "10 robots, 100 victims: failed (2 of 2 runs)" in page.text
    assert "2 robots, 10 victims: not run" in page.text
    assert "1 of 2 runs failed" in page.text
    assert "97.7" in page.text


def test_formulations_have_no_plans_to_show(solved: Path) -> None:
    page = Page(solved / "report.html")
    assert "section-plans-over-robots-and-victims" not in page.headings
    assert "section-performance-profiles" in page.headings
    assert "1 skipped" in page.text


def test_one_run_is_told_in_tables_alone(tmp_path: Path) -> None:
    page = written(tmp_path / "one", [record("paper", "msmrta", 0.012, distance=300)])
    assert page.headings == ["section-results", "section-what-was-run-on-what"]
    assert "1 of 2 runs done" in page.text
    assert not list((tmp_path / "one" / "figures").iterdir())


def test_a_study_of_which_nothing_is_done_says_so(tmp_path: Path) -> None:
    page = written(tmp_path / "none", [])
    assert "No run has been done yet" in page.text
    assert (tmp_path / "none" / "data" / "runs.csv").is_file()


@pytest.mark.parametrize(
    "records",
    [
        [
            record("a", "msmrta", outcome="raised", error="no"),
            solve("a", "m", "highs", status="error"),
        ],
        [solve("a", "m", "highs", 5.0, status="feasible", gap=None)],
        [record("a", "one", 0.0), record("a", "two", 0.0), record("b", "one", 0.0)],
    ],
    ids=["nothing finished", "nothing optimal", "no time at all"],
)
def test_results_that_nothing_can_be_made_of_still_make_a_report(
    records: list[Record], tmp_path: Path
) -> None:
    assert "section-results" in written(tmp_path / "odd", records).headings


def test_names_and_errors_are_shown_and_never_run(tmp_path: Path) -> None:
    records = [
        record(f"{n}x{m}{NASTY}", who, n * m / 1e3, map=NASTY, n_robots=n, n_victims=m)
        for who in (NASTY, r"$\frac{$ & <b>", "\N{CJK UNIFIED IDEOGRAPH-6551}\x07" + 2000 * "long ")
        for n in (2, 3)
        for m in (10, 20, 30)
    ]
    records.append(record("lost", NASTY, outcome="raised", error=NASTY, map=NASTY))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        page = written(tmp_path / "nasty", records, title=NASTY, report={"baseline": NASTY})
    assert page.script == JAVASCRIPT
    assert page.text.count(NASTY) > 5


def test_the_same_records_give_the_same_bytes(tmp_path: Path) -> None:
    records = grid_records(maps=("map0",), robots=(2, 3), victims=(10, 20, 30))
    for name in ("first", "second"):
        written(tmp_path / name, records)
    first, second = (
        {path.relative_to(tmp_path / name): path.read_bytes() for path in files}
        for name in ("first", "second")
        for files in [[p for p in (tmp_path / name).rglob("*") if p.is_file()]]
    )
    assert first == second


def test_an_older_report_is_replaced_whole(tmp_path: Path) -> None:
    written(tmp_path / "report", solving_records())
    written(tmp_path / "report", [record("paper", "msmrta")])
    assert not list((tmp_path / "report" / "figures").iterdir())
    assert [item.name for item in tmp_path.iterdir()] == ["report"]


@pytest.mark.parametrize("name", ["notes.txt", "data/notes.txt", "report.html", "figures/mine.csv"])
def test_what_is_not_a_report_is_left_alone(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "report"
    written(folder, [record("paper", "msmrta")])
    (folder / name).write_text("mine")
    before = (folder / "data" / "runs.csv").read_bytes()
    with pytest.raises(InputError, match="report"):
        written(folder, [])
    assert (folder / name).read_text() == "mine"
    assert (folder / "data" / "runs.csv").read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["report"]


def test_a_file_in_the_place_of_the_folder_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "report").write_text("mine")
    with pytest.raises(InputError, match="name another"):
        written(tmp_path / "report", [])
    assert (tmp_path / "report").read_text() == "mine"


def test_a_report_that_cannot_be_made_leaves_the_older_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path / "report", [record("paper", "msmrta")])
    before = (tmp_path / "report" / "report.html").read_bytes()
    monkeypatch.setattr("msmrta_opt.studies.report.render.write_text", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        written(tmp_path / "report", [])
    assert (tmp_path / "report" / "report.html").read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["report"]


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    if PROGRAM is None:
        pytest.skip(WITHOUT)
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


@pytest.mark.parametrize("width", [400, 1280])
def test_the_page_is_as_wide_as_its_window(planned: Path, browser: Browser, width: int) -> None:
    browser.complaints.clear()
    browser.open(planned / "report.html", width=width)
    assert browser.run("document.documentElement.scrollWidth") <= width
    assert browser.run("[...document.images].every((image) => image.naturalWidth > 0)")
    assert browser.complaints == []


def test_a_click_on_a_heading_sorts_a_table_by_its_numbers(planned: Path, browser: Browser) -> None:
    browser.open(planned / "report.html")
    sort = """(() => {
        const table = document.querySelector('[aria-labelledby="planning-times"] table');
        const at = [...table.tHead.rows[0].cells].findIndex((x) => x.textContent === "median (s)");
        const heading = table.tHead.rows[0].cells[at];
        heading.firstElementChild.click();
        return [
            heading.getAttribute("aria-sort"),
            [...table.tBodies[0].rows].map((row) => +row.cells[at].dataset.value),
        ];
    })()"""
    way, values = browser.run(sort)
    assert (way, values) == ("ascending", sorted(values))
    assert len(set(values)) == 3
    way, values = browser.run(sort)
    assert (way, values) == ("descending", sorted(values, reverse=True))


def test_on_paper_no_table_is_cut_and_nothing_stays_folded(
    planned: Path, solved: Path, browser: Browser
) -> None:
    for folder in (planned, solved):
        # The width of a sheet of A4 across, without its margins.
        browser.open(folder / "report.html", width=1032)
        browser.ask("Emulation.setEmulatedMedia", media="print")
        browser.run("document.querySelectorAll('details').forEach((x) => { x.open = false; })")
        browser.run("dispatchEvent(new Event('beforeprint'))")
        cut = browser.run(
            "[...document.querySelectorAll('table')]"
            ".filter((x) => x.offsetWidth > x.parentElement.clientWidth || !x.offsetHeight).length"
        )
        browser.ask("Emulation.setEmulatedMedia", media="")
        assert cut == 0
