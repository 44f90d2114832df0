"""Formulations edited in a folder of their own."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from msmrta_opt import formulations
from msmrta_opt.optimise import registry


@pytest.fixture
def edit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str, str, str], str]]:
    """Copy a formulation with one text replaced into a models folder; returns the copy's name."""
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__, str(tmp_path)])
    copies = []

    def copy(name: str, old: str, new: str) -> str:
        text = registry.get(name).path.read_text(encoding="utf-8")
        assert old in text
        copies.append(f"{name}_edited")
        (tmp_path / f"{copies[-1]}.py").write_text(text.replace(old, new), encoding="utf-8")
        return copies[-1]

    yield copy
    for name in copies:
        sys.modules.pop(f"{formulations.__name__}.{name}", None)
