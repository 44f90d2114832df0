"""The page on execution: its code prints what it shows, and its commands work in their order."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt import cli
from msmrta_opt.execution.policies import policies

PAGE = (Path(__file__).parents[1] / "docs" / "execution.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)


def test_the_code_prints_what_the_page_shows() -> None:
    names: dict[str, Any] = {}
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        for code in blocks("python"):
            exec(compile(code, "docs/execution.md", "exec"), names)
    assert said.getvalue() == "".join(blocks("text"))


def test_the_commands_work_with_the_scenario_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (scenario,) = blocks("toml")
    Path("aftershock.toml").write_text(scenario, encoding="utf-8")
    for line in "".join(blocks("sh")).splitlines():
        program, *words = shlex.split(line)
        assert program == "msmrta"
        assert cli.run(words) == 0, line
    made = {path.name for path in tmp_path.iterdir()}
    assert made == {"aftershock.toml", "plan.json", "run.json", "runs.json"}


@pytest.mark.parametrize("name", list(policies()))
def test_every_policy_and_every_option_is_on_the_page(name: str) -> None:
    for word in (name, *policies()[name].defaults):
        assert f"| `{word}` |" in PAGE
