"""Any name is drawn as it is written, and no picture fails or warns because of one."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text

from msmrta_opt import plots
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.plots import lettering
from msmrta_opt.plots.lettering import (
    BOX,
    HINTED,
    as_many_as_fit,
    fitted,
    name_ticks,
    shortened,
    told_apart,
    width_of,
)
from msmrta_opt.studies.analysis.profile import performance_profile
from msmrta_opt.studies.analysis.staging import Loss
from msmrta_opt.studies.analysis.staging_picture import staging_losses
from msmrta_opt.studies.analysis.tradeoff import tradeoff
from msmrta_opt.studies.analysis.tradeoff_pages import tradeoff_figure
from msmrta_opt.studies.solves import record_of_row

NAMES = {
    "two dollars": "Ba$$in",
    "mathematics": "kind $x^$",
    "broken mathematics": r"$\frac{$ and $\foo$",
    "escaped dollars": r"5\$ and 6\$",
    "carets and braces": "a^b_c {d} \\e",
    "percent, brackets, quotes": "100% [b] (c) <d> 'e' \"f\" #g &h ~i",
    "Greek and Cyrillic": "Ελλάδα, Москва",
    "Chinese": "救援任务",
    "Arabic and Hebrew": "بحث וחילוץ",
    "an emoji and a control character": "🚑 a\x07b\x00",
    "very long": "long " * 2000,
    "many lines": "a\nb",
}


@pytest.fixture(params=NAMES.values(), ids=NAMES.keys())
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def mission(name: str) -> Instance:
    document = {
        "name": name,
        "map": {"rows": ["....", ".@..", "...."]},
        "capabilities": [name],
        "service_time": {name: 2},
        "robots": [{"id": 0, "start": [0, 0], "speed": 1, "capabilities": [name]}],
        "victims": [
            {"id": 0, "cell": [0, 3], "requirements": [name]},
            {"id": 1, "cell": [2, 3], "requirements": [name]},
        ],
    }
    return Instance.from_document(document)


def texts_of(drawing: Figure | Axes, path: Path) -> list[Text]:
    """The texts of a picture, which is written without a word of warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plots.save_figure(drawing, path, dpi=40)
    figure = drawing.get_figure(root=True)
    assert figure is not None
    return [text for text in figure.findobj(Text) if isinstance(text, Text) and text.get_text()]


def assert_is_written(name: str, texts: list[Text]) -> None:
    """Each line of the name is on the picture, but for a long line's end and letters of no font."""
    for line in shortened(name).split("\n"):
        start = line.rstrip("…")[:40]
        said = [text.get_text() for text in texts]
        found = [text for text in said if matches(start, text.replace(r"\$", "$"))]
        assert found, said
        # An escaped dollar is drawn as a dollar; two others would enclose mathematics.
        assert all(text.count("$") == text.count(r"\$") for text in found)


def matches(name: str, text: str) -> bool:
    pattern = "".join(f"[{re.escape(letter)}{BOX}]" for letter in name)
    return re.search(pattern, text) is not None


def test_a_plan_is_drawn_with_any_names(name: str, tmp_path: Path) -> None:
    plan = make_plan(mission(name))
    assert_is_written(name, texts_of(plan.plot(), tmp_path / "plan.png"))
    with_others = [visit.model_copy(update={"stage": name}) for visit in plan.routes[0].visits]
    route = plan.routes[0].model_copy(update={"visits": tuple(with_others)})
    staged = plan.model_copy(update={"routes": (route,)})
    assert_is_written(name, texts_of(plots.plot_assignment(staged), tmp_path / "plan.svg"))


def test_a_map_is_drawn_with_any_name(name: str, tmp_path: Path) -> None:
    grid = GridMap(np.ones((3, 3), dtype=bool), name=name)
    assert_is_written(name, texts_of(plots.plot_map(grid), tmp_path / "map.pdf"))


def test_a_profile_is_drawn_with_any_names(name: str, tmp_path: Path) -> None:
    asked = {"instance": name, "stage": "cluster", "model": name, "status": "optimal"}
    rows = [
        record_of_row({**asked, "solver": solver, "total_seconds": seconds})
        for solver, seconds in ((name, 1.0), ("another", 2.0))
    ]
    assert_is_written(name, texts_of(performance_profile(rows), tmp_path / "profile.png"))


def test_losses_are_drawn_with_any_names(name: str, tmp_path: Path) -> None:
    drawing = staging_losses({name: [Loss(name, 12, 9, 9), Loss("b", 9, 8, 8)]}, "total_time")
    assert_is_written(name, texts_of(drawing, tmp_path / "losses.png"))


def test_a_tradeoff_is_drawn_with_any_name(name: str, tmp_path: Path) -> None:
    drawing = tradeoff_figure(tradeoff(mission(name), "psi"))
    assert_is_written(name, texts_of(drawing, tmp_path / "tradeoff.png"))


def test_axes_of_ones_own_keep_their_mathematics(tmp_path: Path) -> None:
    ax = Figure().subplots()
    ax.text(0, 0, r"$\psi$ and $5")
    grid = GridMap(np.ones((2, 2), dtype=bool), name="Ba$$in")
    plots.plot_map(grid, ax)
    assert ax.get_title() == r"Map Ba\$\$in"
    plots.plot_map(grid, ax)
    assert ax.get_title() == r"Map Ba\$\$in"
    ax.set_title(r"my own $\frac{1}{2}$")
    said = [text.get_text() for text in texts_of(ax, tmp_path / "map.png")]
    assert {r"$\psi$ and $5", r"my own $\frac{1}{2}$"} <= {*said}
    assert ax.title.get_parse_math()


@pytest.mark.parametrize("written", ["Ba$$in", "$x^$", r"5\$", r"\frac{$", "$", "a$b"])
def test_a_text_is_drawn_letter_by_letter(written: str) -> None:
    """As a text that is never taken for mathematics is: the same points of the same letters."""
    ax = plots.plot_map(GridMap(np.ones((2, 2), dtype=bool), name=written))
    ax.figure.canvas.draw()
    plain = ax.figure.text(0, 0, f"Map {written}", parse_math=False, fontsize=10)
    assert ax.title.get_window_extent().width == plain.get_window_extent().width


def test_what_no_font_has_is_a_box_and_the_rest_is_kept() -> None:
    ax = plots.plot_map(GridMap(np.ones((2, 2), dtype=bool), name="a\x07b\U0010fffd"))
    assert ax.get_title() == f"Map a{BOX}b{BOX}"


def test_a_font_that_has_a_letter_is_used_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two fonts, of which the second alone has the letter, as matplotlib comes with no such pair."""
    known = {"own": frozenset(map(ord, "ab")), "more": frozenset(map(ord, "bü"))}
    monkeypatch.setattr(lettering, "_letters", lambda file: known.get(file, frozenset()))
    monkeypatch.setattr(lettering, "_fonts", lambda: [("Own", "own"), ("More", "more")])
    monkeypatch.setattr(lettering, "findfont", lambda font: "own")
    assert lettering._fonts_for("abü", FontProperties()) == (["More"], "abü")
    assert lettering._fonts_for("abüé", FontProperties()) == (["More"], f"abü{BOX}")
    assert lettering._fonts_for("ab", FontProperties()) == ((), "ab")


def test_the_names_of_ticks_have_a_font_or_a_box_and_no_warning() -> None:
    """The first is in DejaVu Sans Mono, which comes with matplotlib, and not in DejaVu Sans."""
    figure = Figure()
    ax = figure.add_subplot()
    name_ticks(ax.yaxis, range(3), ["R\N{ARC}", "\N{CJK UNIFIED IDEOGRAPH-6551}", "a$b"])
    figure.canvas.draw()
    labels = ax.get_yticklabels()
    assert len(labels[0].get_fontfamily()) > 1
    assert labels[0].get_text() == "R\N{ARC}"
    assert labels[1].get_text() in (BOX, "\N{CJK UNIFIED IDEOGRAPH-6551}")
    assert labels[2].get_text() == r"a\$b"
    assert not any(
        family.startswith("Last") for label in labels for family in label.get_fontfamily()
    )


def test_names_that_differ_at_their_ends_stay_different_when_they_are_cut() -> None:
    common = "msmrta improve=5 b2_model=cluster_one_to_one"
    names = [f"{common} solver=HIGHS", f"{common} solver=SCIP", "greedy", f"{common} seed=1"]
    assert told_apart(names) == {
        names[0]: "msmrta imp…solver=HIGHS",
        names[1]: "msmrta imp…solver=SCIP",
        names[2]: "greedy",
        names[3]: "msmrta imp…seed=1",
    }
    alone = names[:1]
    assert told_apart(alone) == {alone[0]: "msmrta improve=5 b2_model=cluster_one_t…"}


@settings(max_examples=200, deadline=None)
@given(st.lists(st.text("ab", max_size=30).map(lambda x: "p" * 50 + x + x[::-1] * 3), max_size=12))
def test_cut_names_are_as_different_as_they_were_and_no_longer_than_said(names: list[str]) -> None:
    cut = told_apart(names)
    assert len(set(cut.values())) == len(set(names))
    assert all(len(said) <= 40 for said in cut.values())


def test_of_what_a_line_says_as_much_is_said_as_fits_whole() -> None:
    parts = ["makespan 590", "total time 1450", "mean completion 254.8"]
    room = HINTED * width_of("makespan 590 · total time 1450 time units", 9) + 1
    end = " time units"
    assert as_many_as_fit(parts, 9, 1000, end=end) == f"{' · '.join(parts)}{end}"
    assert as_many_as_fit(parts, 9, room, end=end) == f"{' · '.join(parts[:2])}{end}"
    assert as_many_as_fit(parts, 9, 40) == fitted(parts[0], 9, 40)
