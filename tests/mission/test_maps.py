from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.grid import DistanceTable
from msmrta_opt.mission.maps import Query, grid_from_rows, read_map, read_scenario, write_map

DATA = Path(__file__).parents[1] / "data"

row_lists = st.integers(1, 6).flatmap(
    lambda width: st.lists(st.text(".@", min_size=width, max_size=width), min_size=1, max_size=6)
)


def test_each_map_character_is_free_or_blocked() -> None:
    grid = grid_from_rows([".GS", "@OT", "W.W"])
    assert grid.free.tolist() == [[True] * 3, [False] * 3, [False, True, False]]
    assert grid.rows == ("...", "@@@", "@.@")


@given(rows=row_lists)
def test_rows_give_back_the_map(rows: list[str]) -> None:
    assert grid_from_rows(rows).rows == tuple(rows)


@given(rows=row_lists)
def test_a_written_map_reads_back_the_same(
    rows: list[str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("maps") / "ground.map"
    write_map(grid_from_rows(rows), path)
    assert read_map(path) == grid_from_rows(rows)


def test_a_map_file_has_the_published_header(tmp_path: Path) -> None:
    write_map(grid_from_rows(["..@", "..."]), tmp_path / "ground.map")
    written = (tmp_path / "ground.map").read_text(encoding="utf-8")
    assert written == "type octile\nheight 2\nwidth 3\nmap\n..@\n...\n"


def test_a_map_is_called_as_its_file_and_knows_where_it_lies() -> None:
    grid = read_map(DATA / "corner.map")
    assert grid.name == "corner"
    assert grid.source == DATA / "corner.map"
    assert grid.rows == (".....", ".....", ".@...", ".....")


@pytest.mark.parametrize(
    "text",
    [
        "type octile\r\nheight 2\r\nwidth 3\r\nmap\r\n..@\r\n...\r\n",
        "type octile\nheight 2\nwidth 3\nmap\n..@\n...",
        "type octile\nheight 2\nwidth 3\nmap\n..@\n...\n\n\n",
        "height 2\nwidth 3\ntype octile\n\nmap\n..@\n...\n",
        "height  2 \nwidth\t3\nmap\n..@\n...\n",
        "type octile\ndraft\nmade by hand\nheight 2\nwidth 3\nmap\n..@\n...\n",
        "type octile\nheight 2\nwidth 3\nmap \n..@\n...\n",
        "type octile\nheight 2\nwidth 3\nMAP\n..@\n...\n",
        "TYPE OCTILE\nHEIGHT 2\nWidth 3\nMAP\n..@\n...\n",
        "type octile\nheight 2\nwidth 3\nmap\n..@ \n...\t\n \n",
        "\ufefftype octile\rheight 2\rwidth 3\rmap\r..@\r...\r",
    ],
    ids=[
        "windows",
        "no last line end",
        "empty lines after",
        "other header order",
        "spacing",
        "remarks",
        "blank behind map",
        "MAP",
        "upper case",
        "blanks behind rows",
        "byte order mark and old line ends",
    ],
)
def test_variants_of_the_format_are_read(tmp_path: Path, text: str) -> None:
    path = tmp_path / "ground.map"
    path.write_bytes(text.encode())
    assert read_map(path) == grid_from_rows(["..@", "..."])


@pytest.mark.parametrize("name", ["map0", "map1", "map2", "map3"])
def test_the_papers_maps_are_20_by_20(instances_dir: Path, name: str) -> None:
    path = instances_dir / "maps" / f"{name}.map"
    grid = read_map(path)
    drawn = path.read_text(encoding="utf-8").split("map\n", 1)[1]
    assert grid.shape == (20, 20)
    assert grid.free.sum() == drawn.count(".")


def test_map_0_is_free_of_walls_and_map_2_is_not(instances_dir: Path) -> None:
    assert read_map(instances_dir / "maps" / "map0.map").free.all()
    assert not read_map(instances_dir / "maps" / "map2.map").free.all()


@pytest.mark.parametrize("rows", [[], [""], ["", ""]])
def test_a_map_without_cells_is_refused(rows: list[str]) -> None:
    with pytest.raises(InputError, match=r"^rows: the map is empty; give at least one row"):
        grid_from_rows(rows)


def test_the_first_wrong_row_and_character_are_named() -> None:
    with pytest.raises(InputError, match=r"^rows\[1\]: 0 cells where row 0 has 2"):
        grid_from_rows(["..", "", "x"])
    with pytest.raises(InputError, match=r"^rows\[1\]\[0\]: unknown map character 'x'"):
        grid_from_rows(["..", "x.", "y."])


def test_a_map_whose_folder_does_not_exist_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ground\.map: cannot be written"):
        write_map(grid_from_rows(["."]), tmp_path / "nowhere" / "ground.map")


@pytest.mark.parametrize(
    ("text", "field", "problem"),
    [
        ("height 1\nwidth 1\nmaps\n.\n", "header", "no line 'map' before the grid"),
        ("height 1\nwidth 1\nmap .\n", "header", "no line 'map' before the grid"),
        ("P1\n1 1\n0\n", "header", "no line 'map' before the grid; give a MovingAI map"),
        ("", "header", "no line 'map' before the grid"),
        ("heigth 1\nwidth 1\nmap\n.\n", "height", "is missing; give it above the line 'map'"),
        ("height 1\nmap\n.\nwidth 1\n", "width", "is missing"),
        ("height one\nwidth 1\nmap\n.\n", "line 1", "'height one'; give height and a whole"),
        ("height 1\nwidth\nmap\n.\n", "line 2", "'width'; give width and a whole number"),
        ("height -1\nwidth 1\nmap\n.\n", "line 1", "give height and a whole number"),
        ("height 1 1\nwidth 1\nmap\n.\n", "line 1", "give height and a whole number"),
        ("height ١\nwidth 1\nmap\n.\n", "line 1", "give height and a whole number"),
        ("height " + "1" * 5000 + "\nwidth 1\nmap\n.\n", "line 1", "give height and a whole"),
        ("height 1\nheight 2\nwidth 1\nmap\n.\n", "line 2", "a second height; give one"),
        ("height 1\nwidth 1\nmap\n.\n.\n", "line 1", "height 1, where the grid below has 2"),
        ("height 2\nwidth 1\nmap\n\n.\n", "rows[0]", "0 cells, where the header's width is 1"),
        ("height 1\nwidth 2\nmap\n .\n", "rows[0][0]", "unknown map character ' '"),
        ("height 1\nwidth 1\nmap\n\x0c.\n", "rows[0][0]", "unknown map character '\\x0c'"),
    ],
)
def test_a_wrong_line_is_named_as_it_stands_there(
    text: str, field: str, problem: str, tmp_path: Path
) -> None:
    path = tmp_path / "ground.map"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_map(path)
    assert str(caught.value).isprintable()
    assert (caught.value.file, caught.value.field) == (str(path), field)
    assert problem in caught.value.problem


# Scenarios


def test_a_scenario_gives_row_then_column() -> None:
    root_8 = 2.82842712
    assert read_scenario(DATA / "corner.scen") == [
        Query((0, 2), (2, 4), root_8),
        Query((3, 0), (0, 0), 3.0),
        Query((2, 0), (2, 2), 4.0),
        Query((3, 4), (3, 4), 0.0),
    ]


def test_a_scenarios_walks_are_no_shorter_than_with_diagonal_moves() -> None:
    distance = DistanceTable(read_map(DATA / "corner.map"))
    queries = read_scenario(DATA / "corner.scen")
    # By hand: two diagonal moves become four; the others need none.
    assert [distance(query.start, query.goal) for query in queries] == [4, 3, 4, 0]
    for query in queries:
        assert query.octile_length <= distance(query.start, query.goal)


def test_a_scenario_may_have_spaces_for_tabs_and_empty_lines(tmp_path: Path) -> None:
    path = tmp_path / "queries.scen"
    path.write_text("version 1.0\n\n0 corner.map 5 4 0 3 0 0 3\n\n", encoding="utf-8")
    assert read_scenario(path) == [Query((3, 0), (0, 0), 3.0)]


def test_a_row_that_is_shorter_than_the_header_says_is_the_one_at_fault(tmp_path: Path) -> None:
    path = tmp_path / "short.map"
    path.write_text("type octile\nheight 3\nwidth 4\nmap\n...\n....\n....\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_map(path)
    assert (
        str(refused.value)
        == f"{path}: rows[0]: 3 cells, where the header's width is 4; correct either"
    )


def test_nothing_of_a_file_that_is_no_map_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("what nobody else is to read\nheight\n")
    with pytest.raises(InputError) as caught:
        read_map(path)
    assert "nobody" not in str(caught.value)
