"""Plans executed: what becomes of them in a world that does not hold still.

`draw` makes a world of a scenario and a seed; `simulation` lets the plan's robots act in it, event by
event, each a `body`, by the `knowledge` of the world that they share. `state` is what a policy is shown
and answers, and `deciding` makes the one and carries out the other; `policies` are one file each, with
what they share in `replanning`. `execute` puts all together, `many_runs` does so for many seeds, and
`distributions` says what these come to; `hindsight` is the best that a run could have been.
Scenarios and runs themselves are in `mission`, and `certify.run` checks runs.
"""
