from __future__ import annotations

import pytest

from msmrta_opt.mission.errors import CheckError, InputError, ModelError, MsmrtaError, SolverError


@pytest.mark.parametrize("kind", [InputError, ModelError, SolverError, CheckError])
def test_whoever_catches_the_base_catches_everything(kind: type[MsmrtaError]) -> None:
    with pytest.raises(MsmrtaError):
        raise kind("something")


def test_an_input_error_is_a_value_error() -> None:
    with pytest.raises(ValueError, match="something"):
        raise InputError("something")


@pytest.mark.parametrize(
    ("field", "file", "message"),
    [
        ("", None, "0; give more"),
        ("speed", None, "speed: 0; give more"),
        ("", "a.json", "a.json: 0; give more"),
        ("speed", "a.json", "a.json: speed: 0; give more"),
    ],
)
def test_a_message_names_file_and_field_where_there_are_any(
    field: str, file: str | None, message: str
) -> None:
    assert str(InputError("0; give more", field=field, file=file)) == message


def test_an_error_is_said_of_a_file_only_if_it_names_none() -> None:
    error = InputError("0; give more", field="speed")
    assert str(error.within("a.json")) == "a.json: speed: 0; give more"
    assert str(error.within("a.json").within("b.json")) == "a.json: speed: 0; give more"
