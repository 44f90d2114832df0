"""The published JSON Schema is up to date, accepts what the reader accepts, and refuses the rest."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from msmrta_opt.mission import scenario
from msmrta_opt.mission.instance import Instance, json_schema

BROKEN = Path(__file__).parents[1] / "broken"
INSTANCES = Path(__file__).parents[2] / "instances"

NOT_JSON = {"broken_json.json", "empty_file.json", "not_utf8.json", "folder.json"}
BEYOND_A_SCHEMA = {
    # numbers that are not in the JSON standard, and what JSON's readers take
    "nan_speed.json",
    "key_given_twice.json",
    "speed_of_nothing.json",
    # one part of a document against another, or against another file
    "broken_map_file.json",
    "cell_in_wall.json",
    "cell_outside_map.json",
    "missing_map_file.json",
    "no_service_time.json",
    "override_of_kind_not_needed.json",
    "ragged_rows.json",
    "repeated_capability.json",
    "repeated_kind.json",
    "repeated_requirement.json",
    "repeated_robot_id.json",
    "repeated_scout_id.json",
    "repeated_victim_id.json",
    "scout_in_wall.json",
    "start_outside_map.json",
    "too_few_cluster_labels.json",
    "unknown_capability.json",
    "unknown_requirement.json",
    "unknown_service_time.json",
}


@pytest.fixture(scope="module")
def published() -> str:
    resource = files("msmrta_opt.mission") / "instance.schema.json"
    return resource.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def validator(published: str) -> Draft202012Validator:
    return Draft202012Validator(json.loads(published))


def load(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def test_the_published_schema_is_that_of_the_program(published: str) -> None:
    assert published == json.dumps(json_schema(), indent=1) + "\n"


def test_the_published_schema_of_scenarios_is_that_of_the_program() -> None:
    resource = files("msmrta_opt.mission") / "scenario.schema.json"
    schema = scenario.json_schema()
    assert resource.read_text(encoding="utf-8") == json.dumps(schema, indent=1) + "\n"
    Draft202012Validator.check_schema(schema)


def test_the_published_schema_is_a_valid_schema(validator: Draft202012Validator) -> None:
    Draft202012Validator.check_schema(validator.schema)


@pytest.mark.parametrize("path", sorted(INSTANCES.glob("*.json")), ids=lambda path: path.stem)
def test_every_shipped_mission_keeps_to_the_schema(
    path: Path, validator: Draft202012Validator
) -> None:
    validator.validate(load(path))


def test_what_the_program_writes_keeps_to_the_schema(
    paper: Instance, mission: Instance, validator: Draft202012Validator, tmp_path: Path
) -> None:
    for instance in (paper, mission, mission.replace(victims=(), scouts=())):
        instance.save(tmp_path / "saved.json")
        validator.validate(load(tmp_path / "saved.json"))


@pytest.mark.parametrize(
    "name", sorted({path.name for path in BROKEN.glob("*.json")} - NOT_JSON - BEYOND_A_SCHEMA)
)
def test_a_broken_document_that_a_schema_can_catch_is_caught(
    name: str, validator: Draft202012Validator
) -> None:
    assert not validator.is_valid(load(BROKEN / name))


@pytest.mark.parametrize("name", sorted(BEYOND_A_SCHEMA))
def test_what_is_listed_as_beyond_a_schema_is_so(
    name: str, validator: Draft202012Validator
) -> None:
    assert validator.is_valid(load(BROKEN / name))
