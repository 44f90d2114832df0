"""What all runs of a study share: imported once, in the server that their processes are forked from."""

from __future__ import annotations

import gc

import cvxpy  # noqa: F401

from ..planners import planners
from ..planners.support.planner import versions

# Formulations are not among them: a worker of a cluster outlives edits of their files.
planners()
versions()
# What all have is not to be looked through again by each of them, nor copied for it.
gc.collect()
gc.freeze()
