"""Missions for tests of stages: by hand, and drawn."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import strategies as st

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows


def mission(
    rows: Sequence[str],
    robots: Sequence[tuple[Cell, str]],
    victims: Sequence[tuple[Cell, str]],
    clusters: Sequence[int] | None = None,
) -> Instance:
    """Robots and victims by cell and kinds, a letter each."""
    return Instance(
        map=grid_from_rows(rows),
        capabilities=("A", "B", "C"),
        service_time={"A": 2.0, "B": 3.0, "C": 5.0},
        robots=tuple(
            Robot(id=i, start=cell, speed=1.0, capabilities=tuple(has))
            for i, (cell, has) in enumerate(robots)
        ),
        victims=tuple(
            Victim(id=i, cell=cell, requirements=tuple(needs))
            for i, (cell, needs) in enumerate(victims)
        ),
        clusters=None if clusters is None else tuple(clusters),
    )


@st.composite
def small_missions(draw: st.DrawFn) -> Instance:
    """Up to 4 robots and 7 victims on maps with walls."""
    n_columns = draw(st.integers(2, 6))
    row = st.text("..@", min_size=n_columns, max_size=n_columns)
    rows = st.lists(row, min_size=1, max_size=5).filter(lambda rows: "." in "".join(rows))
    return generate_mission(
        grid_from_rows(draw(rows)),
        draw(st.integers(1, 4)),
        draw(st.integers(1, 7)),
        seed=draw(st.integers(0, 999)),
        per_robot=(0, 3),
        per_victim=(0, 4),
        solvable=False,
    )
