"""Workload bars: as long as service and travel of the plan worked out by hand."""

from __future__ import annotations

from support.legible import illegible

from msmrta_opt.mission.plan import Plan
from msmrta_opt.plots import plot_workload


def test_bars_are_service_and_travel_of_each_robot(plan: Plan) -> None:
    ax = plot_workload(plan)
    bars = [(bar.get_x(), bar.get_width()) for bar in ax.patches]
    # Robot 7 serves 6 and 2 and walks 2 and 4 cells at speed 1; robot 3 serves 1, walks 3 at 0.5.
    assert bars == [(0, 8), (0, 1), (8, 6), (1, 6)]
    assert [text.get_text() for text in ax.get_yticklabels()] == ["R7", "R3"]
    # 14 and 7 time units: a mean of 10.5.
    assert ax.get_title() == "Workload: the busiest robot 14, 1.33 times the mean"


def test_robots_that_stay_and_missions_without_visits_are_drawn(plan: Plan) -> None:
    idle = tuple(route.model_copy(update={"visits": ()}) for route in plan.routes)
    fields = {name: getattr(plan, name) for name in Plan.model_fields}
    ax = plot_workload(Plan.model_validate({**fields, "routes": idle}))
    assert ax.get_title() == "Workload: nobody is busy"


def test_everything_written_can_be_read(plan: Plan) -> None:
    figure = plot_workload(plan).figure
    figure.savefig("/dev/null", format="png")
    assert illegible(figure) == []
