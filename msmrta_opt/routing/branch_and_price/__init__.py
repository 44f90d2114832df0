"""Latency: a master program over routes, the pricing problem, and branching."""
