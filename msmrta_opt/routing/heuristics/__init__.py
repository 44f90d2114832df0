"""Better routes without bounds: ruin and recreate, subsets of robots, regions of victims."""
