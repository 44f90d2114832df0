"""What records of runs say."""
