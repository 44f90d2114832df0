from __future__ import annotations

import pytest

from msmrta_opt.mission.instance import Instance
from msmrta_opt.stages.data import stage_data


@pytest.fixture(scope="session")
def paper_cluster(paper: Instance) -> object:
    """Eq. 1 of the paper's mission."""
    return stage_data(paper, "cluster")
