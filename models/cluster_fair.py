"""Clusters to robots, one to one and fair: max-min, the minimum score of a pair is maximised.

Sets        robots r, clusters c
Data        w_rc    requirements that robot r can serve in cluster c
            w^f_rc  those of victims that r can satisfy fully
Parameter   ψ in [0, 1], the importance of full over partial satisfaction
Variables   x_rc in {0, 1}: robot r takes cluster c
            z: the minimum score of a pair

    max   z
    s.t.  Σ_r x_rc ≤ 1           for all c   a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r   a robot has at most one cluster
          Σ_r Σ_c x_rc = min(N, K)           as many pairs as can be, even if worth nothing
          z ≤ Σ_r [(1 − ψ) w_rc + ψ w^f_rc] x_rc   for all c, if K ≤ N
          z ≤ Σ_c [(1 − ψ) w_rc + ψ w^f_rc] x_rc   for all r, if K > N
              no pair scores less than z: the scarcer side has exactly one pair each

Size        N K + 1 variables, N + K + min(N, K) + 1 rows. A bottleneck assignment.
Source      Osooli et al. (2023), Eq. 1 and the linear assignment of its text, with a max-min
            objective.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import PSI, ClusterData, Spec

SPEC = Spec(
    stage="cluster",
    title="Eq. 1, one to one and fair: max-min, the minimum score of a pair is maximised",
    parameters={"psi": PSI},
)


def build(data: ClusterData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c)."""
    psi = cp.Parameter(nonneg=True, name="psi")
    x = cp.Variable(data.w.shape, boolean=True, name="x")
    minimum = cp.Variable(name="minimum")

    n_robots, n_clusters = x.shape
    scarcer, other = ("cluster {c}", 0) if n_clusters <= n_robots else ("robot {r}", 1)
    partial = cp.sum(cp.multiply(data.w, x), axis=other)
    full = cp.sum(cp.multiply(data.w_full, x), axis=other)
    score = (1 - psi) * partial + psi * full
    return cp.Problem(
        cp.Maximize(minimum),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
            (cp.sum(x) == min(x.shape)).set_label("as many pairs as can be"),
            (minimum <= score).set_label(f"{scarcer} scores at least the minimum"),
        ],
    )
