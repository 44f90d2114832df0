"""One file per line of Algorithm 1: each stage is a function from data to data."""
