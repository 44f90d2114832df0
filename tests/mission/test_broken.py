"""Each broken file of `tests/broken` is refused in one line that says what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map, read_scenario

BROKEN = Path(__file__).parents[1] / "broken"

READERS: dict[str, Callable[[Path], object]] = {
    ".json": Instance.read,
    ".map": read_map,
    ".scen": read_scenario,
}

TABLE: dict[str, tuple[str, str, str]] = {
    # file: (field, offending value, what would be right)
    # Files as such
    "broken_json.json": ("", "line 7 column 41", "Expecting ','"),
    "empty_file.json": ("", "broken JSON", "line 1"),
    "not_utf8.json": ("", "invalid", "UTF-8 text file"),
    "folder.json": ("", "a folder", "give a regular file"),
    # Types
    "list_for_instance.json": ("", '[{"id": 0}]', "give an object"),
    "list_for_object.json": ("service_time", "[2, 3]", "give an object"),
    "text_for_list.json": ("robots[1].capabilities", "'DebrisRemover'", "give a list"),
    "text_for_number.json": ("robots[1].speed", "'fast'", "give a finite number"),
    "number_in_quotes.json": ("robots[1].speed", "'0.5'", "give a finite number"),
    "number_for_text.json": ("robots[0].capabilities[0]", "7", "give a text"),
    "fraction_for_whole_number.json": ("victims[1].id", "1.5", "give a whole number"),
    "null_speed.json": ("robots[1].speed", "null", "give a finite number"),
    "cell_of_one_number.json": ("victims[1].cell", "[1]", "[row, col]"),
    "cell_of_three_numbers.json": ("victims[1].cell", "[1, 2, 0]", "[row, col]"),
    # Ranges
    "zero_speed.json": ("robots[1].speed", "0;", "above 0"),
    "negative_speed.json": ("robots[1].speed", "-0.5", "above 0"),
    "nan_speed.json": ("robots[1].speed", "NaN", "give a finite number"),
    "infinite_speed.json": ("robots[1].speed", "Infinity", "give a finite number"),
    "speed_beyond_all.json": ("robots[1].speed", "1e+31", "give 1e+30 or less"),
    "speed_of_nothing.json": ("robots[1].speed", "1e-31", "give 1e-30 or more"),
    "id_beyond_64_bits.json": ("robots[0].id", "9223372036854775808", "a number below 9.22337e+18"),
    "negative_id.json": ("robots[0].id", "-3", "0 or more"),
    "negative_cell.json": ("victims[1].cell[1]", "-1", "0 or more"),
    "negative_cluster_label.json": ("clusters[1]", "-1", "0 or more"),
    "negative_depth.json": ("scouts[0].visual_field_depth", "-1", "0 or more"),
    "negative_priority.json": ("victims[1].priority", "-2", "0 or more"),
    "infinite_service_time.json": (
        "service_time.DebrisRemover",
        "Infinity",
        "give a finite number",
    ),
    "negative_service_time.json": ("service_time.DebrisRemover", "-3", "0 or more"),
    # Fields and names
    "wrong_format.json": ("format", "msmrta-instance/9", "give 'msmrta-instance/1'"),
    "missing_field.json": ("robots[1].speed", "missing", "give it"),
    "key_given_twice.json": ("robots[1].speed", "given twice", "give it once"),
    "unknown_field.json": ("victims[0].colour", "'red'", "correct its name or remove it"),
    "unknown_capability.json": (
        "robots[1].capabilities",
        "'Crane'",
        "FirstAids, DebrisRemover",
    ),
    "unknown_requirement.json": (
        "victims[1].requirements",
        "'Crane'",
        "FirstAids, DebrisRemover",
    ),
    "unknown_service_time.json": ("service_time.Crane", "'Crane'", "FirstAids, DebrisRemover"),
    "override_of_kind_not_needed.json": (
        "victims[0].service_time",
        "'DebrisRemover'",
        "remove it, or add the kind to its requirements",
    ),
    "no_service_time.json": ("service_time", "'DebrisRemover'", "no time"),
    "repeated_kind.json": ("capabilities[2]", "'FirstAids'", "listed once"),
    "repeated_capability.json": ("robots[1].capabilities[1]", "'DebrisRemover'", "listed once"),
    "repeated_requirement.json": ("victims[1].requirements[2]", "'FirstAids'", "listed once"),
    "repeated_robot_id.json": ("robots[1].id", "0 is repeated", "ids differ"),
    "repeated_victim_id.json": ("victims[1].id", "1 is repeated", "ids differ"),
    "repeated_scout_id.json": ("scouts[1].id", "4 is repeated", "ids differ"),
    "no_robots.json": ("robots", "[]", "give a list of 1 or more"),
    "too_few_cluster_labels.json": ("clusters", "1 label for 2 victims", "one per victim"),
    # Cells and embedded maps
    "start_outside_map.json": ("robots[1].start", "[2, 1]", "rows are 0 to 1, columns 0 to 2"),
    "cell_outside_map.json": ("victims[1].cell", "[1, 3]", "rows are 0 to 1, columns 0 to 2"),
    "cell_in_wall.json": ("victims[1].cell", "[0, 2]", "give a free cell"),
    "scout_in_wall.json": ("scouts[0].start", "[0, 2]", "give a free cell"),
    "number_for_map.json": ("map", "3;", "path or {"),
    "text_for_rows.json": ("map", "..@", "path or {"),
    "empty_map.json": ("map.rows", "empty", "at least one row"),
    "ragged_rows.json": ("map.rows[1]", "2 cells where row 0 has 3", "equally long"),
    "unknown_map_character.json": ("map.rows[1][1]", "'#'", "free cells are . G S"),
    # Map files that an instance names
    "missing_map_file.json": ("map", "nowhere.map", "no such file"),
    "broken_map_file.json": ("map", "wrong_height.map: line 2: height 3", "the grid below has 2"),
    # Map files
    "no_map_line.map": ("header", "no line 'map'", "before the grid"),
    "no_height.map": ("height", "missing", "give it above the line 'map'"),
    "wrong_height.map": ("line 2", "height 3", "the grid below has 2"),
    "wrong_width.map": ("line 3", "width 4", "the grid below has 3"),
    "no_grid.map": ("rows", "empty", "at least one row"),
    "ragged.map": ("rows[1]", "2 cells, where the header's width is 3", "correct either"),
    "unknown_character.map": ("rows[1][1]", "'#'", "blocked ones @ O T W"),
    # Scenario files
    "too_few_columns.scen": ("line 2", "small.map", "start x y, goal x y"),
    "text_for_coordinate.scen": ("line 3", "left", "start x y, goal x y"),
}


@pytest.mark.parametrize("name", TABLE)
def test_a_broken_file_is_refused_in_one_line_naming_file_field_value_and_what_is_right(
    name: str,
) -> None:
    field, value, right = TABLE[name]
    path = BROKEN / name
    with pytest.raises(InputError) as caught:
        READERS[path.suffix](path)
    message = str(caught.value)
    assert message.isprintable()
    assert message.startswith(f"{path}: {field}: " if field else f"{path}: ")
    assert value in message
    assert right in message
    assert caught.value.field == field
    assert caught.value.file == str(path)


def test_every_broken_file_is_in_the_table() -> None:
    assert {path.name for path in BROKEN.iterdir()} == set(TABLE)


def test_a_file_that_is_not_there_is_said_to_be_missing(tmp_path: Path) -> None:
    for suffix, read in READERS.items():
        path = tmp_path / f"nowhere{suffix}"
        with pytest.raises(InputError) as caught:
            read(path)
        assert str(caught.value) == f"{path}: no such file"
