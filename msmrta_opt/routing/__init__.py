"""The joint problem: who serves what and in which order, over open routes; improved and bounded.

Reading order: `problem` (data, routes, what is wrong with them), `objectives` (the table of what to
minimise), `objective_step` and `combinatorial_bounds` (what follows at once), `stop`, `callbacks` and
`parameters` (what every search is given), `incumbent` (what every search keeps) and `bound` (what it
returns); then `methods`, which names the exact ones: `branch_and_cut` for total time and makespan,
`branch_and_price` for latency, both with `heuristics`. `proofs` proves what the
first of these claims. `run_highs` runs a solver within a stopping
criterion, and `second_solver` asks another one about a bound.
"""
