"""The summands of an objective as the modeller wrote them, and what each is worth at a point."""

from __future__ import annotations

from collections.abc import Callable

from ..arrays import Floats
from ..optimise.subject import Subject, shortened

Summands = Callable[[Floats], list[tuple[str, float]]]


def summands(asked: Subject) -> Summands | None:
    """The summands of the objective by their text, or label, at a point of ``(n_columns,)``.

    ``None`` if there is no expression behind the program, or it is no sum.
    """
    problem = asked.problem
    if problem is None:
        return None
    from cvxpy.atoms.affine.add_expr import AddExpression

    expression = problem.objective.expr
    if not isinstance(expression, AddExpression):
        return None

    def at(x: Floats) -> list[tuple[str, float]]:
        if asked.compiled is not None:
            asked.compiled.program(**asked.parameters)  # sets the parameters' values
        values = asked.program.shaped(x)
        for variable in problem.variables():
            variable.save_value(values[variable.name()])
        return [(shortened(_text(part)), float(part.value)) for part in expression.args]

    def _text(part: object) -> str:
        return part.format_labeled() if hasattr(part, "format_labeled") else str(part)

    return at
