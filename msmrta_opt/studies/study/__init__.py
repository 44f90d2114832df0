"""Studies: planners or formulations × instances × options, resumable and parallel.

A study file says what to run; the ledger beside it keeps what came of each run; the report shows it.
"""
