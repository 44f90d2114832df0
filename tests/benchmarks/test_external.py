"""The script that solves published instances again, on small files whose values a person can find.

In ``tests/data/external``: assignment costs 4 1 3 / 2 0 5 / 3 2 2, at least 1 + 2 + 2 = 5. Two agents
with room for two items and one, costs 1 2 3 / 3 1 2: least 1 + 2 + 2 or 1 + 1 + 3, most 2 + 3 + 3. A
path 1–2–3–4 of lengths 2, 4 and 1, where 2 overwrites a first 9: two medians leave 2 + 1. A map with
a way of 6 around a wall, and one of 2. Programs: twice 2 x ≥ 4 costs 4; x + y ≥ 2 and ≤ 1; min −x.
Victims at −1 and 4 of a line, reached from 0 at 1 and 6. A triangle of sides 2, 3 and 4, from where
the first two meet: two tours, there and back, of 4 and 6; one of 9.
"""

from __future__ import annotations

import importlib
import json
import shutil
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.solution import Solution, Status
from msmrta_opt.optimise.solvers import Options

ROOT = Path(__file__).parents[2]
SMALL = ROOT / "tests" / "data" / "external"


@pytest.fixture(scope="module")
def external() -> ModuleType:
    """The script as a module."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        return importlib.import_module("external")
    finally:
        sys.path.pop(0)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the small files, to be changed."""
    return Path(shutil.copytree(SMALL, tmp_path / "external"))


def expect(folder: Path, group: str, values: object) -> None:
    """Let `folder` hold one group alone, with these values."""
    (folder / "expected.json").write_text(json.dumps({group: values}), encoding="utf-8")


def test_all_values_of_the_small_files_are_found(
    external: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    assert external.main([str(SMALL)]) == 0
    # Assignment by two models, two senses, p-median, 2 × 2 walks, three programs read and solved,
    # latency, and longest tour.
    assert "17 of 17 agree, 0 skipped." in capsys.readouterr().out


def test_each_solver_named_solves_each_program_and_the_rest_is_done_once(
    external: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    assert external.main([str(SMALL), "--solver", "highs", "--solver", "auto"]) == 0
    # Eight of the seventeen need a solver.
    assert "25 of 25 agree, 0 skipped." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("group", "values"),
    [
        ("assign", {"values": {"three": 6}}),
        ("gap", {"values": {"pairs": {"min": 5, "max": 9}}}),
        ("pmed", {"values": {"path": {"optimum": 5}}}),
        (
            "movingai",
            {
                "bend / bend.scen, first 3 rows": {
                    "sum_of_4connected_shortest_paths": 8,
                    "max": 6,
                }
            },
        ),
        ("trp_latency", {"line": 8}),
        ("mtsp_minmax", {"values": [{"instance": "triangle.tsp", "m": 1, "minmax": 6}]}),
        (
            "mps",
            {
                "crossed": {
                    "rows": 2,
                    "cols": 2,
                    "integers": 0,
                    "highspy_status": "Unbounded",
                    "highspy_value": None,
                }
            },
        ),
    ],
)
def test_a_wrong_value_is_seen_and_fails(
    group: str,
    values: object,
    external: ModuleType,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    expect(folder, group, values)
    assert external.main([str(folder)]) == 1
    assert "DISAGREES" in capsys.readouterr().out


@pytest.mark.parametrize("status", ["feasible", "no_solution"])
def test_what_time_did_not_suffice_to_prove_does_not_agree(
    status: Status, external: ModuleType
) -> None:
    stopped = Solution("", status, "min", objective=5.0, bound=4.0, check="passed")
    case = external.Case("pairs", "model", 5.0, lambda *_: external.said(stopped))
    assert external.outcome(case, "auto", Options()).verdict == "stopped"


def test_a_solver_that_can_solve_nothing_is_named_and_fails(
    external: ModuleType, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # A generalised assignment is no linear one.
    expect(folder, "gap", {"values": {"pairs": {"min": 5, "max": 8}}})
    assert external.main([str(folder), "--solver", "lsa"]) == 1
    out = capsys.readouterr().out
    assert "0 of 2 agree, 2 skipped." in out
    assert "lsa could solve nothing here." in out


def test_the_last_of_several_costs_of_an_edge_counts(external: ModuleType) -> None:
    distances, p = external.read_p_median(SMALL / "pmed" / "path.txt")
    assert p == 2
    assert distances.tolist() == [[0, 2, 6, 7], [2, 0, 4, 5], [6, 4, 0, 1], [7, 5, 1, 0]]


def test_an_edge_may_cost_nothing_and_nodes_may_be_apart(
    external: ModuleType, tmp_path: Path
) -> None:
    path = tmp_path / "graph.txt"
    path.write_text("4 2 1\n1 2 0\n2 3 5\n", encoding="utf-8")
    distances, _ = external.read_p_median(path)
    inf = np.inf
    assert distances.tolist() == [[0, 0, 5, inf], [0, 0, 5, inf], [5, 5, 0, inf], [inf] * 3 + [0]]


def test_numbers_may_be_broken_over_lines_anywhere(external: ModuleType) -> None:
    costs = external.read_assignment(SMALL / "assign" / "three.txt")
    assert costs.tolist() == [[4, 1, 3], [2, 0, 5], [3, 2, 2]]


def test_costs_weights_and_capacities_are_told_apart(external: ModuleType) -> None:
    costs, weights, capacities = external.read_generalised(SMALL / "gap" / "pairs")
    assert costs.tolist() == [[1, 2, 3], [3, 1, 2]]
    assert weights.tolist() == [[2, 2, 2], [2, 2, 2]]
    assert capacities.tolist() == [4, 2]


@pytest.mark.parametrize(
    ("reader", "text", "said"),
    [
        ("read_assignment", "2\n1 2 3\n", "3 numbers after the sizes, which ask for 4"),
        ("read_assignment", "", "0 numbers; 1 sizes come first"),
        ("read_assignment", "1\nnone\n", "give numbers alone"),
        ("read_generalised", "1 1\n5\n5\n", "2 numbers after the sizes, which ask for 3"),
        ("read_p_median", "2 1 1\n1 3 4\n", "an edge from 1 to 3; nodes are 1 to 2"),
    ],
)
def test_a_broken_file_is_named_with_what_is_wrong(
    reader: str, text: str, said: str, external: ModuleType, tmp_path: Path
) -> None:
    path = tmp_path / "broken.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=said) as caught:
        getattr(external, reader)(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("group", "values", "said"),
    [
        ("assign", {"values": {"absent": 5}}, "absent.txt: no such file"),
        ("movingai", {"bend": {}}, "MAP / FILE.scen, first N rows"),
        (
            "chess",
            {},
            "none of assign, gap, pmed, movingai, mps, trp_latency, mtsp_minmax is in it",
        ),
    ],
)
def test_a_folder_that_does_not_hold_what_it_lists_is_refused(
    group: str,
    values: object,
    said: str,
    external: ModuleType,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    expect(folder, group, values)
    assert external.main([str(folder)]) == 2
    assert said in capsys.readouterr().err


def test_an_unknown_solver_is_refused_before_anything_is_solved(
    external: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    assert external.main([str(SMALL), "--solver", "oracle"]) == 2
    assert "no solver 'oracle'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "distances"),
    [
        (
            "DIMENSION: 3\nEDGE_WEIGHT_FORMAT: UPPER_ROW\nEDGE_WEIGHT_SECTION\n1 2\n3\nEOF\n",
            [[0, 1, 2], [1, 0, 3], [2, 3, 0]],
        ),
        (
            "DIMENSION: 2\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n0 5\n6 0\nEOF\n",
            [[0, 5], [6, 0]],
        ),
        (
            # The depot is node 2, and 2.5 is rounded to 2.
            "EDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 3 4\n3 3 6.5\n"
            "DEPOT_SECTION\n 2\n -1\nEOF\n",
            [[0, 5, 2], [5, 0, 7], [2, 7, 0]],
        ),
        (
            # The depot is the mean of both points.
            "EDGE_WEIGHT_TYPE: GEO\nNODE_COORD_SECTION\n   1  -3.00 0\n   2  3.00 8\nEOF\n",
            [[0, 5, 5], [5, 0, 10], [5, 10, 0]],
        ),
    ],
)
def test_tours_are_read_as_matrices_and_as_points(
    external: ModuleType, tmp_path: Path, text: str, distances: list[list[float]]
) -> None:
    path = tmp_path / "tour.tsp"
    path.write_text(text, encoding="utf-8")
    assert external.read_tsplib(path).tolist() == distances
