"""What planners share.

`planner`: what a planner is, and its clock. `record`: from its working data to a plan. `baseline`: all
but the allocation of those that only allocate; `lowest_bids`, of auctions. `first_routes`: where the
exact planner begins; `recorder`: how it goes on. `improvement`: local search on anybody's plan.
`notes`: what a reader of a plan should know. `mip_start` and `explicit_model`: a plan, and its problem,
as an explicit program. `plan_proof`: the proof that no plan is better.
"""
