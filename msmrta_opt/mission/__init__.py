"""What is planned, and what a plan is; imports nothing else of ours.

`errors` (with `suggestions` of what was meant) and `files` first: what is raised, and how files are
read and written. Then `grid`, whose distances and walks are found by `search` (compiled in
`breadth_first`), `visibility` (what is in sight of a cell), `maps` (their files), `named_maps` (those
that come along), `layouts` (those that are made up); `instance`, read by `validation`, the `shipped`
ones as `examples`, and `generate`, which draws one. A plan is in `plan`, made of routes in `route` and,
if it claims a bound, of what proves it in `proof`; `metrics` says how good it is, `plan_tables` and
`plan_difference` are a plan as tables and two beside each other, `display` is how they show themselves.
`exact` says which fraction a number stands for, where figures are checked exactly.
"""
