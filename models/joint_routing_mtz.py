"""Who serves what and in which order, in one program; places and times along the routes order them.

A robot's visits are numbered, and each has a time: of victims in a row the later has the higher number
and is done later, by the way between them and the service. So no route closes into a cycle of its own,
and completion times are there to be weighed.

Sets        robots r; victims v, j; kinds k; places i: the victims, or ∅, the robot's start
Data        d_rij   travel of robot r from place i to victim j, in time units
            b_rv    travel of robot r from victim v back to its start, 0 if it need not return
            s_vk    service time of kind k at victim v, in time units
            h_v     priority of victim v
            g_rvk   1 if r can reach v and serve kind k there, else 0
            g_rij   1 if r can serve something at j ≠ i, and at i if that is a victim, else 0
            m_r     number of victims that r can visit, or 1 if there are none
            D_r     longest travel of robot r, in time units
            E_r     longest time that robot r may be busy, in time units
Parameters  w, w', w'' in [0, 1], the importance of total time, makespan and latency
Variables   x_rij in {0, g_rij}: robot r goes from place i to victim j
            y_rv in {0, 1}: robot r visits victim v
            a_rvk in {0, g_rvk}: robot r serves kind k at victim v
            p_rv ≥ 0: number of victim v on the route of robot r
            c_rv ≥ 0: when robot r is done with victim v, in time units
            C_v ≥ 0: when the last of its robots is done with victim v, in time units
            T: the makespan

    min   w Σ_r B_r + w' T + w'' Σ_v h_v C_v
    s.t.  Σ_r a_rvk = max_r g_rvk   for all v, k      each requirement is served exactly once
          a_rvk ≤ y_rv              for all r, v, k   robots serve where they are
          y_rv ≤ Σ_k a_rvk          for all r, v      … and visit nobody for nothing
          Σ_i x_rij = y_rj          for all r, j      a visit has one way in
          Σ_j x_rvj ≤ y_rv          for all r, v      … and at most one way on
          Σ_j x_r∅j ≤ 1             for all r         a robot leaves its start at most once
          p_rv − p_rj + m_r x_rvj + (m_r − 2) x_rjv ≤ m_r − 1   for all r, v, j
              of two visits in a row the second has the next number
          c_rj ≥ S_rj + Σ_i d_rij x_rij   for all r, j   a robot is done after way and service
          c_rj ≥ c_rv + S_rj + d_rvj x_rvj − E_r (1 − x_rvj)   for all r, v, j
              … and after the visit before
          C_v ≥ c_rv                for all r, v      a victim is done when its last robot is
          B_r ≤ T                   for all r         no robot is done after the makespan
          W_r ≤ D_r                 for all r         no robot travels for longer than it may
          B_r ≤ E_r                 for all r         … or is busy for longer
    with  W_r = Σ_i Σ_j d_rij x_rij + Σ_v b_rv (y_rv − Σ_j x_rvj), the travel of robot r: where there
                is no way on, its way back begins
          S_rv = Σ_k s_vk a_rvk, its service at victim v
          B_r = W_r + Σ_v S_rv, when it is done

Why p       Times alone would let victims on one cell, served in no time, close into a cycle.
No limits   D_r and E_r are then what the longest of routes could take.
Size        N M (M + L + 4) + M + 1 variables, M (L + N (2 M + L + 5)) + 4 N rows, for L kinds.
            NP-hard: one robot that serves everything is a travelling salesman. The relaxation is
            strong for total time, weaker for makespan, and weak for latency.
Source      Miller, Tucker and Zemlin (1960), "Integer programming formulation of traveling salesman
            problems", the rows of p lifted as by Desrochers and Laporte (1991). All decisions of
            Osooli et al. (2023), Algorithm 1, at once.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec
from msmrta_opt.routing.problem import RoutingData

SPEC = Spec(
    stage="routing",
    title="The joint problem by places and times: total time, makespan, latency, or between them",
    parameters={
        "w_total": Parameter(0.0, 1.0, 1.0, "importance of the total time"),
        "w_makespan": Parameter(0.0, 1.0, 0.0, "importance of the makespan"),
        "w_latency": Parameter(0.0, 1.0, 0.0, "importance of the latency"),
    },
    assumes="the robots' limits leave room for a plan that serves everything",
)


def build(data: RoutingData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, i, j), ``y`` (r, v), ``a`` (r, v, k)."""
    w_total = cp.Parameter(nonneg=True, name="w_total")
    w_makespan = cp.Parameter(nonneg=True, name="w_makespan")
    w_latency = cp.Parameter(nonneg=True, name="w_latency")
    n_victims = data.n_victims
    x = cp.Variable(data.can_go.shape, boolean=True, bounds=[0, data.can_go], name="x")
    y = cp.Variable(data.can_visit.shape, boolean=True, name="y")
    a = cp.Variable(data.able.shape, boolean=True, bounds=[0, data.able], name="a")
    place = cp.Variable(y.shape, bounds=[0, None], name="place")
    done = cp.Variable(y.shape, bounds=[0, None], name="done")
    completion = cp.Variable(n_victims, bounds=[0, None], name="completion")
    makespan = cp.Variable(name="makespan")

    between = x[:, :n_victims, :]
    onward = cp.sum(between, axis=2)
    walked = cp.sum(cp.multiply(data.travel, x), axis=(1, 2))
    walked += cp.sum(cp.multiply(data.back, y - onward), axis=1)
    served = cp.sum(cp.multiply(data.service[None], a), axis=2)
    busy = walked + cp.sum(served, axis=1)
    way_in = cp.sum(cp.multiply(data.travel, x), axis=1)
    visits = data.maximum_visits[:, None, None]
    longest = data.maximum_busy[:, None, None]
    numbers = place[:, :, None] - place[:, None, :] + cp.multiply(visits, between)
    numbers += cp.multiply(visits - 2, cp.transpose(between, axes=(0, 2, 1)))
    soonest = done[:, :, None] + served[:, None, :] - longest
    soonest += cp.multiply(data.between + longest, between)
    return cp.Problem(
        cp.Minimize(
            w_total * cp.sum(busy)
            + w_makespan * makespan
            + w_latency * (data.priority @ completion)
        ),
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
            (numbers <= visits - 1).set_label(
                "robot {r} numbers its visits if it goes from victim {v} to victim {j}"
            ),
            (done >= served + way_in).set_label(
                "robot {r} is done with victim {j} after its way there"
            ),
            (done[:, None, :] >= soonest).set_label(
                "robot {r} is done with victim {v} before victim {j} if it goes from there to here"
            ),
            (completion[None, :] >= done).set_label("robot {r} is done with victim {v} by its end"),
            (busy <= makespan).set_label("robot {r} is done by the makespan"),
            (walked <= data.maximum_travel).set_label("robot {r} travels no longer than it may"),
            (busy <= data.maximum_busy).set_label("robot {r} is busy no longer than it may"),
        ],
    )
