"""Studies and comparisons: many runs, each in a process of its own, as one engine.

To be read in this order. What is asked for: `specification` (the study file), `missions` (on what),
`tasks` and `executing` (what a run does), `runs` (every combination, keyed by what determines its
result). Doing it: `perform` (one run, to its `record`), `runner` (all of them, here), `cluster` (or on a
Dask cluster), `preload` (what their processes share), `ledger` (what is kept). `comparison` is
formulations × solvers without a ledger, `solves` its rows, `comparison_table` its pandas table,
`proving` holds it against proofs; `solver_comparison` is one program on many solvers. `study` is all of
a study in Python, `baselines` all of solver regression, `pytest_plugin` its fixture. What records say is
in `analysis`, a study's page in `report`.
"""
