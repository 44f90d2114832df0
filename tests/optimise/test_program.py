"""Arrays and the names of what stands in them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.programs import program

from msmrta_opt.optimise.program import Block, Program, element_name


def two_blocks() -> Program:
    """A 2 × 3 table "x" before a scalar "T"; rows by hand as long."""
    base = program(np.ones((7, 7)), 1, 0)
    columns = (Block("x", 0, (2, 3)), Block("T", 6, ()))
    rows = (Block("pair {r} with {c}", 0, (2, 3)), Block("all", 6, ()))
    return Program(**{**base.__dict__, "columns": columns, "rows": rows})


def test_a_table_lies_in_the_columns_by_columns() -> None:
    names = [two_blocks().column_name(position) for position in range(7)]
    assert names == ["x[0,0]", "x[1,0]", "x[0,1]", "x[1,1]", "x[0,2]", "x[1,2]", "T"]


def test_a_label_names_the_index_of_its_row() -> None:
    names = [two_blocks().row_name(position) for position in (1, 4, 6)]
    assert names == ["pair 1 with 0", "pair 0 with 2", "all"]


def test_a_label_without_places_gets_the_index_behind_it() -> None:
    assert Block("limit", 3, (4,)).element(5) == "limit[2]"


def test_a_position_outside_all_blocks_is_an_error() -> None:
    with pytest.raises(IndexError):
        two_blocks().column_name(7)


def test_shaping_a_point_and_flattening_it_again_changes_nothing() -> None:
    x = np.arange(7.0)
    shaped = two_blocks().shaped(x)
    assert shaped["x"].tolist() == [[0, 2, 4], [1, 3, 5]]
    assert shaped["T"].shape == ()
    assert shaped["T"] == 6
    np.testing.assert_array_equal(two_blocks().flat(shaped), x)


def test_columns_that_are_not_named_are_unknown_in_a_flat_point() -> None:
    flat = two_blocks().flat({"T": np.array(2.0)})
    assert np.isnan(flat[:6]).all()
    assert flat[6] == 2


def test_a_relaxation_is_the_same_program_without_integrality() -> None:
    whole = program([[1, 2]], 1, [3, 4], offset=5)
    relaxed = whole.relaxed()
    assert whole.integer.all()
    assert not relaxed.integer.any()
    assert relaxed.value(np.array([1.0, 0.5])) == 3 + 2 + 5


class Counted(tuple[Block, ...]):
    """Blocks that count how many of them are looked at, one by one."""

    looked_at = 0

    def __getitem__(self, place: Any) -> Any:
        Counted.looked_at += 1
        return super().__getitem__(place)

    def __iter__(self) -> Any:
        raise AssertionError("all are looked at")


def test_a_name_is_found_without_looking_at_all_blocks() -> None:
    # Files have a block a variable: to look at all for each name takes minutes at 60,000.
    blocks = Counted(Block(f"x{j}", 3 * j, (3,) if j % 2 else ()) for j in range(4096))
    for position, name in ((0, "x0"), (3, "x1[0]"), (6000, "x2000"), (12287, "x4095[2]")):
        assert element_name(blocks, position) == name
    assert Counted.looked_at <= 4 * 14
    for between in (1, 12288):
        with pytest.raises(IndexError):
            element_name(blocks, between)
