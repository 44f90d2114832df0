"""Better routes without bounds.

Reading order: `ruin_and_recreate`, local search on whole plans, by `compiled_search` on the arrays of
`compiled_state` with the moves of `compiled_steps`; `robot_subsets` and `victim_regions`,
which choose what fix-and-optimise leaves free, for an exact method to solve.
"""
