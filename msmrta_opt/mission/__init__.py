"""What is planned: instances, grids, maps, plans and their metrics. Imports nothing else of ours."""
