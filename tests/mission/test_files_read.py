"""Files are read whole or refused on one line: what is no file, too large, or no text of its format."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

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
)

posix = pytest.mark.skipif(os.name != "posix", reason="devices and modes are those of POSIX")


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
