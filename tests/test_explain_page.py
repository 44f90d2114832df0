"""The page on explanations: its code prints what it shows, and its commands work."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt import cli

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "explain.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)


def test_the_code_prints_what_the_page_shows() -> None:
    names: dict[str, Any] = {}
    n_shown = 0
    for (language, text), (following, shown) in zip(BLOCKS, [*BLOCKS[1:], ("", "")], strict=True):
        if language != "python":
            continue
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            exec(compile(text, "docs/explain.md", "exec"), names)
        if following == "text":
            assert said.getvalue() == shown
            n_shown += 1
    assert n_shown == [language for language, _ in BLOCKS].count("text")


def test_the_commands_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (lines,) = (text.splitlines() for language, text in BLOCKS if language == "sh")
    (tmp_path / "instances").symlink_to(ROOT / "instances")
    monkeypatch.chdir(tmp_path)
    for line in lines:
        program, *arguments = shlex.split(line)
        assert program == "msmrta"
        assert cli.run(arguments) == 0, line
    assert {path.name for path in tmp_path.iterdir()} == {"instances", "why.json", "witness.json"}
