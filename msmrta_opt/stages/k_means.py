"""K-means by scikit-learn: seeded, several starts, on one thread."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

N_STARTS = 50


def k_means(locations: NDArray[np.float64], k: int, seed: int) -> NDArray[np.int64]:
    """Label each of `locations`, shape ``(n, 2)``, with one of `k` clusters.

    The best of `N_STARTS` starts, by inertia; the same for the same seed. Many starts from random
    members find better partitions than few from spread ones (k-means++), in the same time.
    """
    from sklearn.cluster import KMeans

    # On data this small, threads cost more than they do, and many times more on a busy machine.
    with _threads().limit(limits=1):
        fitted = KMeans(n_clusters=k, init="random", n_init=N_STARTS, random_state=seed).fit(
            locations
        )
    labels: NDArray[np.int64] = fitted.labels_.astype(np.int64)
    return labels


@cache
def _threads() -> ThreadpoolController:
    return ThreadpoolController()
