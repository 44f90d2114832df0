"""Total time and makespan: the edge formulation, its cutting planes, and the search tree."""
