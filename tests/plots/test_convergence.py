"""The picture of convergence: its steps are those of the searches, and it can be read."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.lines import Line2D
from support.legible import illegible

from msmrta_opt import plots
from msmrta_opt.mission.convergence import Convergence, SearchRecord, SearchStep
from msmrta_opt.mission.plan import Plan


def record(*steps: tuple[float, float, float | None]) -> SearchRecord:
    return SearchRecord(
        objective="makespan",
        unit="time units",
        steps=tuple(
            SearchStep(seconds=t, incumbent=worth, bound=bound, event="root LP")
            for t, worth, bound in steps
        ),
    )


RECORDS = {
    "short": record((0.5, 100, None), (1, 90, 60), (2, 90, 90)),
    "long " * 20: record((0.25, 120, 50), (4, 100, 80)),
}


@pytest.fixture
def searches(plan: Plan) -> Convergence:
    return Convergence(
        {name: plan.model_copy(update={"search": one}) for name, one in RECORDS.items()}
    )


def points(line: Line2D) -> list[tuple[Any, Any]]:
    x, y = line.get_data()
    return [(a, None if np.isnan(b) else b) for a, b in zip(x, y, strict=True)]


def test_incumbents_and_bounds_are_drawn_as_they_were(searches: Convergence) -> None:
    lines = [line for line in searches.plot().lines if line.get_drawstyle() == "steps-post"]
    drawn = [points(line) for line in lines]
    short, long = (one.steps for one in RECORDS.values())
    assert drawn == [
        [(s.seconds, s.incumbent) for s in short],
        [(s.seconds, s.bound) for s in short],
        [(s.seconds, s.incumbent) for s in long],
        [(s.seconds, s.bound) for s in long],
    ]


def test_the_legend_says_what_each_search_ended_with(searches: Convergence) -> None:
    legend = plots.plot_convergence(searches).get_legend()
    assert legend is not None
    said = [text.get_text() for text in legend.get_texts()]
    assert said[0] == "short: 90, optimal after 2 s"
    assert said[1].endswith("…: 100, gap 20.00% after 4 s")  # (100 − 80) / 100


def test_everything_written_can_be_read(searches: Convergence) -> None:
    figure = searches.plot().figure
    figure.savefig("/dev/null", format="png")
    assert illegible(figure) == []
