"""Clusters to robots, one to one: the linear assignment of the text around Eq. 1.

Sets        robots r, clusters c
Data        w_rc    requirements that robot r can serve in cluster c
            w^f_rc  those of victims that r can satisfy fully
Parameter   ψ in [0, 1], the importance of full over partial satisfaction
Variables   x_rc in {0, 1}: robot r takes cluster c

    max   Σ_r Σ_c [(1 − ψ) w_rc + ψ w^f_rc] x_rc
    s.t.  Σ_r x_rc ≤ 1           for all c   a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r   a robot has at most one cluster
          Σ_r Σ_c x_rc = min(N, K)           as many pairs as can be, even if worth nothing

Size        N K variables, N + K + 1 rows. Totally unimodular.
Source      Osooli et al. (2023), Eq. 1 and the linear assignment of its text.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import PSI, ClusterData, Spec

SPEC = Spec(
    stage="cluster",
    title="Eq. 1, one to one: each robot at most one cluster (the text's linear assignment)",
    parameters={"psi": PSI},
)


def build(data: ClusterData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c)."""
    psi = cp.Parameter(nonneg=True, name="psi")
    x = cp.Variable(data.w.shape, boolean=True, name="x")

    partial = cp.sum(cp.multiply(data.w, x))
    full = cp.sum(cp.multiply(data.w_full, x))
    return cp.Problem(
        cp.Maximize((1 - psi) * partial + psi * full),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
            (cp.sum(x) == min(x.shape)).set_label("as many pairs as can be"),
        ],
    )
