"""The documentation site: pages have their places, what they show is so, they open without a network."""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from support.axe import SCRIPT, WITHOUT_AXE, violations
from support.browser import PROGRAM, WITHOUT, Browser

import msmrta_opt as mo
from msmrta_opt import cli, formulations
from msmrta_opt.planners import planners
from msmrta_opt.public import HOME
from msmrta_opt.routing.objectives import OBJECTIVES

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
ELSEWHERE = ("models", "instances", "instances/suite", "studies", "benchmarks", "notebooks")
PAGES = [
    *sorted(DOCS.glob("*.md")),
    *sorted((ROOT / "notebooks").glob("*.ipynb")),
    *(ROOT / folder / "README.md" for folder in ELSEWHERE),
    ROOT / "CONTRIBUTING.md",
    ROOT / "CHANGELOG.md",
]
LINK = re.compile(r"(?<!!)\[[^\]\n]*\]\(([^)\s]+)\)")


def text_of(page: Path) -> str:
    """A page's Markdown, without its code."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    return re.sub(r"^ {0,3}```.*?^ {0,3}```$|`[^`\n]*`", "", text, flags=re.M | re.S)


def test_every_page_is_in_the_table_of_contents_once() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = []
    for tree in re.findall(r"^```\{toctree\}\n(.*?)^```$", index, flags=re.M | re.S):
        for line in filter(None, tree.splitlines()):
            if not line.startswith(":"):
                name = re.sub(r".*<(.*)>", r"\1", line)
                listed.append((DOCS / name).resolve())
    there = [page.with_suffix("") for page in PAGES if page.name != "index.md"]
    assert sorted(listed) == sorted(there)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_between_files_lead_to_files(page: Path) -> None:
    links = [link.partition("#")[0] for link in LINK.findall(text_of(page))]
    local = [link for link in links if link and not urlsplit(link).scheme]
    assert [link for link in local if not (page.parent / unquote(link)).exists()] == []


# The tutorial


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    return tmp_path


def blocks(page: str) -> list[tuple[str, str]]:
    text = (DOCS / page).read_text(encoding="utf-8")
    return re.findall(r"^```(\w+)\n(.*?)^```$", text, flags=re.M | re.S)


@pytest.mark.parametrize("page", ["tutorial.md", "index.md"])
def test_the_python_of_a_page_prints_what_it_shows(page: str, here: Path) -> None:
    shown = blocks(page)
    names: dict[str, Any] = {}
    for (language, code), (following, text) in zip(shown, [*shown[1:], ("", "")], strict=True):
        if language == "python":
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                exec(compile(code, page, "exec"), names)
            if following == "text":
                assert said.getvalue() == text


def test_the_commands_of_the_tutorial_work_in_their_order(here: Path) -> None:
    for language, text in blocks("tutorial.md"):
        for line in text.splitlines() if language == "sh" else ():
            program, *words = shlex.split(line)
            assert program == "msmrta"
            assert cli.run(words) == 0, line
    made = {"plan.json", "plan.png", "plan.html", "cluster_mine.py", "rooms.json"}
    assert made <= {path.name for path in here.iterdir()}


# Certified values


VALUES = json.loads((DOCS / "certified_values.json").read_text(encoding="utf-8"))


def test_every_shipped_instance_has_a_certified_value_of_each_objective() -> None:
    kept = [(row["instance"], row["objective"]) for row in VALUES]
    assert sorted(kept) == sorted((name, x) for name in mo.examples() for x in OBJECTIVES)
    for row in VALUES:
        mission = mo.example(row["instance"])
        assert (row["robots"], row["victims"]) == (mission.n_robots, mission.n_victims)
        assert row["bound"] <= row["value"] * (1 + 1e-9)
        assert (row["status"] == "optimal") == (row["value"] - row["bound"] <= 1e-6 * row["value"])


def test_certified_values_are_those_worked_out_by_hand() -> None:
    """In the descriptions of the small instances, and in the table of `instances/README.md`."""
    by_hand = {
        "corridor": (9, 9), "two_rooms": (13, 9), "walled_in": (6, 6), "split": (13, 8),
        "scouted": (5, 5), "sum_or_max": (5, 4), "no_victims": (0, 0),
    }  # fmt: skip
    kept = {(row["instance"], row["objective"]): row["value"] for row in VALUES}
    for name, values in by_hand.items():
        assert (kept[name, "total_time"], kept[name, "makespan"]) == pytest.approx(values)


def test_no_planner_makes_a_plan_below_a_certified_bound() -> None:
    for row in VALUES:
        if row["victims"] <= 12:
            plan = mo.plan(mo.example(row["instance"]), planner="ssi")
            reached = getattr(plan.metrics, row["objective"])
            assert reached >= row["bound"] - 1e-6 * abs(row["bound"])


@pytest.mark.slow
@pytest.mark.parametrize(
    "row",
    [row for row in VALUES if row["status"] == "optimal" and row["victims"] <= 24],
    ids=lambda row: f"{row['instance']}-{row['objective']}",
)
def test_a_certified_value_is_found_and_proved_again(row: dict[str, Any]) -> None:
    plan = mo.plan(
        mo.example(row["instance"]), planner="exact", objective=row["objective"], time_limit=120
    )
    found = mo.check_plan(plan).certificates[0]
    assert found.bound == pytest.approx(row["value"])
    assert found.objective == pytest.approx(row["value"])


# What is worked out from the package, with what the site is built by


@pytest.fixture(scope="module")
def from_package() -> Iterator[ModuleType]:
    pytest.importorskip("sphinx", reason="needs the extra docs")
    pytest.importorskip("numpydoc", reason="needs the extra docs")
    sys.path.insert(0, str(DOCS / "_ext"))
    yield importlib.import_module("from_package")
    sys.path.remove(str(DOCS / "_ext"))


def test_every_option_of_every_planner_has_a_meaning_and_a_place(
    from_package: ModuleType,
) -> None:
    page = (DOCS / "options.md").read_text(encoding="utf-8")
    for name, planner in planners().items():
        rows = from_package.planner_options(name)
        assert [row[0].strip("`") for row in rows] == list(planner.options)
        assert all(row[1] for row in rows)
        assert f"```{{planner-options}} {name}\n" in page
    (preset,) = (row for row in from_package.planner_options("msmrta") if row[0] == "`preset`")
    assert preset[3] == "`paper`, `authors`"


def test_every_public_name_is_in_the_reference(from_package: ModuleType) -> None:
    page = (DOCS / "reference.md").read_text(encoding="utf-8")
    homes = " ".join(re.findall(r"^```\{public-names\} (.*)$", page, flags=re.M)).split()
    assert sorted(from_package.names_of(homes)) == sorted(HOME)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built in a process of its own, where a warning is an error."""
    pytest.importorskip("myst_nb", reason="needs the extra docs")
    built = tmp_path_factory.mktemp("site")
    flags = ["-c", "docs", "-b", "html", "-q", "--fail-on-warning", "--keep-going"]
    cache = ["-d", str(tmp_path_factory.mktemp("doctrees"))]
    ended = subprocess.run(
        [sys.executable, "-m", "sphinx", *flags, *cache, ".", str(built)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    return built


class _Found(HTMLParser):
    """Links and anchors of a page, and its pictures without words."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = {""}
        self.wordless = 0
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.links += [value for key in ("href", "src") if (value := given.get(key))]
        self.anchors |= {value for key in ("id", "name") if (value := given.get(key))}
        self.wordless += tag == "img" and not given.get("alt")


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_its_links_lead_somewhere(site: Path) -> None:
    pages = {path: _Found(path) for path in site.rglob("*.html")}
    assert site / "index.html" in pages
    lost = []
    for path, found in pages.items():
        assert found.wordless == 0, path
        for link in found.links:
            to = urlsplit(link)
            if to.scheme or to.netloc:
                assert to.scheme in ("http", "https"), link
                continue
            target = (path.parent / unquote(to.path)).resolve() if to.path else path
            known = pages[target].anchors if target in pages else {""}
            if not target.exists() or (to.fragment and unquote(to.fragment) not in known):
                lost.append(f"{path.relative_to(site)}: {link}")
    assert lost == []


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason=WITHOUT)
def test_no_page_asks_a_network_for_anything_or_is_wider_than_its_window(
    site: Path, tmp_path: Path
) -> None:
    browser = Browser(tmp_path)
    front = site / "index.html"  # goes on to the first page at once
    for path in sorted(set(site.rglob("*.html")) - {front}):
        for width in (1280, 400):
            browser.requests.clear()
            browser.open(path, width=width)
            asked = [url for url in browser.requests if not url.startswith(("file:", "about:"))]
            assert [url for url in asked if not url.startswith("data:")] == [], path
            assert browser.complaints == [], path
            assert browser.run("document.documentElement.scrollWidth - innerWidth") <= 0, path
    browser.close()


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason=WITHOUT)
@pytest.mark.skipif(SCRIPT is None, reason=WITHOUT_AXE)
def test_axe_finds_nothing_on_any_page(site: Path, tmp_path: Path) -> None:
    browser = Browser(tmp_path)
    for path in sorted(site.rglob("docs/*.html")) + sorted(site.rglob("notebooks/*.html")):
        browser.open(path)
        assert violations(browser) == [], path
    browser.close()
