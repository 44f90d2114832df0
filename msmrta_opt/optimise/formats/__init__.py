"""Programs as text, for any other solver.

Reading order: `written` (a program as files have it: names and numbers that every reader takes), `mps`
and `lp` (how each format is written), `draft` (a program as it is being read), `read_mps` and `read_lp`.
"""
