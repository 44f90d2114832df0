"""Models are files: dropped, broken, edited, doubled."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from msmrta_opt import formulations
from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.optimise.new_models import copy_model
from msmrta_opt.optimise.registry import (
    ENVIRONMENT,
    Listing,
    add_models,
    folders,
    get,
    listings,
    models,
    reload_models,
    remove_models,
)
from msmrta_opt.optimise.solve import solve

MODEL = '''"""Worth a given number.

    max   {worth} x
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec

SPEC = Spec(stage="{stage}", title="worth {worth}")


def build(data):
    x = cp.Variable(boolean=True, name="x")
    return cp.Problem(cp.Maximize({worth} * x), [(x <= 1).set_label("at most one")])
'''


def model(worth: int = 1, stage: str = "cluster") -> str:
    return MODEL.format(worth=worth, stage=stage)


@pytest.fixture(autouse=True)
def forgotten_afterwards(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Folders added and modules imported by a test are gone after it."""
    monkeypatch.setattr(formulations, "__path__", list(formulations.__path__))
    monkeypatch.delenv(ENVIRONMENT, raising=False)
    before = {name for name in sys.modules if name.startswith(formulations.__name__)}
    yield
    for name in [name for name in sys.modules if name.startswith(formulations.__name__ + ".")]:
        if name not in before:
            del sys.modules[name]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of models of one's own, added, with nothing in it."""
    path = tmp_path / "own"
    path.mkdir()
    add_models(path)
    return path


def listed(name: str) -> list[Listing]:
    return [listing for listing in listings() if listing.name == name]


def worth(name: str) -> float | None:
    return solve(name, object()).objective


def test_the_shipped_folder_is_the_first() -> None:
    assert folders()[0].name == "models"
    assert get("cluster_printed").path == folders()[0] / "cluster_printed.py"


def test_a_file_dropped_in_a_folder_is_listed_and_solved_at_once(folder: Path) -> None:
    assert listed("dropped") == []
    (folder / "dropped.py").write_text(model(3))
    (listing,) = listed("dropped")
    assert listing.error == ""
    assert listing.path == folder / "dropped.py"
    assert listing.formulation is not None
    assert listing.formulation.spec.title == "worth 3"
    assert listing.formulation.mathematics.startswith("Worth a given number.")
    assert worth("dropped") == 3


def test_a_file_is_found_where_the_file_system_keeps_time_coarsely(folder: Path) -> None:
    """Python remembers a folder's content as long as the folder's time of change is the same."""
    (folder / "first.py").write_text(model(1))
    times = folder.stat()
    assert worth("first") == 1
    (folder / "second.py").write_text(model(2))
    os.utime(folder, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert worth("second") == 2


def test_a_file_that_is_gone_is_no_longer_listed(folder: Path) -> None:
    (folder / "gone.py").write_text(model())
    assert worth("gone") == 1
    (folder / "gone.py").unlink()
    assert listed("gone") == []
    with pytest.raises(InputError, match="no formulation 'gone'"):
        get("gone")


def test_files_that_begin_with_an_underscore_are_helpers(folder: Path) -> None:
    (folder / "_shared.py").write_text("raise ValueError")
    assert listed("_shared") == []


def test_a_name_may_have_a_hyphen(folder: Path) -> None:
    (folder / "my-model.py").write_text(model(4))
    assert worth("my-model") == 4


BROKEN: dict[str, tuple[str, str, int | None]] = {
    "syntax": ("import cvxpy\n\nx = (\n", "SyntaxError", 3),
    "no_spec": ("def build(data):\n    pass\n", "SPEC", None),
    "no_build": (model().split("def build")[0], "build", None),
    "spec_of_another_type": ("SPEC = 3\n\n\ndef build(data):\n    pass\n", "SPEC", None),
    "build_is_no_function": (model().split("def build")[0] + "build = 3\n", "build", None),
    "raises": (
        "SPEC = build = None\n\nraise ValueError('first\\nsecond')\n",
        "ValueError: first",
        3,
    ),
    "raises_deeper": ("def build():\n    return 1 / 0\n\n\nbuild()\n", "ZeroDivisionError", 2),
    "module_not_there": (
        "SPEC = build = None\nimport no_such_module_anywhere\n",
        "no_such_module_anywhere",
        2,
    ),
    "attribute_not_there": (
        "import cvxpy as cp\n\nSPEC = build = cp.NoSuchThing\n",
        "NoSuchThing",
        3,
    ),
    "exits": ("import sys as build\n\nbuild.exit('not today')\n", "SystemExit", 3),
    "null_byte": ("x = 1\0\n", "null bytes", None),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_stays_listed_with_its_error(folder: Path, name: str) -> None:
    text, error, _ = BROKEN[name]
    (folder / f"{name}.py").write_text(text)
    (folder / "sound.py").write_text(model(5))
    (listing,) = listed(name)
    assert listing.formulation is None
    assert error in listing.error
    assert "\n" not in listing.error
    assert "Traceback" in listing.details
    assert worth("sound") == 5


@pytest.mark.parametrize("name", BROKEN)
def test_asking_for_a_broken_file_names_the_file_and_the_line(folder: Path, name: str) -> None:
    text, error, line = BROKEN[name]
    path = folder / f"{name}.py"
    path.write_text(text)
    with pytest.raises(ModelError) as caught:
        get(name)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert error in message
    assert "\n" not in message
    if line is not None:
        assert f"line {line}" in message


def test_an_error_of_the_models_own_is_not_blamed_on_the_contract(folder: Path) -> None:
    (folder / "misspelt.py").write_text(BROKEN["attribute_not_there"][0])
    (listing,) = listed("misspelt")
    assert "build(data)" not in listing.error


def test_a_file_that_is_no_formulation_is_neither_listed_nor_run(folder: Path) -> None:
    (folder / "drawing.py").write_text("import json\n\nraise SystemExit('run')\n")
    assert listed("drawing") == []
    with pytest.raises(ModelError, match=r"drawing.py: not a formulation: it has no SPEC and"):
        get("drawing")


def test_a_broken_file_that_is_mended_works_without_more_ado(folder: Path) -> None:
    (folder / "mended.py").write_text("SPEC = build = int('')\n")
    assert listed("mended")[0].error
    (folder / "mended.py").write_text(model(6))
    assert worth("mended") == 6


def test_a_name_that_is_taken_is_listed_with_both_files(folder: Path) -> None:
    (folder / "cluster_printed.py").write_text(model(7))
    shipped, own = listed("cluster_printed")
    assert shipped.error == ""
    assert own.path == folder / "cluster_printed.py"
    assert own.formulation is None
    assert str(shipped.path) in own.error
    assert "rename" in own.error
    assert get("cluster_printed").path == shipped.path


def test_listings_of_a_stage_leave_out_others_but_not_broken_files(folder: Path) -> None:
    (folder / "for_victims.py").write_text(model(stage="victim"))
    (folder / "broken.py").write_text("(")
    names = {listing.name for listing in listings("cluster")}
    assert {"cluster_printed", "broken"} <= names
    assert not {"for_victims", "victim_printed"} & names


def test_a_formulation_of_another_stage_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="'victim_printed' is a victim formulation"):
        get("victim_printed", stage="cluster")


def test_an_unknown_name_is_refused_with_the_known_ones(folder: Path) -> None:
    (folder / "broken.py").write_text("(")
    with pytest.raises(InputError) as caught:
        get("cluster_one_to_two")
    message = str(caught.value)
    assert message.startswith(
        "model: no formulation 'cluster_one_to_two' (did you mean 'cluster_one_to_one'?); there are "
    )
    assert "broken" not in message


def test_folders_come_from_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in (1, 2):
        (tmp_path / f"folder{number}").mkdir()
        (tmp_path / f"folder{number}" / f"from_environment_{number}.py").write_text(model(number))
    paths = [str(tmp_path / "folder1"), str(tmp_path / "folder2")]
    monkeypatch.setenv(ENVIRONMENT, os.pathsep.join(paths))
    assert worth("from_environment_1") == 1
    assert worth("from_environment_2") == 2
    assert [path.name for path in folders()][-2:] == ["folder1", "folder2"]


def test_a_folder_added_twice_is_there_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add_models(str(folder / ".." / "own"))
    monkeypatch.setenv(ENVIRONMENT, str(folder))
    assert folders().count(folder) == 1


def test_a_folder_that_is_not_there_is_an_input_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="nowhere: no such folder of models"):
        add_models(tmp_path / "nowhere")
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "nowhere"))
    with pytest.raises(InputError, match="nowhere: no such folder of models"):
        folders()


Edit = Callable[[str], None]


@pytest.fixture
def edit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Edit:
    """Write "edited.py" as fast edits do: always at the same second, with bytecode kept."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    second = 1_700_000_000

    def write(text: str) -> None:
        (folder / "edited.py").write_text(text)
        os.utime(folder / "edited.py", (second, second))

    return write


def test_an_edit_counts_after_reload_however_fast_it_was_made(edit: Edit) -> None:
    for number in (1, 2, 3):  # files of the same length
        edit(model(number))
        reload_models()
        assert worth("edited") == number


def test_an_edit_that_breaks_a_file_is_seen_after_reload(edit: Edit) -> None:
    edit(model(1))
    assert worth("edited") == 1
    edit(model(1).replace("Spec(", "Spek("))
    reload_models()
    with pytest.raises(ModelError, match="Spek"):
        get("edited")


def test_an_edited_file_is_solved_anew_on_data_that_was_solved_before(edit: Edit) -> None:
    class Data:
        """Anything that a weak reference can point to."""

    data = Data()
    edit(model(1))
    assert solve("edited", data).objective == 1
    edit(model(22))
    reload_models()
    assert solve("edited", data).objective == 22


def test_reloading_lists_what_there_is_now(folder: Path) -> None:
    (folder / "new.py").write_text(model())
    (folder / "broken.py").write_text("(")
    names = {listing.name: bool(listing.error) for listing in reload_models()}
    assert names["new"] is False
    assert names["broken"] is True
    assert names["cluster_printed"] is False


def test_a_copy_is_known_at_once_and_solved(folder: Path) -> None:
    path = copy_model("cluster_printed", "cluster_mine", to=folder)
    assert path == folder / "cluster_mine.py"
    assert path.read_text() == get("cluster_printed").path.read_text()
    assert "cluster_mine" in [item.name for item in models("cluster")]


def test_a_copy_never_takes_a_name_that_is_taken(folder: Path) -> None:
    with pytest.raises(InputError, match="already the name of"):
        copy_model("cluster_printed", "cluster_budgeted", to=folder)
    assert list(folder.glob("*.py")) == []


def test_a_removed_folder_is_no_longer_looked_into_even_if_it_is_gone(folder: Path) -> None:
    before = [item.name for item in models()]
    path = copy_model("cluster_printed", "cluster_mine", to=folder)
    path.unlink()
    folder.rmdir()
    remove_models(folder)
    assert [item.name for item in models()] == before
    assert folder not in folders()


def test_only_an_added_folder_can_be_removed(folder: Path) -> None:
    for wrong in (folder / "none", folders()[0]):
        with pytest.raises(InputError, match="not an added folder of models"):
            remove_models(wrong)


def test_a_name_that_was_another_folders_is_read_from_its_own_file(tmp_path: Path) -> None:
    for number, folder in ((1, "gone"), (2, "here")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mine.py").write_text(model(number), encoding="utf-8")
    add_models(tmp_path / "gone")
    assert get("mine").spec.title == "worth 1"
    formulations.__path__.pop()
    add_models(tmp_path / "here")
    assert get("mine").spec.title == "worth 2"
