"""What records say, and what plans do when options change.

Of solves: `agreement` (contradictions), `regression` (against a baseline) with `regression_files` (for
other programs), `times` (shifted means, steps of the performance profile) and `profile` (its picture).
Of formulations: `score` (by the plans they make), `choices` (who gets what), `witness` (a mission that
tells two apart). Of programs: `matrix_picture` (what their structure proves) and `solution_picture`
(values, choice and duals). Of the staged planner: `staging` (what each stage costs) with
`staging_picture`, `tradeoff` (what ψ and β do) with its `tradeoff_results`, `tradeoff_pictures`,
`tradeoff_pages`, `explore` (sliders) and `plan_space` (all plans at once).
"""
