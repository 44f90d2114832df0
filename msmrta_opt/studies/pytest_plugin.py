"""A plugin for pytest: the fixture `msmrta_baseline`, and the option ``--msmrta-update``.

Installed with the package, it is there in any test suite, and loads nothing until it is used::

    def test_solvers_are_as_they_were(msmrta_baseline):
        msmrta_baseline("cluster.json", ["paper"], stage="cluster", solvers=["auto", "highs"])

``pytest --msmrta-update`` writes the baselines again; look at the difference before it is committed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from ..mission.instance import Instance
    from .baselines import Verdict


def pytest_addoption(parser: pytest.Parser) -> None:
    """The option that writes baselines."""
    parser.getgroup("msmrta").addoption(
        "--msmrta-update",
        action="store_true",
        help="write the baselines of msmrta_baseline again, instead of comparing with them",
    )


@pytest.fixture
def msmrta_baseline(request: pytest.FixtureRequest) -> Callable[..., Verdict]:
    """Hold solves against a baseline; the test fails with a line for all that changed.

    Call it as `studies.baselines.against_baseline`. Files are looked for from the folder of the test.
    """
    folder = request.path.parent

    def hold(
        path: str | Path, instances: Sequence[Instance | str | Path], **options: Any
    ) -> Verdict:
        from ..mission.errors import MsmrtaError
        from .baselines import against_baseline

        update = bool(request.config.getoption("--msmrta-update"))
        baseline = folder / path
        if not update and not baseline.exists():
            pytest.fail(f"{baseline}: no baseline yet; pytest --msmrta-update writes it", False)
        try:
            found = against_baseline(
                baseline, [_beside(folder, item) for item in instances], update=update, **options
            )
        except MsmrtaError as error:
            pytest.fail(str(error), False)
        for line in found.regression.information if found.regression else []:
            print(f"for information: {line}")
        if lines := list(found.wrong) if update else found.lines:
            pytest.fail(f"{baseline}:\n" + "\n".join(lines), False)
        return found

    return hold


def _beside(folder: Path, item: Any) -> Any:
    """The file beside the test, if there is one of that name; else what it is."""
    if isinstance(item, (str, Path)) and (folder / item).is_file():
        return folder / item
    return item
