"""Bounds on whole plans, proved again from the instance and what is stored with the plan.

`recheck` is the entry; `joint` works the problem out anew, `duality` multiplies prices for total time
and makespan, `pricing` finds the cheapest routes at prices for latency, `queues` bounds latency without
any. All of it is in exact numbers, without a solver, and shares no code with the planners.

`vipr` checks proofs of integer programs, from files that anybody may have written.
"""
