"""Clusters to robots, one to one, some robots apart: those take no neighbouring clusters.

The robots R' are named by the option ``apart``, for instance because they would be in each other's way.
Two clusters are neighbours where no third one is nearer to both of them, by walking distance.

Sets        robots r, clusters c and d; R' ⊆ R the robots that keep apart
Data        w_rc    requirements that robot r can serve in cluster c
            w^f_rc  those of victims that r can satisfy fully
            n_cd    1 if c and d are neighbours, else 0
Parameter   ψ in [0, 1], the importance of full over partial satisfaction
Variables   x_rc in {0, 1}: robot r takes cluster c

    max   Σ_r Σ_c [(1 − ψ) w_rc + ψ w^f_rc] x_rc
    s.t.  Σ_r x_rc ≤ 1           for all c      a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r      a robot has at most one cluster
          Σ_{r in R'} (x_rc + x_rd) ≤ 2 − n_cd   for all c, d
                                                of two neighbours one at most has a robot of R'

Size        N K variables, N + K + K² rows. NP-hard in general: independent sets of clusters.
Source      Osooli et al. (2023), Eq. 1; neighbours as in Toussaint (1980), "The relative neighbourhood
            graph of a finite planar set".
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import PSI, ClusterData, Spec

SPEC = Spec(
    stage="cluster",
    title="Eq. 1, one to one; robots of the option apart take no neighbouring clusters",
    parameters={"psi": PSI},
)


def build(data: ClusterData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c)."""
    psi = cp.Parameter(nonneg=True, name="psi")
    x = cp.Variable(data.w.shape, boolean=True, name="x")

    partial = cp.sum(cp.multiply(data.w, x))
    full = cp.sum(cp.multiply(data.w_full, x))
    taken = data.apart.astype(int) @ x
    return cp.Problem(
        cp.Maximize((1 - psi) * partial + psi * full),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
            (taken[:, None] + taken[None, :] <= 2 - data.neighbouring.astype(int)).set_label(
                "one at most of the neighbours {c} and {d} has a robot that keeps apart"
            ),
        ],
    )
