"""What a program does, and why: explanations and differences, in the modeller's words and ids.

Reading order:

- `explain`: all that can be said of one program; the others are its parts.
- `conflict`, `repair`: why there is no solution, and what would have to give way.
- `fixings`, `why_not`, `terms`: why the solution is not another, and what that would cost.
- `forbidden`: what of the mission a bound comes from.
- `optimum`: why it is this one, and for which values of the parameters it stays.
- `numerics`: numbers that tolerances slip through.
- `difference`, `rows`: what differs between two programs. `watched`: what an edit has changed.
- `clock`, `signs`, `lists`: a time limit that steps share; how rows are told, and lists of them.
"""
