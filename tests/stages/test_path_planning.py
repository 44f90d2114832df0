from __future__ import annotations

from itertools import pairwise

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.mission.errors import CheckError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Route, Visit
from msmrta_opt.stages.path_planning import path_planning
from msmrta_opt.stages.situation import Situation, Stop

# One corridor, so that each walk is the only shortest one; ids differ from positions.
A, B = 0, 1
INSTANCE = Instance(
    map=grid_from_rows(["........"]),
    capabilities=("A", "B"),
    service_time={"A": 2.0, "B": 3.0},
    robots=(
        Robot(id=8, start=(0, 0), speed=0.5, capabilities=("A", "B")),
        Robot(id=4, start=(0, 7), speed=2.0, capabilities=("B",)),
    ),
    victims=(
        Victim(id=30, cell=(0, 3), requirements=("A", "B"), service_time={"B": 7.0}),
        Victim(id=10, cell=(0, 1), requirements=("A",)),
        Victim(id=20, cell=(0, 3), requirements=("B",)),
    ),
)


def cells(*columns: int) -> tuple[Cell, ...]:
    return tuple((0, column) for column in columns)


def test_robots_without_stops_stay_at_their_starts() -> None:
    routes = path_planning(INSTANCE, [])
    assert routes == (Route(robot=8), Route(robot=4))
    assert [(route.cells, route.distance) for route in routes] == [([], 0), ([], 0)]


def test_a_robot_that_only_passes_cells_stays_too() -> None:
    assert path_planning(INSTANCE, [Stop(0, (0, 5), "B2")])[0] == Route(robot=8)


def test_stops_are_walked_to_in_order_and_times_add_up() -> None:
    stops = [Stop(0, (0, 3), "B2", 0, (A, B)), Stop(0, (0, 1), "B4", 1, (A,))]
    assert path_planning(INSTANCE, stops)[0].visits == (
        # 3 cells at 0.5, then A 2 and this victim's own B 7.
        Visit(
            victim=30,
            served=("A", "B"),
            stage="B2",
            cells=cells(0, 1, 2, 3),
            arrival=6,
            departure=15,
        ),
        # 2 cells back at 0.5, then A 2.
        Visit(victim=10, served=("A",), stage="B4", cells=cells(3, 2, 1), arrival=19, departure=21),
    )


def test_a_robot_passes_its_centre_on_the_way_to_its_next_victim() -> None:
    stops = [Stop(0, (0, 5), "B2"), Stop(0, (0, 3), "B2", 0, (A,))]
    (visit,) = path_planning(INSTANCE, stops)[0].visits
    assert visit.cells == cells(0, 1, 2, 3, 4, 5, 4, 3)
    assert (visit.arrival, visit.departure) == (7 / 0.5, 7 / 0.5 + 2)


def test_several_centres_in_a_row_are_all_passed() -> None:
    stops = [Stop(0, (0, 2), "B2"), Stop(0, (0, 0), "B2"), Stop(0, (0, 1), "B3", 1, (A,))]
    (visit,) = path_planning(INSTANCE, stops)[0].visits
    assert visit.cells == cells(0, 1, 2, 1, 0, 1)
    assert visit.stage == "B3"


def test_a_centre_after_the_last_victim_is_not_walked_to() -> None:
    stops = [Stop(0, (0, 1), "B2", 1, (A,)), Stop(0, (0, 5), "B2")]
    (visit,) = path_planning(INSTANCE, stops)[0].visits
    assert visit.cells == cells(0, 1)


def test_a_robot_that_is_there_already_does_not_move() -> None:
    stops = [Stop(0, (0, 3), "B2", 0, (A,)), Stop(0, (0, 3), "B3", 2, (B,))]
    first, second = path_planning(INSTANCE, stops)[0].visits
    assert second.cells == cells(3)
    assert (second.arrival, second.departure) == (first.departure, first.departure + 3)


def test_robots_keep_to_their_own_stops_and_speeds() -> None:
    stops = [Stop(1, (0, 3), "B2", 2, (B,)), Stop(0, (0, 1), "B2", 1, (A,))]
    first, second = path_planning(INSTANCE, stops)
    assert [visit.victim for visit in first.visits] == [10]
    assert (second.robot, second.visits[0].cells) == (4, cells(7, 6, 5, 4, 3))
    assert (second.visits[0].arrival, second.visits[0].departure) == (4 / 2, 4 / 2 + 3)


def test_walks_go_around_walls() -> None:
    instance = INSTANCE.replace(
        map=grid_from_rows(["...@....", "@.....@@"]),
        victims=(Victim(id=30, cell=(0, 4), requirements=("A",)),),
    )
    (visit,) = path_planning(instance, [Stop(0, (0, 4), "B2", 0, (A,))])[0].visits
    # 4 columns, one row down and one up.
    assert len(visit.cells) - 1 == 6
    assert (0, 3) not in visit.cells
    assert visit.arrival == 6 / 0.5


def test_a_stop_that_no_walk_leads_to_is_an_error() -> None:
    instance = INSTANCE.replace(
        map=grid_from_rows(["..@....."]),
        victims=(Victim(id=30, cell=(0, 4), requirements=("A",)),),
    )
    with pytest.raises(CheckError, match=r"robot .*: no walk leads from \(0, 0\) to \(0, 4\)"):
        path_planning(instance, [Stop(0, (0, 4), "B2", 0, (A,))])


@given(
    rows=st.lists(st.text("..@", min_size=6, max_size=6), min_size=2, max_size=6).filter(
        lambda rows: "." in "".join(rows)
    ),
    seed=st.integers(0, 9999),
    choices=st.lists(st.tuples(st.integers(0, 5), st.booleans()), max_size=6),
)
def test_every_leg_is_legal_and_a_shortest_walk_through_its_stops(
    rows: list[str], seed: int, choices: list[tuple[int, bool]]
) -> None:
    instance = generate_mission(grid_from_rows(rows), 1, 6, seed=seed, solvable=False)
    reach = Situation.of(instance).reach[0]
    stops = [
        Stop(0, instance.cells[v], "B2", v if served else None) for v, served in choices if reach[v]
    ]
    route = path_planning(instance, stops)[0]
    graph = instance.map.graph

    legs, here, moves = [], instance.starts[0], 0
    for stop in stops:
        moves += nx.shortest_path_length(graph, here, stop.cell)
        here = stop.cell
        if stop.victim is not None:
            legs.append((here, moves))
            moves = 0
    assert [(visit.cells[-1], len(visit.cells) - 1) for visit in route.visits] == legs
    walked = route.cells
    assert walked[:1] == ([instance.starts[0]] if legs else [])
    assert all(graph.has_edge(a, b) for a, b in pairwise(walked))
