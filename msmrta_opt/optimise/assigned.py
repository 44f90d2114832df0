"""Who gets what: a solution's decisions by the ids of those who decide."""

from __future__ import annotations

import numpy as np

from .program import Program
from .solution import Solution

Assigned = dict[str, tuple[str, ...]]
"""By who, for instance ``robot 7``, what they get, for instance ``cluster 2``."""


def assigned(program: Program, solution: Solution) -> Assigned:
    """What each thing of the first axis of the stage's binary variables gets at `solution`.

    Variables without named axes, and others than binary ones of two axes or more, say nothing of it.
    Who gets nothing is there, too.
    """
    found: Assigned = {}
    for block in program.columns:
        own = slice(block.start, block.stop)
        is_binary = program.integer[own].all() and (program.upper[own] <= 1).all()
        if not (is_binary and len(block.nouns) >= 2 and all(block.nouns) and block.ids):
            continue
        values = solution.values.get(block.name)
        if values is None:
            continue
        for place, who in enumerate(block.ids[0]):
            name = f"{block.nouns[0]} {who}"
            what = [
                " → ".join(
                    f"{block.nouns[d + 1]} {block.ids[d + 1][i]}" for d, i in enumerate(index)
                )
                for index in np.argwhere(np.asarray(values)[place] > 0.5).tolist()
            ]
            found[name] = (*found.get(name, ()), *what)
    return found
