"""Latency, by branch and price.

To read, in this order:

- `search`, the method on a page; `tree`, its nodes and their bound; `branching`;
- `tasks` and `duals`, how latency is decomposed by robots;
- `ng_network`, a robot's routes relaxed; `pricing`, the cheapest of them;
  `reduced_cost_fixing`, what cannot be part of a better solution;
- `path_program`, the program over paths; `master`, its relaxation; `breakpoints`, which make that
  better; `column_generation`, the loop of pricing and master; `route_selection`, its integer solutions;
- `enumeration`, all routes that matter; `root_proof`, what is stored of the root's bound.
"""
