"""Formulations and programs: from a file of ``models/`` and data to a checked solution.

Reading order:

- `formulation`, `axes`, `data`, `mission_data`: the contract of a model file, and what it is given.
- `documentation`: the fields of that data for people.
- `registry`: the model files, found by name; `new_models` writes more, of which
  `blank` has the smallest.
- `compile`: a formulation on data as a `program`, all in arrays, named in ids.
- `structure`, `assignment`: what the matrix proves, and what that spares.
- `solve`, `by_structure`, `solvers`, `solution`: solving, as the matrix decides or by name.
- `check`, `verify`, `settle`, `contradiction`: checking, and what is believed of a solver.
- `ray`: why a program is unbounded. `export`: programs as files. `subject`: whatever a question is
  about, as a program.
- `parametric`, `frontier`: all values of a weight at once, and what no weight reaches.
"""
