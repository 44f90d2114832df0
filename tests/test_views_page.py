"""The page on views: its commands work, in their order, and write what they say."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from msmrta_opt import cli
from msmrta_opt.studies.ledger import Ledger

PAGE = (Path(__file__).parents[1] / "docs" / "views.md").read_text(encoding="utf-8")
STUDY = """
title = "one planner"
instances = [{ files = ["corridor"] }]
planners = [{ planner = "greedy" }]
"""
LINES = [
    line
    for block in re.findall(r"^```sh\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
    for line in block.splitlines()
]


def test_the_commands_work_and_write_their_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "few.toml").write_text(STUDY)
    Ledger(tmp_path / "few.sqlite").close()  # as a run that was stopped at once leaves it
    for line in LINES:
        program, *words = shlex.split(line)
        assert program == "msmrta"
        assert cli.run(words) == 0, line
        written = [word for word in words if re.search(r"\.(json|png|html)$", word)]
        assert all((tmp_path / word).is_file() for word in written), line
