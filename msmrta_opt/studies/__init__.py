"""Comparing formulations, solvers and planners, each run by itself."""
