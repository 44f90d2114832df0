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
JOINT = '''"""Clusters and victims to robots at once: say here in a line what is chosen.

Sets        robots r, clusters c, victims v, each in its cluster c(v); holders h of a victim: the robot
            that has taken its cluster, or ∅ for nobody
Data        B_rhv   service time of robot r for what holder h leaves of victim v, in time units
            a_rhv   1 if r can reach v and serve something that h leaves there, else 0
            g_hv    1 if a_rhv = 1 for some r, else 0
Variables   x_rc in {0, 1}: robot r takes cluster c; x_∅c stands for 1 − Σ_r x_rc, nobody
            y_rv in {0, 1}: robot r takes victim v
            z_rhv in {0, a_rhv}: r takes v, of which h leaves something

    min   Σ_r Σ_h Σ_v B_rhv z_rhv
    s.t.  Σ_r x_rc ≤ 1               for all c      a cluster has at most one robot
          Σ_c x_rc ≤ 1               for all r      a robot has at most one cluster
          Σ_r Σ_c x_rc = min(N, K)                  as many clusters are taken as can be
          Σ_r z_rhv = g_hv x_hc(v)   for all h, v   what the holder leaves has exactly one robot
          Σ_h z_rhv = y_rv           for all r, v   what a robot does is what some holder leaves

Size        N K + N M (N + 2) variables, M (2 N + 1) + N + K + 1 rows.
Source      Whose idea it is.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import JointAssignmentData, Spec

SPEC = Spec(stage="joint", title="what it is, in a line for lists")


def build(data: JointAssignmentData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c) and ``y`` over (r, v)."""
    x = cp.Variable(data.w.shape, boolean=True, name="x")
    y = cp.Variable(data.can_take.shape, boolean=True, bounds=[0, data.can_take], name="y")
    z = cp.Variable(data.service.shape, boolean=True, bounds=[0, data.can_serve], name="z")

    held = x[:, data.cluster]
    holder = cp.vstack([held, 1 - cp.sum(held, axis=0, keepdims=True)])
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.service, z))),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
            (cp.sum(x) == min(x.shape)).set_label("as many clusters are taken as can be"),
            (cp.sum(z, axis=0) == cp.multiply(data.leaves, holder)).set_label(
                "what holder {h} leaves of victim {v} has one robot"
            ),
            (cp.sum(z, axis=1) == y).set_label(
                "robot {r} does what some holder leaves of victim {v}"
            ),
        ],
    )
'''
ROUTING = '''"""Who serves what, and in which order: say here in a line what is chosen.

Sets        robots r; victims v, j; kinds k; places i: the victims, or ∅, the robot's start
Data        d_rij   travel of robot r from place i to victim j, in time units
            b_rv    travel of robot r from victim v back to its start, 0 if it need not return
            s_vk    service time of kind k at victim v, in time units
            g_rvk   1 if r can reach v and serve kind k there, else 0
            g_rij   1 if r can serve something at j ≠ i, and at i if that is a victim, else 0
            m_r     number of victims that r can visit, or 1 if there are none
            D_r     longest travel of robot r, in time units
            E_r     longest time that robot r may be busy, in time units
Variables   x_rij in {0, g_rij}: robot r goes from place i to victim j
            y_rv in {0, 1}: robot r visits victim v
            a_rvk in {0, g_rvk}: robot r serves kind k at victim v
            p_rv ≥ 0: number of victim v on the route of robot r

    min   Σ_r B_r
    s.t.  Σ_r a_rvk = max_r g_rvk   for all v, k      each requirement is served exactly once
          a_rvk ≤ y_rv              for all r, v, k   robots serve where they are
          Σ_i x_rij = y_rj          for all r, j      a visit has one way in
          Σ_j x_rvj ≤ y_rv          for all r, v      … and at most one way on
          Σ_j x_r∅j ≤ 1             for all r         a robot leaves its start at most once
          p_rv − p_rj + m_r x_rvj ≤ m_r − 1   for all r, v, j
              of two visits in a row the second has the next number
          W_r ≤ D_r, B_r ≤ E_r      for all r         the robots' limits
    with  W_r = Σ_i Σ_j d_rij x_rij + Σ_v b_rv (y_rv − Σ_j x_rvj), the travel of robot r
          B_r = W_r + Σ_v Σ_k s_vk a_rvk, when it is done

Size        N M (M + L + 3) variables, M (L + N (M + L + 2)) + 3 N rows, for L kinds.
Source      Whose idea it is.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec
from msmrta_opt.routing.problem import RoutingData

SPEC = Spec(stage="routing", title="what it is, in a line for lists")


def build(data: RoutingData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, i, j), ``y`` (r, v), ``a`` (r, v, k)."""
    x = cp.Variable(data.can_go.shape, boolean=True, bounds=[0, data.can_go], name="x")
    y = cp.Variable(data.can_visit.shape, boolean=True, bounds=[0, data.can_visit], name="y")
    a = cp.Variable(data.able.shape, boolean=True, bounds=[0, data.able], name="a")
    place = cp.Variable(y.shape, bounds=[0, None], name="place")

    between, first = x[:, : data.n_victims, :], x[:, data.n_victims, :]
    onward = cp.sum(between, axis=2)
    walked = cp.sum(cp.multiply(data.travel, x), axis=(1, 2))
    walked += cp.sum(cp.multiply(data.back, y - onward), axis=1)
    busy = walked + cp.sum(cp.multiply(data.service[None], a), axis=(1, 2))
    visits = data.maximum_visits[:, None, None]
    numbers = place[:, :, None] - place[:, None, :] + cp.multiply(visits, between)
    return cp.Problem(
        cp.Minimize(cp.sum(busy)),
        [
            (cp.sum(a, axis=0) == data.required.astype(int)).set_label(
                "kind {k} at victim {v} is served exactly once, if any robot can"
            ),
            (a <= y[:, :, None]).set_label("robot {r} serves victim {v} with {k} only on a visit"),
            (cp.sum(x, axis=1) == y).set_label(
                "robot {r} has one way to victim {j} that it visits"
            ),
            (onward <= y).set_label("robot {r} has at most one way on from victim {v}"),
            (cp.sum(first, axis=1) <= 1).set_label("robot {r} leaves its start at most once"),
            (numbers <= visits - 1).set_label(
                "robot {r} numbers its visits if it goes from victim {v} to victim {j}"
            ),
            (walked <= data.maximum_travel).set_label("robot {r} travels no longer than it may"),
            (busy <= data.maximum_busy).set_label("robot {r} is busy no longer than it may"),
        ],
    )
'''
BLANK: Mapping[str, str] = MappingProxyType(
    {
        "clustering": CLUSTERING,
        "cluster": CLUSTER,
        "victim": VICTIM,
        "joint": JOINT,
        "routing": ROUTING,
    }
)
"""The files, by stage."""
