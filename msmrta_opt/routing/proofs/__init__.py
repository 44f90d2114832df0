"""Proofs of joint plans, to the last branch.

Total time and makespan are proved by a tree over the edge formulation, latency by one over lists of
routes. In reading order: `statement`, the formulation with its cuts in exact numbers, as a certificate
states it; `reduction`, what the root relaxation's dual values exclude, so that the tree is over few
columns; `separating`, the relaxation that adds cuts as it goes; `prover`, from routes to a certificate.
How leaves are derived and certificates are written is `msmrta_opt.proofs`. `latency` is by itself.
"""
