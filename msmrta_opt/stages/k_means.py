"""K-means by scikit-learn: seeded, from a start that random swaps have improved, on one thread."""

from __future__ import annotations

from functools import cache

import numpy as np
from threadpoolctl import ThreadpoolController

from ..arrays import Floats, Ints

N_SWAPS = 200
N_STARTS = 50
"""Random starts without numba. Random members find better partitions than spread ones (k-means++)."""


def k_means(locations: Floats, k: int, seed: int) -> Ints:
    """Label each of `locations`, shape ``(n, 2)``, with one of `k` clusters.

    The same for the same seed. `N_SWAPS` swaps find better partitions than the best of `N_STARTS`
    random starts, in a tenth of the time.
    """
    from sklearn import config_context
    from sklearn.cluster import KMeans

    start = _start(locations, k, seed)
    chosen = (
        {"init": "random", "n_init": N_STARTS} if start is None else {"init": start, "n_init": 1}
    )
    # On data this small, threads cost more than they do, and many times more on a busy machine.
    with _threads().limit(limits=1), config_context(skip_parameter_validation=True):
        fitted = KMeans(n_clusters=k, random_state=seed, **chosen).fit(locations)
    labels: Ints = fitted.labels_.astype(np.int64)
    return labels


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
