"""Eq. 1 and Eq. 2 in one program: posts and victims are chosen together, not one after the other.

A robot's post is the cluster that it takes. The staged method fixes the posts by Eq. 1 before Eq. 2
knows its times; but where a robot's way to a victim begins, and what is left to do there, depends on
the posts. Here both are chosen at once, for any weight λ of the one against the other.

Sets        robots r; clusters c; posts p: a cluster, or ∅ for none; victims v, each in its cluster
            c(v); holders h: the robot with the post c(v), or ∅ for nobody
Data        w_rc    requirements that robot r can serve in cluster c
            w^f_rc  those of victims that r can satisfy fully
            A_rpv   when robot r, done with post p, would be at victim v, in time units
            D_rp    failure time of robot r's record at post p, in time units
            B_rhv   service time of robot r for what holder h leaves of victim v, in time units
            E_rhv   failure time of robot r for what holder h leaves of victim v, in time units
            a_rhv   1 if r can reach v and serve something that h leaves there, else 0
            g_hv    1 if a_rhv = 1 for some r, else 0
Parameters  ψ in [0, 1], the importance of full over partial satisfaction
            β in [0, 1], the importance of failure time over success time
            λ in [0, 1], the importance of Eq. 2's time over Eq. 1's score
Variables   x_rc in {0, 1}: robot r takes cluster c; x_r∅ stands for 1 − Σ_c x_rc, none,
                            and x_∅c for 1 − Σ_r x_rc, nobody
            y_rv in {0, 1}: robot r takes victim v
            u_rpv in [0, 1]: r takes v, from post p
            z_rhv in [0, a_rhv]: r takes v, of which h leaves something
            T, W: the objectives of Eq. 2 and Eq. 1

    min   λ T − (1 − λ) W
    s.t.  Σ_r x_rc ≤ 1           for all c         a cluster has at most one robot
          Σ_c x_rc ≤ 1           for all r         a robot has at most one cluster
          Σ_r Σ_c x_rc = min(N, K)                 as many posts as can be
          u_rpv ≤ x_rp           for all r, p, v   robots leave from their own posts
          Σ_p u_rpv = y_rv       for all r, v      … and from one
          Σ_h z_rhv = y_rv       for all r, v      what a robot does is what some holder leaves
          Σ_r z_rhv = g_hv x_hc(v)   for all h, v  what the holder leaves has exactly one robot
          u_rc(v)v = z_rrv       for all r, v      who leaves from the post at v is its holder;
                                                   the others imply it, but not their relaxation
          T = Σ_r Σ_v {Σ_p [(1 − β) A_rpv + β D_rp] u_rpv + Σ_h [(1 − β) B_rhv + β E_rhv] z_rhv}
          W = Σ_r Σ_c [(1 − ψ) w_rc + ψ w^f_rc] x_rc

Why T, W    Parameters may not be multiplied with each other (DPP); with rows of their own, ψ and β
            stand in these and λ in the objective, and both objectives can be read off.
Staged      With x as Eq. 1 alone has it, the rest is `victim_covering` on the staged times: the joint
            optimum is never worse than the staged one, and the difference is what staging loses.
Size        N K + N M (N + K + 3) + 2 variables, N M (K + 4) + M (N + 1) + N + K + 3 rows. Only x and
            y need be integral: u and z then are.
Source      Osooli et al. (2023), Eqs. 1 and 2, as one; products linearised as by Adams and Sherali
            (1986), "A tight linearization and an algorithm for zero-one quadratic programming".
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, LAMBDA, PSI, JointAssignmentData, Spec

SPEC = Spec(
    stage="joint",
    title="Eqs. 1 and 2 as one: posts and victims chosen together",
    parameters={"psi": PSI, "beta": BETA, "lam": LAMBDA},
)


def build(data: JointAssignmentData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, c) and ``y`` over (r, v)."""
    psi = cp.Parameter(nonneg=True, name="psi")
    beta = cp.Parameter(nonneg=True, name="beta")
    lam = cp.Parameter(nonneg=True, name="lam")
    x = cp.Variable(data.w.shape, boolean=True, name="x")
    y = cp.Variable(data.can_serve[:, 0].shape, boolean=True, name="y")
    u = cp.Variable(data.arrival.shape, bounds=[0, 1], name="u")
    z = cp.Variable(data.service.shape, bounds=[0, data.can_serve], name="z")
    time, score = cp.Variable(name="time"), cp.Variable(name="score")

    post = cp.hstack([x, 1 - cp.sum(x, axis=1, keepdims=True)])
    held = x[:, data.cluster]
    holder = cp.vstack([held, 1 - cp.sum(held, axis=0, keepdims=True)])
    success = cp.sum(cp.multiply(data.arrival, u)) + cp.sum(cp.multiply(data.service, z))
    record = cp.sum(cp.multiply(data.record, cp.sum(u, axis=2)))
    failure = record + cp.sum(cp.multiply(data.redo, z))
    partial = cp.sum(cp.multiply(data.w, x))
    full = cp.sum(cp.multiply(data.w_full, x))
    return cp.Problem(
        cp.Minimize(lam * time - (1 - lam) * score),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),
            (cp.sum(x) == min(x.shape)).set_label("as many posts as can be"),
            (u <= post[:, :, None]).set_label(
                "robot {r} goes from post {p} to victim {v} only if posted there"
            ),
            (cp.sum(u, axis=1) == y).set_label("robot {r} goes to victim {v} from one post"),
            (cp.sum(z, axis=1) == y).set_label(
                "robot {r} does what some holder leaves of victim {v}"
            ),
            (cp.sum(z, axis=0) == cp.multiply(data.leaves, holder)).set_label(
                "what holder {h} leaves of victim {v} has one robot"
            ),
            (
                cp.sum(cp.multiply(data.own_post[None], u), axis=1)
                == cp.sum(cp.multiply(data.own_holder[:, :, None], z), axis=1)
            ).set_label("robot {r} leaves from the post at victim {v} only as its holder"),
            (time == (1 - beta) * success + beta * failure).set_label("the time of Eq. 2"),
            (score == (1 - psi) * partial + psi * full).set_label("the score of Eq. 1"),
        ],
    )
