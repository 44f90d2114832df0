"""A folder of one's own models, and what a command says of them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from msmrta_opt import cli, formulations


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of one's own models, where files are put one by one; nothing of it is kept."""
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__, str(tmp_path)])
    yield tmp_path
    for path in tmp_path.glob("*.py"):
        sys.modules.pop(f"{formulations.__name__}.{path.stem}", None)


@pytest.fixture
def told(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    """The exit status of a command, and the line that it says: its error, or its output."""

    def run(*arguments: object) -> tuple[int, str]:
        capsys.readouterr()
        status = cli.run([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert err.count("\n") <= 1
        assert err.startswith("error: ") or not err or arguments[0] == "check"
        return status, err or out

    return run
