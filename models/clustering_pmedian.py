"""Clusters of victims around medians: the p-median problem, so that walls count.

Sets        victims' cells i, j
Data        d_ij    walking distance from cell i to cell j, in cells
            a_ij    1 if j can be reached from i, else 0
            n_i     number of victims on cell i
            K       number of clusters
Variables   y_ij in {0, a_ij}: cell i is in the cluster of cell j
            m_j in {0, 1}: cell j is a median, the centre of a cluster

    min   Σ_i Σ_j n_i d_ij y_ij
    s.t.  Σ_j y_ij = 1           for all i      a cell is in exactly one cluster
          y_ij ≤ m_j             for all i, j   clusters have medians
          Σ_j m_j = K                           there are K medians

Size        n² + n variables, n² + n + 1 rows. NP-hard; its relaxation is nearly always tight.
Source      ReVelle and Swain (1970), "Central facilities location"; in place of the K-means of
            Osooli et al. (2023), Algorithm 1, which does not see walls.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import ClusteringData, Spec

SPEC = Spec(
    stage="clustering",
    title="p-median: minimum walking distance to K victims' cells, walls counted",
    assumes="K is at least the number of parts of the map, joined by no walk, that hold victims",
)


def build(data: ClusteringData) -> cp.Problem:
    """The program for `data`; its solution is ``y`` over (i, j)."""
    y = cp.Variable(data.distance.shape, boolean=True, bounds=[0, data.can_reach], name="y")
    median = cp.Variable(data.n_cells, boolean=True, name="median")

    walked = data.weight @ cp.sum(cp.multiply(data.distance, y), axis=1)
    return cp.Problem(
        cp.Minimize(walked),
        [
            (cp.sum(y, axis=1) == 1).set_label("cell {i} is in exactly one cluster"),
            (y <= median).set_label("cell {i} is with cell {j} only if that is a median"),
            (cp.sum(median) == data.n_clusters).set_label("there are K medians"),
        ],
    )
