"""The stages of Algorithm 1: one file and one function from data to data for each of its lines."""
