"""Proofs that a program's optimum is what a solver claims, for a checker that trusts nobody.

In reading order: `exact` (the program in exact numbers), `prove` (from a claim to a checked file),
`prover` (how a proof is looked for), `certificate` (writing it). A bound is derived from the dual
multipliers of a relaxation (`relaxation`, `multipliers`; `basis` where only exact ones will do,
`implied` for columns without bounds), at the leaves of a tree (`tree`, `branching`, `pseudo_costs`)
with cuts (`cutting_plane`; `separation` and `networks` choose sums of `numeric_rows`, `summed_rows` and
`rounding_choice` find the cuts of each, `rounding` derives them), and rounded up on the `grid` of the
objective. `derivation` is what derivations are made of.
"""
