from __future__ import annotations

from collections.abc import Callable

import pytest

from msmrta_opt import cli, formulations


@pytest.fixture
def msmrta() -> Callable[..., int]:
    """Run one command as typed."""
    return lambda *arguments: cli.run([str(argument) for argument in arguments])


@pytest.fixture(autouse=True)
def no_folder_of_models_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
