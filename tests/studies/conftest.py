from __future__ import annotations

import pytest

from msmrta_opt import formulations


@pytest.fixture(autouse=True)
def no_folder_of_models_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
