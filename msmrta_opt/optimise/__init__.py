"""Formulations, solvers, and proofs of what they answer. Nothing heavy is imported until used."""
