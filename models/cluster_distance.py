"""Clusters to robots, one to one, with a weight on the walk to the cluster.

Eq. 1 counts what a robot can serve in a cluster and not how far it is. Here each cell of the way to
the centre costs δ of a requirement, so a robot stays where no cluster is worth its walk.

Sets        robots r, clusters c
Data        w_rc    requirements that robot r can serve in cluster c
            w^f_rc  those of victims that r can satisfy fully
            d_rc    walk of robot r from its start to the centre of cluster c, in cells
            a_rc    1 if there is such a walk, else 0
Parameters  ψ in [0, 1], the importance of full over partial satisfaction
            δ in [0, 1], the requirements that a cell of walking is worth
Variables   x_rc in {0, a_rc}: robot r takes cluster c

    max   Σ_r Σ_c [(1 − ψ) w_rc + ψ w^f_rc − δ d_rc] x_rc
    s.t.  Σ_r x_rc ≤ 1           for all c   a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r   a robot has at most one cluster

Size        N K variables, N + K rows. Totally unimodular.
Source      Osooli et al. (2023), Eq. 1, with a term for the distance.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import PSI, ClusterData, Parameter, Spec

SPEC = Spec(
    stage="cluster",
    title="Eq. 1, one to one, less δ for each cell of the walk to the cluster",
    parameters={
        "psi": PSI,
        "delta": Parameter(0.0, 1.0, 0.05, "requirements that a cell of walking is worth"),
    },
)


def build(data: ClusterData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c)."""
    psi = cp.Parameter(nonneg=True, name="psi")
    delta = cp.Parameter(nonneg=True, name="delta")
    x = cp.Variable(data.w.shape, boolean=True, bounds=[0, data.can_enter], name="x")

    partial = cp.sum(cp.multiply(data.w, x))
    full = cp.sum(cp.multiply(data.w_full, x))
    walked = cp.sum(cp.multiply(data.walk_to_cluster, x))
    return cp.Problem(
        cp.Maximize((1 - psi) * partial + psi * full - delta * walked),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
        ],
    )
