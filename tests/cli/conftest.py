from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt import cli, formulations


@pytest.fixture
def msmrta(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Run one command as typed; no folder of models is kept."""
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    return lambda *arguments: cli.run([str(argument) for argument in arguments])


@pytest.fixture
def paper_file(instances_dir: Path) -> Path:
    return instances_dir / "paper.json"


@pytest.fixture
def corridor_file(instances_dir: Path) -> Path:
    return instances_dir / "corridor.json"
