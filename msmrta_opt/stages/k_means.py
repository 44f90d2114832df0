"""K-means: seeded, by random swaps in machine code; what is left to do, by scikit-learn on one thread.

That is all of it without numba, and next to never anything with it: scikit-learn is loaded then.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from threadpoolctl import ThreadpoolController

from ..arrays import Floats, Ints

SURE = 1e-6
"""Differences, in cells and their squares, that no rounding hides on a map."""
N_SWAPS = 200
N_STARTS = 50
"""Random starts without numba. Random members find better partitions than spread ones (k-means++)."""


def k_means(locations: Floats, k: int, seed: int) -> Ints:
    """Label each of `locations`, shape ``(n, 2)``, with one of `k` clusters.

    The same for the same seed. `N_SWAPS` swaps find better partitions than the best of `N_STARTS`
    random starts, in a tenth of the time.
    """
    start = _start(locations, k, seed)
    if start is not None and (labels := _settled(locations, start)) is not None:
        return labels
    from sklearn import config_context
    from sklearn.cluster import KMeans

    chosen = (
        {"init": "random", "n_init": N_STARTS} if start is None else {"init": start, "n_init": 1}
    )
    # On data this small, threads cost more than they do, and many times more on a busy machine.
    with _threads().limit(limits=1), config_context(skip_parameter_validation=True):
        fitted = KMeans(n_clusters=k, random_state=seed, **chosen).fit(locations)
    return np.asarray(fitted.labels_, np.int64)


def _settled(locations: Floats, centres: Floats) -> Ints | None:
    """The labels, if `centres` are the means of those nearest to them: Lloyd's algorithm ends there.

    Of centres that are as near, the first: rounding decides nothing.
    """
    down, right = (locations[:, None, axis] - centres[:, axis] for axis in (0, 1))
    far = down * down + right * right
    labels: Ints = (far <= far.min(axis=1, keepdims=True) + SURE).argmax(axis=1)
    count = np.bincount(labels, minlength=len(centres))
    if not count.all():
        return None
    sums = [np.bincount(labels, axis, len(centres)) for axis in locations.T]
    are_means = np.abs(np.stack(sums, axis=1) / count[:, None] - centres).max() <= SURE
    return labels if are_means else None


def _start(locations: Floats, k: int, seed: int) -> Floats | None:
    """Centres to begin with, ``(k, 2)``; `None` without numba."""
    try:
        from .random_swap import centres
    except ImportError:
        return None
    return centres(locations, k, N_SWAPS, seed)


@cache
def _threads() -> ThreadpoolController:
    return ThreadpoolController()
