"""The rest of a mission planned anew, each visit that is taken from its robot at a price.

The joint problem by flows, from where robots are now, and with who was to visit whom: a visit counts as
changed if the robot that was to make it does not. Without such data it is the joint problem itself.

A robot leaves its start with one unit for every victim that it is to visit and drops one at each: what
this flow does not reach is not visited, so no route closes into a cycle of its own.

Sets        robots r; victims v, j; kinds k; places i: the victims, or ∅, the robot's start
Data        d_rij   travel of robot r from place i to victim j, in time units
            b_rv    travel of robot r from victim v back to its start, 0 if it need not return
            s_vk    service time of kind k at victim v, in time units
            g_rvk   1 if r can reach v and serve kind k there, else 0
            g_rij   1 if r can serve something at j ≠ i, and at i if that is a victim, else 0
            m_ri    Σ_j g_rij, the number of victims that r can go to from place i
            D_r     longest travel of robot r, in time units
            E_r     longest time that robot r may be busy, in time units
            h_rv    1 if robot r was to visit victim v, else 0
            p_r     when robot r is done with what is under way, in time units from now
Parameters  w in [0, 1], the importance of the makespan over the total time
            σ ≥ 0, the stability: what a changed visit costs, in time units
Variables   x_rij in {0, g_rij}: robot r goes from place i to victim j
            y_rv in {0, 1}: robot r visits victim v
            a_rvk in {0, g_rvk}: robot r serves kind k at victim v
            f_rij ≥ 0: how many visits robot r has before it on the way from place i to victim j
            T: the makespan, from now

    min   (1 − w) Σ_r B_r + w T + σ Σ_r Σ_v h_rv (1 − y_rv)
    s.t.  Σ_r a_rvk = max_r g_rvk   for all v, k      each requirement is served exactly once
          a_rvk ≤ y_rv              for all r, v, k   robots serve where they are
          y_rv ≤ Σ_k a_rvk          for all r, v      … and visit nobody for nothing
          Σ_i x_rij = y_rj          for all r, j      a visit has one way in
          Σ_j x_rvj ≤ y_rv          for all r, v      … and at most one way on
          Σ_j x_r∅j ≤ 1             for all r         a robot leaves its start at most once
          Σ_i f_rij − Σ_v f_rjv = y_rj   for all r, j   a visit takes one unit of the flow
          f_rij ≤ m_ri x_rij        for all r, i, j   the flow goes where the robot goes
          f_rij ≥ x_rij             for all r, i, j   … and reaches as far; the others imply it, but
                                                      not their relaxation
          p_r + B_r ≤ T             for all r         no robot is done after the makespan
          W_r ≤ D_r                 for all r         no robot travels for longer than it may
          B_r ≤ E_r                 for all r         … or is busy for longer
    with  W_r = Σ_i Σ_j d_rij x_rij + Σ_v b_rv (y_rv − Σ_j x_rvj), the travel of robot r: where there
                is no way on, its way back begins
          B_r = W_r + Σ_v Σ_k s_vk a_rvk, how long robot r is busy with what is to come

No limits   D_r and E_r are then what the longest of routes could take.
Size        N M (2 M + L + 3) + 1 variables, M (L + N (2 M + L + 6)) + 4 N rows, for L kinds. NP-hard:
            one robot that serves everything is a travelling salesman.
Source      Gavish and Graves (1978), "The travelling salesman problem and related problems", for the
            flow. The price is a penalty on the distance from the plan in force, as in rescheduling:
            the higher σ, the fewer visits an optimum changes.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec
from msmrta_opt.routing.problem import RoutingData

SPEC = Spec(
    stage="routing",
    title="The rest of a mission planned anew, each changed visit at a price",
    parameters={
        "w": Parameter(0.0, 1.0, 0.0, "importance of the makespan over the total time"),
        "stability": Parameter(0.0, 1e6, 0.0, "what a changed visit costs, in time units"),
    },
    assumes="the robots' limits leave room for a plan that serves everything",
)


def build(data: RoutingData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, i, j), ``y`` (r, v), ``a`` (r, v, k)."""
    w = cp.Parameter(nonneg=True, name="w")
    stability = cp.Parameter(nonneg=True, name="stability")
    n_victims = data.n_victims
    x = cp.Variable(data.can_go.shape, boolean=True, bounds=[0, data.can_go], name="x")
    y = cp.Variable(data.can_visit.shape, boolean=True, name="y")
    a = cp.Variable(data.able.shape, boolean=True, bounds=[0, data.able], name="a")
    f = cp.Variable(data.can_go.shape, bounds=[0, None], name="f")
    makespan = cp.Variable(name="makespan")

    onward = cp.sum(x[:, :n_victims, :], axis=2)
    walked = cp.sum(cp.multiply(data.travel, x), axis=(1, 2))
    walked += cp.sum(cp.multiply(data.back, y - onward), axis=1)
    busy = walked + cp.sum(cp.multiply(data.service[None], a), axis=(1, 2))
    changed = cp.sum(cp.multiply(data.planned.astype(int), 1 - y))
    passed = cp.sum(f, axis=1) - cp.sum(f[:, :n_victims, :], axis=2)
    return cp.Problem(
        cp.Minimize((1 - w) * cp.sum(busy) + w * makespan + stability * changed),
        [
            (cp.sum(a, axis=0) == data.required.astype(int)).set_label(
                "kind {k} at victim {v} is served exactly once, if any robot can"
            ),
            (a <= y[:, :, None]).set_label("robot {r} serves victim {v} with {k} only on a visit"),
            (y <= cp.sum(a, axis=2)).set_label("robot {r} visits victim {v} only to serve"),
            (cp.sum(x, axis=1) == y).set_label(
                "robot {r} has one way to victim {j} that it visits"
            ),
            (onward <= y).set_label("robot {r} has at most one way on from victim {v}"),
            (cp.sum(x[:, n_victims, :], axis=1) <= 1).set_label(
                "robot {r} leaves its start at most once"
            ),
            (passed == y).set_label("robot {r} takes one unit of its flow to victim {j}"),
            (f <= cp.multiply(data.onward[:, :, None], x)).set_label(
                "robot {r} has visits before it from place {i} to victim {j} only if it goes there"
            ),
            (f >= x).set_label(
                "robot {r} has a visit before it if it goes from place {i} to victim {j}"
            ),
            (data.ready + busy <= makespan).set_label("robot {r} is done by the makespan"),
            (walked <= data.maximum_travel).set_label("robot {r} travels no longer than it may"),
            (busy <= data.maximum_busy).set_label("robot {r} is busy no longer than it may"),
        ],
    )
