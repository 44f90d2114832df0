from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows, write_map

# The paper's Table 1: location, cluster and requirements of each victim.
TABLE_1 = [
    ((16, 7), 0, [0, 1, 1, 0, 0, 0]),
    ((15, 12), 0, [0, 0, 0, 1, 1, 0]),
    ((6, 5), 2, [0, 1, 0, 0, 0, 1]),
    ((11, 4), 2, [0, 0, 1, 0, 1, 0]),
    ((0, 1), 1, [1, 1, 0, 0, 0, 0]),
    ((14, 14), 0, [0, 0, 0, 0, 1, 1]),
    ((14, 12), 0, [1, 0, 0, 0, 1, 0]),
    ((3, 16), 3, [1, 0, 0, 1, 0, 0]),
    ((10, 15), 0, [0, 1, 0, 1, 0, 0]),
    ((0, 12), 3, [1, 0, 0, 0, 1, 0]),
]
# The paper's Table 2: location and capabilities of each robot.
TABLE_2 = [
    ((0, 9), [0, 1, 0, 1, 0, 0]),
    ((0, 10), [1, 0, 1, 0, 1, 0]),
    ((19, 9), [0, 0, 0, 0, 1, 0]),
    ((19, 10), [1, 0, 0, 1, 0, 0]),
]


def test_the_papers_mission_is_that_of_its_table_1(paper: Instance) -> None:
    assert paper.cells == [cell for cell, _, _ in TABLE_1]
    assert paper.clusters == tuple(cluster for _, cluster, _ in TABLE_1)
    np.testing.assert_array_equal(paper.Q, [needs for _, _, needs in TABLE_1])


def test_the_papers_robots_are_those_of_its_table_2(paper: Instance) -> None:
    assert paper.starts == [cell for cell, _ in TABLE_2]
    np.testing.assert_array_equal(paper.P, [capabilities for _, capabilities in TABLE_2])


def test_the_arrays_follow_the_order_of_the_document(mission: Instance) -> None:
    assert (mission.n_robots, mission.n_victims, mission.n_kinds) == (2, 4, 4)
    np.testing.assert_array_equal(mission.P, [[1, 1, 0, 0], [0, 1, 1, 0]])
    np.testing.assert_array_equal(
        mission.Q, [[1, 1, 0, 0], [1, 0, 1, 0], [1, 0, 0, 1], [0, 1, 0, 1]]
    )
    np.testing.assert_array_equal(mission.speed, [1, 0.5])
    np.testing.assert_array_equal(mission.priority, [1, 2, 1, 1])
    assert mission.starts == [(0, 0), (2, 5)]
    assert mission.cells == [(0, 2), (2, 2), (0, 5), (1, 3)]


def test_service_times_are_the_missions_unless_the_victim_has_its_own(mission: Instance) -> None:
    np.testing.assert_array_equal(
        mission.service, [[2, 4, 0, 0], [2, 0, 1, 0], [2, 0, 0, 8], [0, 4, 0, 8]]
    )


@pytest.mark.parametrize("name", ["P", "Q", "service", "speed", "priority"])
def test_arrays_cannot_be_changed(mission: Instance, name: str) -> None:
    array = getattr(mission, name)
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 1


def test_arrays_keep_their_shape_without_victims(mission: Instance) -> None:
    empty = mission.replace(victims=())
    assert empty.Q.shape == empty.service.shape == (0, 4)
    assert empty.priority.shape == (0,)
    assert empty.cells == []


def test_a_field_cannot_be_assigned(mission: Instance) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        mission.name = "other"  # type: ignore[misc]


def test_what_is_left_out_has_its_default() -> None:
    instance = Instance.from_document(
        {
            "map": {"rows": ["."]},
            "capabilities": [],
            "service_time": {},
            "robots": [{"id": 0, "start": [0, 0], "speed": 1, "capabilities": []}],
        }
    )
    assert instance.victims == instance.scouts == ()
    assert instance.clusters is None
    assert instance.name == instance.description == instance.source == ""
    victim = Victim(id=0, cell=(0, 0), requirements=())
    assert victim.priority == 1
    assert victim.service_time == {}


def test_robots_victims_and_scouts_may_share_ids_and_cells() -> None:
    document: dict[str, Any] = {
        "map": {"rows": ["."]},
        "capabilities": ["A"],
        "service_time": {"A": 0},
        "robots": [{"id": 0, "start": [0, 0], "speed": 1, "capabilities": []}],
        "victims": [
            {"id": 0, "cell": [0, 0], "requirements": []},
            {"id": 1, "cell": [0, 0], "requirements": ["A"]},
        ],
        "scouts": [{"id": 0, "start": [0, 0], "visual_field_depth": 0}],
    }
    assert Instance.from_document(document).cells == [(0, 0), (0, 0)]


# Documents and files


def test_a_document_gives_back_the_mission(paper: Instance, mission: Instance) -> None:
    for instance in (paper, mission):
        assert Instance.from_document(instance.document()) == instance


def test_what_is_wrong_with_a_document_is_said_of_the_file_it_came_from(mission: Instance) -> None:
    document = mission.document() | {"robots": []}
    with pytest.raises(InputError, match=r"^robots: \[\]; give"):
        Instance.from_document(document)
    with pytest.raises(InputError, match=r"^plan\.json: robots: \[\]; give"):
        Instance.from_document(document, file="plan.json")


def test_missions_can_be_compared_after_their_arrays_were_used(paper: Instance) -> None:
    one, other = (Instance.from_document(paper.document()) for _ in range(2))
    assert one.Q.any()
    assert other.Q.any()
    assert one == other
    assert one != other.replace(name="other")


def test_a_saved_mission_reads_back_the_same(
    paper: Instance, mission: Instance, tmp_path: Path
) -> None:
    for instance in (paper, mission):
        path = tmp_path / "instance.json"
        instance.save(path)
        assert Instance.read(path) == instance


@pytest.mark.parametrize("folder", [".", "maps", "maps/deep"])
def test_a_map_file_in_or_below_the_folder_is_referred_to(
    mission: Instance, tmp_path: Path, folder: str
) -> None:
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    write_map(mission.map, tmp_path / folder / "ground.map")
    reference = str(Path(folder) / "ground.map")
    document = mission.document() | {"map": reference}
    (tmp_path / "first.json").write_text(json.dumps(document), encoding="utf-8")
    read = Instance.read(tmp_path / "first.json")
    read.save(tmp_path / "second.json")
    saved = json.loads((tmp_path / "second.json").read_text(encoding="utf-8"))
    assert saved["map"] == Path(reference).as_posix()
    assert Instance.read(tmp_path / "second.json") == mission


def test_a_map_file_elsewhere_is_written_out(paper: Instance, tmp_path: Path) -> None:
    paper.save(tmp_path / "paper.json")
    saved = json.loads((tmp_path / "paper.json").read_text(encoding="utf-8"))
    assert saved["map"] == {"rows": list(paper.map.rows)}


def test_a_map_file_that_is_gone_is_written_out(mission: Instance, tmp_path: Path) -> None:
    write_map(mission.map, tmp_path / "ground.map")
    (tmp_path / "first.json").write_text(
        json.dumps(mission.document() | {"map": "ground.map"}), encoding="utf-8"
    )
    read = Instance.read(tmp_path / "first.json")
    (tmp_path / "ground.map").unlink()
    read.save(tmp_path / "second.json")
    assert Instance.read(tmp_path / "second.json") == mission


def test_a_map_path_is_relative_to_the_file_not_to_where_one_stands(
    instances_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = (instances_dir / "paper.json").resolve()
    monkeypatch.chdir(tmp_path)
    assert Instance.read(path).map.source == path.parent / "maps" / "map2.map"


def test_a_mission_whose_folder_does_not_exist_is_not_saved(
    mission: Instance, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"instance\.json: cannot be written"):
        mission.save(tmp_path / "nowhere" / "instance.json")


# Variants


def test_replace_changes_what_is_asked_and_nothing_else(paper: Instance) -> None:
    faster = tuple(robot.model_copy(update={"speed": 1.0}) for robot in paper.robots)
    changed = paper.replace(robots=faster)
    np.testing.assert_array_equal(changed.speed, [1, 1, 1, 1])
    assert changed.replace(robots=paper.robots) == paper
    assert changed.clusters == paper.clusters


def test_replace_recomputes_the_arrays(mission: Instance) -> None:
    assert mission.P.any()
    idle = tuple(robot.model_copy(update={"capabilities": ()}) for robot in mission.robots)
    assert not mission.replace(robots=idle).P.any()


def test_replace_validates(mission: Instance) -> None:
    in_wall = Robot(id=0, start=(0, 4), speed=1, capabilities=())
    with pytest.raises(InputError, match=r"^robots\[0\]\.start: \[0, 4\] is in a wall"):
        mission.replace(robots=(in_wall,))
    with pytest.raises(InputError, match=r"^victims\[1\]\.cell: \[2, 2\] is outside the map"):
        mission.replace(map=grid_from_rows(["......", "......"]), robots=mission.robots[:1])


def test_replace_refuses_a_field_that_does_not_exist(mission: Instance) -> None:
    with pytest.raises(InputError, match=r"^speed: no such field; there are .*robots, victims"):
        mission.replace(speed=3)


def test_pinned_clusters_are_dropped_when_the_victims_change(paper: Instance) -> None:
    assert paper.replace(victims=paper.victims[:3]).clusters is None
    assert paper.replace(victims=paper.victims[:3], clusters=(1, 0, 1)).clusters == (1, 0, 1)


def test_labels_must_still_be_one_per_victim(paper: Instance) -> None:
    with pytest.raises(InputError, match=r"^clusters: 2 labels for 3 victims"):
        paper.replace(victims=paper.victims[:3], clusters=(1, 0))


def test_with_victims_keeps_the_labels_of_those_it_keeps(paper: Instance) -> None:
    few = paper.with_victims([9, 4])
    assert [victim.id for victim in few.victims] == [9, 4]
    assert few.clusters == (3, 1)
    assert paper.replace(clusters=None).with_victims([9, 4]).clusters is None
    assert paper.with_victims([]).n_victims == 0


def test_the_original_is_left_as_it_was(paper: Instance) -> None:
    before = paper.document()
    paper.replace(name="other", victims=())
    paper.with_victims([0])
    assert paper.document() == before
