"""Pictures of programs: entries, classes, values, choices and duals are those of the program."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Rectangle
from support.legible import illegible

import msmrta_opt as mo
from msmrta_opt.cli import run
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.optimise.program import Block, Program
from msmrta_opt.plots.style import PALETTE
from msmrta_opt.studies.analysis.matrix_picture import plot_matrix
from msmrta_opt.studies.analysis.solution_picture import plot_solution

DATA = mo.stage_data(mo.example("two_rooms"), "cluster")
CLUSTERS = "cluster_one_to_one"


def program(name: str, stage: str = "cluster") -> Program:
    found: Program = mo.program(name, mo.stage_data(mo.example("two_rooms"), stage))
    return found


def drawn(ax: Axes) -> np.ndarray:
    return np.asarray(ax.images[0].get_array())[..., :3]


def test_every_entry_is_drawn_in_the_colour_of_its_rows_kind() -> None:
    given = mo.program(CLUSTERS, mo.stage_data(mo.example("paper"), "cluster"))
    image, matrix = drawn(plot_matrix(given)), given.matrix.toarray()
    assert image.shape[:2] == matrix.shape
    white = (image == 1).all(axis=2)
    assert np.array_equal(~white, matrix != 0)
    # Rows of robots share no column with each other, nor do those of clusters; one row has all.
    found: dict[str, set[tuple[float, ...]]] = {}
    for r in range(given.n_rows):
        own = {tuple(colour) for colour in image[r][matrix[r] != 0].tolist()}
        found.setdefault(given.row_name(r).split()[0], set()).update(own)
    assert {len(colours) for colours in found.values()} == {1}
    robots, clusters = found["robot"], found["cluster"]
    assert robots | clusters == {to_rgb(PALETTE[0]), to_rgb(PALETTE[1])}
    assert found["as"] == {to_rgb(PALETTE[3])}


def test_rows_and_columns_have_their_names_and_the_title_the_proof() -> None:
    given = program(CLUSTERS)
    ax = plot_matrix(given)
    assert [x.get_text() for x in ax.get_yticklabels()] == [
        given.row_name(i) for i in range(given.n_rows)
    ]
    assert [x.get_text() for x in ax.get_xticklabels()] == [
        given.column_name(i) for i in range(given.n_columns)
    ]
    assert "totally unimodular" in ax.get_title()


def test_without_a_structure_entries_are_told_apart_by_their_signs() -> None:
    given = program("victim_balanced", "victim")
    ax = plot_matrix(given)
    assert ax.get_title().endswith("no structure recognised")
    entries = given.matrix.tocoo()
    for r, c, a in zip(entries.row, entries.col, entries.data, strict=True):
        kind = {1.0: 0, -1.0: 1}.get(float(a), 6)
        assert tuple(drawn(ax)[r, c].tolist()) == to_rgb(PALETTE[kind])


def test_values_choices_and_duals_are_those_of_the_program() -> None:
    given, solution = program(CLUSTERS), mo.solve(CLUSTERS, DATA)
    ax = plot_solution(given, solution)
    cost = {}
    for j in range(given.n_columns):
        cost[given.columns[0].index(j)] = given.cost[j]
    rows = [x.get_text() for x in ax.get_yticklabels()]
    columns = [x.get_text() for x in ax.get_xticklabels()]
    for text in ax.texts:
        column, row = (round(x) for x in text.get_position())
        assert text.get_text() == f"{cost[int(rows[row]), int(columns[column])]:.4g}"
    outlined = {
        (round(p.get_y() + 0.46), round(p.get_x() + 0.46))
        for p in ax.patches
        if isinstance(p, Rectangle)
    }
    assert outlined == {tuple(at) for at in np.argwhere(solution.values["x"] > 0.5).tolist()}
    # Strong duality, read from the picture: its margins sum to the objective, but for the cardinality.
    side = [float(x.get_text()) for far in ax.child_axes for x in far.get_xticklabels()]
    side += [float(x.get_text()) for far in ax.child_axes for x in far.get_yticklabels()]
    rest = sum(
        float(dual) * given.row_upper[block.start]
        for block in given.rows
        for dual in [np.asarray(solution.duals[block.name]).sum()]
        if block.size == 1
    )
    assert sum(side) + rest == pytest.approx(solution.objective, abs=1e-3)


def test_an_objective_of_another_variable_is_told_by_what_it_is_made_of() -> None:
    data = mo.stage_data(mo.example("two_rooms"), "victim")
    given, solution = program("victim_balanced", "victim"), mo.solve("victim_balanced", data)
    ax = plot_solution(given, solution)
    said = [text.get_text() for text in ax.texts if text.get_text() != "×"]
    assert any(float(text) for text in said)
    legend = ax.get_legend()
    assert legend is not None
    assert any("maximum load" in text.get_text() for text in legend.get_texts())


def test_what_is_no_assignment_is_refused() -> None:
    data = mo.stage_data(mo.example("corridor"), "clustering")
    given = mo.program("clustering_pmedian", data)
    block = next(item for item in given.columns)
    alone = [item for item in given.columns if len(item.shape) != 2]
    assert block is not None
    empty = Program(
        given.sense, given.cost, given.offset, given.matrix, given.row_lower, given.row_upper,
        given.lower, given.upper, given.integer, tuple(alone), given.rows,
    )  # fmt: skip
    with pytest.raises(InputError, match="there is no 0-1 variable over two axes"):
        plot_solution(empty, mo.solve("clustering_pmedian", data))


def many() -> mo.Instance:
    return generate_mission(mo.example("paper").map, 45, 60, seed=1)


def long_ids() -> mo.Instance:
    document = mo.example("paper").model_dump(mode="json")
    for robot in document["robots"]:
        robot["id"] += 123_456_789
    return mo.Instance.from_document(document)


@pytest.mark.parametrize("mission", [long_ids, many])
def test_everything_written_can_be_read(mission: Callable[[], mo.Instance]) -> None:
    data = mo.stage_data(mission(), "cluster")
    given, solution = mo.program(CLUSTERS, data), mo.solve(CLUSTERS, data)
    for figure in (plot_matrix(given).figure, plot_solution(given, solution).figure):
        figure.savefig("/dev/null", format="png")
        assert illegible(figure) == []


def test_a_matrix_without_an_instance_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "m.png"
    assert run(["show", CLUSTERS, "--matrix", str(file)]) == 2
    assert capsys.readouterr().err == "error: --matrix: is of an instance; give one\n"
    assert not file.exists()


def test_a_label_in_a_legend_says_for_whom_it_stands() -> None:
    block = Block(
        "kind {k} at victim {v} has what holder {h} leaves", 0, (1, 1, 1), ("k", "v", "h"),
        ("kind", "victim", "holder"),
    )  # fmt: skip
    assert block.words == "each kind at each victim has what each holder leaves"
    model, stage = "victim_covering", "victim"
    data = mo.stage_data(mo.example("paper"), stage)
    legend = plot_solution(mo.program(model, data), mo.solve(model, data)).get_legend()
    assert legend is not None
    said = [text.get_text() for text in legend.get_texts()]
    assert any("each victim" in text for text in said)
    assert not any("{" in text for text in said)
