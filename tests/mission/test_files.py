"""Files are written whole or not at all, and what was there keeps its kind, mode and links."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import NoReturn

import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.files import (
    read_text,
    write_text,
    write_with,
)

posix = pytest.mark.skipif(os.name != "posix", reason="devices and modes are those of POSIX")


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


@posix
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

    path = tmp_path / "note.txt"
    path.touch()
    monkeypatch.setattr(Path, "open", forbidden)
    with pytest.raises(InputError) as caught:
        read_text(path)
    assert str(caught.value) == f"{path}: cannot be read (Permission denied)"


# What is written over


@posix
def test_a_link_stays_a_link_and_what_it_points_at_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "note.txt", tmp_path / "link.txt"
    link.symlink_to(Path("folder") / "note.txt")
    for text in ("first, through a link to nothing", "second"):
        write_text(link, text)
        assert link.is_symlink()
        assert target.read_text() == text
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["folder", "link.txt", "note.txt"]


@posix
def test_a_link_to_itself_is_refused(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match="loop: cannot be written"):
        write_text(tmp_path / "loop", "text")


@posix
def test_permissions_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "script"
    path.touch()
    path.chmod(0o750)
    write_text(path, "text")
    assert path.stat().st_mode & 0o7777 == 0o750


@posix
def test_a_file_that_may_not_be_written_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "note.txt"
    path.write_text("kept")
    # Acted out, since whoever runs the tests as root may write anywhere.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(InputError, match=r"note\.txt: cannot be written \(Permission denied\)"):
        write_text(path, "new")
    assert path.read_text() == "kept"


@posix
def test_a_pipe_stays_a_pipe_and_its_reader_gets_the_text(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    got = []
    reader = threading.Thread(target=lambda: got.append(path.read_text()))
    reader.start()
    write_text(path, "text")
    reader.join()
    assert got == ["text"]
    assert path.is_fifo()
    assert list(tmp_path.iterdir()) == [path]


@posix
def test_a_device_stays_a_device() -> None:
    write_text("/dev/null", "text")
    assert Path("/dev/null").is_char_device()
    with pytest.raises(InputError, match=r"/dev/full: cannot be written \(No space left"):
        write_text("/dev/full", "text")
    assert Path("/dev/full").is_char_device()


@posix
def test_a_standard_stream_gets_the_text_in_its_place(tmp_path: Path) -> None:
    code = (
        "from msmrta_opt.mission.files import write_text\n"
        "print('before'); write_text('/dev/stdout', 'text\\n'); print('after')"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout
    assert said == b"before\ntext\nafter\n"
    with (tmp_path / "log").open("wb") as log:
        subprocess.run([sys.executable, "-c", code], stdout=log, check=True)
    assert (tmp_path / "log").read_bytes() == said


def test_a_name_as_long_as_the_system_allows_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 251 + ".txt")
    write_text(path, "text")
    assert path.read_text() == "text"
