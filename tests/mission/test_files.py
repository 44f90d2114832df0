from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import NoReturn

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.files import read_text, write_text, write_with


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    text = "ψ ≤ 1\nβ\n"
    write_text(tmp_path / "note.txt", text)
    assert read_text(tmp_path / "note.txt") == text
    assert (tmp_path / "note.txt").read_bytes().decode("utf-8").split() == text.split()


def test_writing_replaces_what_was_there_and_leaves_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "note.txt"
    write_text(path, "old")
    write_text(path, "new")
    assert path.read_text(encoding="utf-8") == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_writer_that_fails_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "note.txt"
    write_text(path, "old")

    def half(temporary: Path) -> NoReturn:
        temporary.write_text("ha", encoding="utf-8")
        raise RuntimeError("the writer failed")

    with pytest.raises(RuntimeError, match="the writer failed"):
        write_with(path, half)
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_writer_that_fails_before_there_was_a_file_leaves_none(tmp_path: Path) -> None:
    def interrupted(temporary: Path) -> NoReturn:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_with(tmp_path / "note.txt", interrupted)
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_said_of_the_file_asked_for(tmp_path: Path) -> None:
    def full(temporary: Path) -> NoReturn:
        raise OSError(28, "No space left on device", str(temporary))

    path = tmp_path / "note.txt"
    with pytest.raises(InputError) as caught:
        write_with(path, full)
    assert str(caught.value) == f"{path}: cannot be written (No space left on device)"
    assert list(tmp_path.iterdir()) == []


def test_a_writers_own_complaint_is_passed_on(tmp_path: Path) -> None:
    def picky(temporary: Path) -> NoReturn:
        raise OSError("cannot write mode P as JPEG")

    with pytest.raises(InputError, match="cannot write mode P as JPEG"):
        write_with(tmp_path / "picture.jpg", picky)


def test_until_the_writer_is_done_readers_see_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "note.txt"
    write_text(path, "old")
    seen = []

    def write(temporary: Path) -> None:
        temporary.write_text("new", encoding="utf-8")
        seen.append(path.read_text(encoding="utf-8"))

    write_with(path, write)
    assert seen == ["old"]
    assert path.read_text(encoding="utf-8") == "new"


def test_the_temporary_file_lies_beside_the_file_and_ends_alike(tmp_path: Path) -> None:
    names = []

    def write(temporary: Path) -> None:
        names.append(temporary)
        temporary.touch()

    write_with(tmp_path / "picture.svg", write)
    (temporary,) = names
    assert temporary.parent == tmp_path
    assert temporary.suffix == ".svg"
    assert temporary.name != "picture.svg"


@pytest.mark.skipif(os.name != "posix", reason="file modes are those of POSIX")
def test_a_written_file_has_the_mode_of_any_new_file(tmp_path: Path) -> None:
    names = ("before.txt", "ours.txt", "after.txt")
    umask = os.umask(0o027)
    try:
        (tmp_path / names[0]).touch()
        write_text(tmp_path / names[1], "")
        (tmp_path / names[2]).touch()
    finally:
        os.umask(umask)
    assert [(tmp_path / name).stat().st_mode & 0o777 for name in names] == [0o640] * 3


def test_a_folder_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "nowhere" / "note.txt"
    with pytest.raises(InputError) as caught:
        write_text(path, "text")
    assert str(caught.value) == f"{path}: cannot be written (No such file or directory)"


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be written"):
        write_text(tmp_path / "file" / "note.txt", "text")


def test_a_folder_in_the_place_of_the_file_is_refused_and_kept(tmp_path: Path) -> None:
    (tmp_path / "note.txt").mkdir()
    with pytest.raises(InputError, match=r"note\.txt: cannot be written"):
        write_text(tmp_path / "note.txt", "text")
    assert [path.name for path in tmp_path.iterdir()] == ["note.txt"]


def test_a_folder_without_permission_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Acted out, since whoever runs the tests as root may write anywhere.
    def forbidden(*_: object, **__: object) -> NoReturn:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(tempfile, "mkstemp", forbidden)
    path = tmp_path / "note.txt"
    with pytest.raises(InputError) as caught:
        write_text(path, "text")
    assert str(caught.value) == f"{path}: cannot be written (Permission denied)"


def test_a_file_without_permission_cannot_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forbidden(*_: object, **__: object) -> NoReturn:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_text", forbidden)
    path = tmp_path / "note.txt"
    with pytest.raises(InputError) as caught:
        read_text(path)
    assert str(caught.value) == f"{path}: cannot be read (Permission denied)"
