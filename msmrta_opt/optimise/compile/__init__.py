"""From a formulation and data to a `Program`, for any values of the formulation's parameters.

Reading order:

- `compiled`: what a formulation is on data, and what keeps it from being a linear integer program.
- `building`: the cvxpy problem of a file, or in a line what is wrong with the file.
- `canonical`: what reading a cvxpy problem gives.
- `affine`, with `coefficients`: the short way, for affine atoms. `fingerprint`: problems made alike.
- `reductions`: the long way, by cvxpy.
- `labels`: the names of rows and columns, in the ids of the data.
- `finite`, `contract`: what is refused before anything is solved; `bound_tightening` helps to show it.
"""

from .compiled import Compiled as Compiled
from .compiled import compile_for as compile_for
from .compiled import compile_formulation as compile_formulation
from .compiled import parameter_values as parameter_values
