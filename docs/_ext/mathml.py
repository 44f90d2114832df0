"""Equations as MathML, which browsers draw themselves: no script, no font, no network.

docutils' own converter does the work; Sphinx is only told to use it.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml


def written(node: nodes.Node, *, block: bool) -> str:
    """The equation of a node as MathML.

    Raises
    ------
    ValueError
        If it has a command that the converter does not know, with the equation.
    """
    try:
        found = str(tex2mathml(node.astext(), as_block=block))
    except MathError as error:
        raise ValueError(f"{error}, in the equation {node.astext()!r}") from error
    # Brackets grow only where they are told to, and cells are set like equations on their own lines.
    found = re.sub(r"<mo>([][(){}|])</mo>", r'<mo stretchy="false">\1</mo>', found)
    return found.replace("<mtable", '<mtable displaystyle="true"')


def visit_inline(translator: Any, node: nodes.math) -> None:
    """Within a line."""
    translator.body.append(written(node, block=False))
    raise nodes.SkipNode


def visit_block(translator: Any, node: nodes.math_block) -> None:
    """On lines of its own; a wide one scrolls by itself."""
    equation = written(node, block=True)
    translator.body.append(
        f'<div class="equation" tabindex="0" role="group" aria-label="equation">{equation}</div>\n'
    )
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, Any]:
    """Tell Sphinx."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
