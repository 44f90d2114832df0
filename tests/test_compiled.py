"""Compiling: once ever, in memory where there is no other way, and not without a word."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
KERNEL = """
from msmrta_opt.compiled import inlined, kernel

@inlined
def add(a, b):
    return a + b

@kernel("int64(int64)")
def next_one(number):
    return add(number, 1)
"""
CALL = "import os, sys\n{before}\nimport counting; print(counting.next_one(41), {says})"
LOADED = "sum(counting.next_one.stats.cache_hits.values())"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "counting.py").write_text(KERNEL)
    return tmp_path


def called(
    folder: Path, before: str = "", says: str = LOADED, **environment: str
) -> tuple[str, str]:
    """What a new process that calls the kernel puts out, and what it says on a terminal."""
    here, there = pty.openpty()
    variables = {**os.environ, "PYTHONPATH": f"{ROOT}:{folder}", **environment}
    command = [sys.executable, "-c", CALL.format(before=before, says=says)]
    run = subprocess.run(
        command, env=variables, stdout=subprocess.PIPE, stderr=there, check=False, text=True
    )
    os.close(there)
    told = b""
    while True:
        try:
            chunk = os.read(here, 1 << 16)
        except OSError:  # the other side is closed, on Linux
            break
        if not chunk:
            break
        told += chunk
    os.close(here)
    assert run.returncode == 0, told
    return run.stdout, told.decode()


def test_the_first_call_ever_compiles_and_says_so_and_those_after_it_do_neither(
    folder: Path,
) -> None:
    first, again = called(folder), called(folder)
    assert (first[0], again[0]) == ("42 0\n", "42 1\n")
    assert first[1].count("\n") == 1
    assert "compiling" in first[1]
    assert again[1] == ""


def test_nothing_is_said_where_there_is_no_terminal(folder: Path) -> None:
    assert called(folder, "sys.stderr = open(os.devnull, 'w')") == ("42 0\n", "")


def test_where_no_folder_can_be_written_to_code_is_kept_in_memory(folder: Path) -> None:
    (folder / "file").write_text("")
    only = {"NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}
    only["NUMBA_CACHE_DIR"] = str(folder / "file")
    assert called(folder, says="counting.next_one.stats.cache_path", **only)[0] == "42 None\n"


def test_code_that_was_broken_while_it_was_kept_is_compiled_anew(folder: Path) -> None:
    called(folder)
    kept = list(folder.rglob("*.nb*"))
    assert kept
    for file in kept:
        file.write_bytes(b"broken")
    assert called(folder)[0].startswith("42 ")
