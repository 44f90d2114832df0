"""Files after accidents: every command ends with 0, 1 or 2, and says what is wrong, a line each."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.amounts import sample
from support.mutations import mutated

from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.export import export, read_program, write_program
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.stages.data import stage_data

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def originals(
    tmp_path_factory: pytest.TempPathFactory, instances_dir: Path
) -> dict[str, list[bytes]]:
    """Files that are right, by their suffix; plans are ``.plan``."""
    folder = tmp_path_factory.mktemp("originals")
    missions = [instances_dir / f"{name}.json" for name in ("split", "two_rooms", "scouted")]
    files = {".json": missions, ".map": [Path(__file__).parents[1] / "data" / "corner.map"]}
    for path in missions:
        mission = Instance.read(path)
        # Each mission with its map written out, too, so that the map is hit.
        written = folder / path.name
        Instance.from_document(mission.document()).save(written)
        files[".json"] = [*files[".json"], written]
        for planner in ("msmrta", "greedy"):
            plan = folder / f"{path.stem}_{planner}.plan"
            make_plan(mission, planner=planner).save(plan)
            files.setdefault(".plan", []).append(plan)
    mission = Instance.read(missions[0])
    for name in ("cluster_one_to_one", "victim_balanced", "joint_routing_mtz"):
        formulation = registry.get(name)
        for suffix in (".lp", ".mps"):
            path = folder / f"{name}{suffix}"
            export(formulation, stage_data(mission, formulation.spec.stage), path)
            files.setdefault(suffix, []).append(path)
    return {suffix: [path.read_bytes() for path in paths] for suffix, paths in files.items()}


def assert_survives(
    number: int, originals: dict[str, list[bytes]], msmrta: Run, capsys: Capture, folder: Path
) -> None:
    draw = random.Random(number)
    suffix = draw.choice(sorted(originals))
    path = folder / f"file{suffix}"
    path.write_bytes(mutated(draw.choice(originals[suffix]), draw))
    if suffix in (".lp", ".mps"):
        assert_read_or_refused(path)
        return
    commands: list[tuple[object, ...]] = [("check", path)]
    if suffix == ".json":
        planner = draw.choice(["msmrta", "greedy", "random", "ssi", "mrga"])
        scout = ("scout", path, "--steps", "3")
        commands.append(draw.choice([("plan", path, "--planner", planner), scout]))
    elif suffix == ".map":
        commands = [("generate", "--map", path, "--robots", "1", "--victims", "1", "--kinds", "1")]
    for command in commands:
        status = msmrta(*command)
        said = capsys.readouterr()
        assert status in (0, 1, 2), command
        if status == 2:
            lines = said.err.splitlines()
            assert 1 <= len(lines) <= 10, said.err
            assert all(line.startswith("error: ") for line in lines), said.err
            break


def assert_read_or_refused(path: Path) -> None:
    """A program that is read is written and read again the same."""
    try:
        program = read_program(path)
        write_program(program, path)
    except (InputError, ModelError) as refusal:
        problem = str(refusal)
    else:
        problem = ""
    assert problem.isprintable()
    if problem:
        return
    again = read_program(path)
    assert again.sense == program.sense
    assert np.array_equal(again.cost, program.cost)
    assert np.array_equal(again.lower, program.lower)
    assert np.array_equal(again.integer, program.integer)


@pytest.mark.parametrize("tenth", sample(range(10), 4))
def test_no_file_ends_a_command_in_any_other_way(
    tenth: int,
    originals: dict[str, list[bytes]],
    msmrta: Run,
    capsys: Capture,
    tmp_path: Path,
) -> None:
    for number in range(50 * tenth, 50 * (tenth + 1)):
        assert_survives(number, originals, msmrta, capsys, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("hundredth", range(100))
def test_no_file_of_very_many_ends_a_command_in_any_other_way(
    hundredth: int,
    originals: dict[str, list[bytes]],
    msmrta: Run,
    capsys: Capture,
    tmp_path: Path,
) -> None:
    for number in range(200 * hundredth, 200 * (hundredth + 1)):
        assert_survives(10**6 + number, originals, msmrta, capsys, tmp_path)
