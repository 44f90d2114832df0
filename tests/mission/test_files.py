from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import pytest

from msmrta_opt.mission import files
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.files import (
    DEEPEST,
    LARGEST_MIB,
    MAX_DIGITS,
    parse_json,
    read_json,
    read_text,
    read_toml,
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


# What is read


@pytest.mark.parametrize(
    "data",
    [b"a\nb\n", b"a\r\nb\r\n", b"a\rb\r", b"\xef\xbb\xbfa\nb\n"],
    ids=["unix", "windows", "old mac", "byte order mark"],
)
def test_line_ends_and_a_byte_order_mark_make_no_difference(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "note.txt"
    path.write_bytes(data)
    assert read_text(path) == "a\nb\n"


@posix
def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(InputError, match=r"pipe: cannot be read \(not a regular file\); give a"):
        read_text(path)


@posix
@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "/dev/tty"])
def test_a_device_is_refused_without_a_look_into_it(device: str) -> None:
    with pytest.raises(InputError, match="not a regular file"):
        read_text(device)


def test_a_folder_is_refused_as_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be read \(a folder\)"):
        read_text(tmp_path)


@posix
def test_a_link_to_a_regular_file_is_read_and_one_to_itself_is_not(tmp_path: Path) -> None:
    (tmp_path / "note.txt").write_text("text")
    (tmp_path / "link").symlink_to("note.txt")
    (tmp_path / "loop").symlink_to("loop")
    assert read_text(tmp_path / "link") == "text"
    with pytest.raises(InputError, match=r"loop: cannot be read"):
        read_text(tmp_path / "loop")


@pytest.mark.parametrize("name", ["a\0b", "\ud800"])
def test_a_name_that_no_file_can_have_is_refused_on_one_line(name: str) -> None:
    with pytest.raises(InputError) as caught:
        read_text(name)
    assert str(caught.value).isprintable()


def test_a_file_beyond_the_limit_is_refused_and_one_below_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "zeros"
    with path.open("wb") as file:
        file.truncate(LARGEST_MIB * 2**20 + 1)
    with pytest.raises(InputError, match=r"too large; give at most 64 MiB"):
        read_text(path)
    monkeypatch.setattr(files, "LARGEST_MIB", 1)
    with path.open("wb") as file:
        file.truncate(2**20)
    assert len(read_text(path)) == 2**20


def reads(*paths: object, given: bytes) -> str:
    """What a process says that reads `paths` with `given` as its standard input."""
    code = (
        "import sys; from msmrta_opt.mission.files import read_text\n"
        "print([read_text(path) for path in sys.argv[1:]])"
    )
    arguments = [sys.executable, "-c", code, *map(str, paths)]
    return subprocess.run(arguments, input=given, capture_output=True, check=True).stdout.decode()


def test_a_dash_is_standard_input_however_often_it_is_read() -> None:
    assert reads("-", "-", given=b"two\r\nlines") == "['two\\nlines', 'two\\nlines']\n"


# JSON and TOML

NINES = "9" * (MAX_DIGITS + 1)
DOCUMENTS: dict[str, tuple[str, str, str]] = {
    # what is wrong: (text, field, problem)
    "key given twice": ('{"a": {"b": 5, "b": 500}}', "a.b", "is given twice; give it once"),
    "key given twice in a list": ('[{}, {"b": 1, "b": 1}]', "[1].b", "is given twice"),
    "tables given twice": ('{"a": {}, "b": 0, "a": {}}', "a", "is given twice"),
    "empty key given twice": ('{"": 0, "": 0}', "", "is given twice"),
    "not a number": ('{"a": [0, NaN]}', "a[1]", "NaN; give a finite number"),
    "infinite": ('{"a": -Infinity}', "a", "-Infinity; give a finite number"),
    "beyond a float": ('{"a": 1e999}', "a", "Infinity; give a finite number"),
    "too long for Python": ('{\n"a": ' + "9" * 5000 + "}", "line 2", "more than 300 digits"),
    "too long for a float": (f'{{"a": -{NINES}}}', "a", "more than 300 digits"),
    "too deep for Python": ("[" * 100_000, "", "nested too deep; give at most 100 levels"),
    "too deep for us": (
        "[" * (DEEPEST + 2) + "]" * (DEEPEST + 2),
        "",
        "too deep",
    ),
    "half a surrogate pair": ('{"a": "\\ud800"}', "a", "half a surrogate pair"),
    "half a surrogate pair as key": ('{"\\ud800": 1}', "'\\ud800'", "half a surrogate pair"),
    "cut off": ('{"a": 1', "", "broken JSON: Expecting ',' delimiter: line 1 column 8"),
    "two documents": ("{} {}", "", "broken JSON: Extra data: line 1 column 4"),
    "empty": ("", "", "broken JSON: Expecting value: line 1 column 1"),
    "a tab within a text": ('{"a": "\t"}', "", "broken JSON: Invalid control character"),
}
TABLES: dict[str, tuple[str, str, str]] = {
    "key given twice": ("a = 1\na = 2", "", "broken TOML: Cannot overwrite a value"),
    "not a number": ("a = [1.0, nan]", "a[1]", "NaN; give a finite number"),
    "infinite": ("a = -inf", "a", "-Infinity; give a finite number"),
    "beyond a float": ("a = 1e999", "a", "Infinity; give a finite number"),
    "too long for Python": ("b = 1\na = " + "9" * 5000, "line 2", "more than 300 digits"),
    "too long for a float": (f"a = {NINES}", "a", "more than 300 digits"),
    "too long with underscores": ("a = " + "9_9" * 2000, "a", "more than 300 digits"),
    "too deep for Python": ("a = " + "[" * 2000, "", "nested too deep; give at most 100 levels"),
    "deep by its keys": (".".join("a" * 2000) + " = 1", "", "nested too deep"),
    "cut off": ("a = ", "", "broken TOML: Invalid value (at end of document)"),
    "JSON": ('{"a": 1}', "", "broken TOML"),
}


@pytest.mark.parametrize(
    ("read", "documents", "wrong"),
    [
        *((read_json, DOCUMENTS, wrong) for wrong in DOCUMENTS),
        *((read_toml, TABLES, wrong) for wrong in TABLES),
    ],
)
def test_a_document_is_refused_in_one_line_naming_file_field_and_what_is_right(
    read: Callable[[Path], Any],
    documents: dict[str, tuple[str, str, str]],
    wrong: str,
    tmp_path: Path,
) -> None:
    text, field, problem = documents[wrong]
    path = tmp_path / "document"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value).isprintable()
    assert (caught.value.file, caught.value.field) == (str(path), field)
    assert problem in caught.value.problem


def test_a_document_within_all_limits_is_read_as_it_is() -> None:
    deep = "[" * (DEEPEST - 1) + "]" * (DEEPEST - 1)
    text = f'{{"": [true, null, -0.5, 1e308, {NINES[1:]}], "ψ \\ud83d\\ude00": "é", "d": {deep}}}'
    document = parse_json(text)
    assert document[""] == [True, None, -0.5, 1e308, 10**MAX_DIGITS - 1]
    assert document["ψ 😀"] == "é"


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
