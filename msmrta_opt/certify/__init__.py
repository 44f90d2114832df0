"""Independent checks of plans and of what is claimed about them, from the mission alone.

Nothing of the planners is imported, no solver and no scipy. To read, in this order:

- `plan` checks a plan; `scouting` and `clusters` check the reports that come with it, `same_mission`
  whether it is for the mission at hand, `availability` what no robot can serve;
- `run` checks a run of a plan, by `run_facts`, who was where and knew what: `run_world` what it met
  against the scenario, `run_orders` whether robots did what they were told, `run_events` what is told of
  it, `run_reasons` why robots wait, wander or leave out, `run_limits` whether they keep to those of the
  plan, `run_figures` what it came to;
- `cluster_weights` works out Eq. 1 again; `certificates` checks what its certificates claim, by
  `joint_problem`, the problem worked out again in exact numbers,
  `linear_relaxation`, what dual values prove about total time and makespan,
  `pricing_bound` with `ng_routes`, what they prove about latency,
  `scheduling_bound` with `assignment`, a bound on latency that needs none;
- `vipr` checks proofs of integer programs, from files that anybody may have written; `plan_proof` those
  of plans: `joint_proof`, that such a program is implied by the mission, and `latency_proof`, a tree
  over `route_lists`. What they come to is a `verdict`.
"""
