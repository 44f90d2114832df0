"""What is planned, and what a plan is; imports nothing else of ours.

`errors` (with `suggestions` of what was meant) and `files` first: what is raised, and how files are
read and written. Then `grid`, whose distances and walks are found by `search` (compiled in `a_star` and
`breadth_first`), `visibility` (what is in sight of a cell), `maps` (their files), `named_maps` (those
that come along), `layouts` (those that are made up). A floor in pixels (`occupancy`, `ros_map`) becomes
a grid by `coarsening`, and its `frame` is its place in the world; `map_files` reads all. `instance`,
whose `fields`, `map_field` and `positions` are read by `validation` and whose `mistakes` no schema
knows, the `shipped` ones as `examples`; `generate` draws one, `draft` makes one of `places`. A plan
is in `plan`, made of routes in `route` and, if it claims a bound, of what proves it in `proof` and
how a search came to it in `convergence`; `metrics` says how good it is,
`waypoints` are its poses and `plan_export` writes them for other programs;
`plan_tables` and `plan_difference` are a plan as tables and two beside each other, `display` is how they
show themselves, `counting` says how many of something there are. What may happen to a plan is a
`scenario`, what did happen a `run`, made of what is in `happened`, and `run_metrics` says what it came
to. `exact` says which fraction a number stands for, where figures are checked exactly.
"""
