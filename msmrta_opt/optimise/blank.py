"""Formulations to begin with: for a stage the smallest that decides it, with all that a file has."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

CLUSTERING = '''"""Victims in clusters: say here in a line what is chosen.

Sets        victims' cells i, j
Data        d_ij    walking distance from cell i to cell j, in cells
            a_ij    1 if j can be reached from i, else 0
            K       number of clusters
Variables   y_ij in {0, a_ij}: cell i is in the cluster that cell j stands for
            m_j in {0, 1}: cell j stands for a cluster

    min   Σ_i Σ_j d_ij y_ij
    s.t.  Σ_j y_ij = 1           for all i      a cell is in exactly one cluster
          y_ij ≤ m_j             for all i, j   a cell stands for a cluster or for none
          Σ_j m_j = K                           there are K clusters

Size        n² + n variables, n² + n + 1 rows.
Source      Whose idea it is.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import ClusteringData, Spec

SPEC = Spec(stage="clustering", title="what it is, in a line for lists")


def build(data: ClusteringData) -> cp.Problem:
    """The program for `data`; its solution is ``y`` over (i, j)."""
    y = cp.Variable(data.distance.shape, boolean=True, bounds=[0, data.can_reach], name="y")
    stands = cp.Variable(data.n_cells, boolean=True, name="stands")

    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.distance, y))),
        [
            (cp.sum(y, axis=1) == 1).set_label("cell {i} is in exactly one cluster"),
            (y <= stands).set_label("cell {i} is with cell {j} only if that stands for a cluster"),
            (cp.sum(stands) == data.n_clusters).set_label("there are K clusters"),
        ],
    )
'''
CLUSTER = '''"""Clusters to robots: say here in a line what is chosen.

Sets        robots r, clusters c
Data        w_rc    requirements that robot r can serve in cluster c
Variables   x_rc in {0, 1}: robot r takes cluster c

    max   Σ_r Σ_c w_rc x_rc
    s.t.  Σ_r x_rc ≤ 1           for all c   a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r   a robot has at most one cluster

Size        N K variables, N + K rows.
Source      Whose idea it is.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import ClusterData, Spec

SPEC = Spec(stage="cluster", title="what it is, in a line for lists")


def build(data: ClusterData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c)."""
    x = cp.Variable(data.w.shape, boolean=True, name="x")

    return cp.Problem(
        cp.Maximize(cp.sum(cp.multiply(data.w, x))),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
        ],
    )
'''
VICTIM = '''"""Victims to robots: say here in a line what is chosen.

Sets        robots r, victims v; V⁺ the victims with a_rv = 1 for some r
Data        S_rv    when robot r would be done with victim v, in time units
            a_rv    1 if r can reach v and serve something there, else 0
Variables   x_rv in {0, a_rv}: robot r takes victim v

    min   Σ_v Σ_r S_rv x_rv
    s.t.  Σ_r x_rv = 1           for all v in V⁺   a victim has exactly one robot

Size        N M variables, M rows.
Source      Whose idea it is.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec, VictimData

SPEC = Spec(stage="victim", title="what it is, in a line for lists")


def build(data: VictimData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, v)."""
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")

    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x))),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label(
                "victim {v} has one robot if any can serve it"
            )
        ],
    )
'''
BLANK: Mapping[str, str] = MappingProxyType(
    {"clustering": CLUSTERING, "cluster": CLUSTER, "victim": VICTIM}
)
"""The files, by stage. The joint stages have no small one: theirs begin as copies of shipped ones."""
