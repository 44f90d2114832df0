"""The stages of Algorithm 1: one file and one function from data to data for each of its lines.

A function has the name of its file, so it is not to be had from here, where that is the file's:
`msmrta_opt.stages.algorithm` has them all.
"""
