"""The stages of Algorithm 1: one file and one function from data to data for each of its lines.

To be read in the paper's order: `options`; `scouting` (how scouts walk in `walks`); `situation`, which
every stage after it looks at; `requirement_analysis`; `clustering` (by `k_means`, `random_swap`);
`cluster_assignment` (B2); `performance_analysis`; `victim_assignment` (B3); `robot_assignment` (B4);
`path_planning`. Beyond the paper: `joint_assignment` and `joint_routing`, the data of the programs that
decide at once what the stages decide one after the other. `data` gives the data of any of them.

A function has the name of its file, so it is not to be had from here, where that is the file's:
`algorithm` has them all.
"""
