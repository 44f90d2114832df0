"""Total time and makespan: branch and cut over the edge formulation.

Reading order: `search`, the method on one page. What it solves: `edge_variables`, `edge_formulation`,
and `points`, between its points and routes. Its root: `cutting_plane` with `separation` (of subtour
and path cuts) and `min_cut`; `root` and `reduced_cost_fixing`, what the root leaves to be done;
`root_proof`, how its bound is stored. Better routes: `incumbent_search`. Its tree: `tree`, by SCIP
(`scip_tree`, `connectivity`) or by HiGHS (`highs_tree`), with the rows of `symmetry`.
"""
