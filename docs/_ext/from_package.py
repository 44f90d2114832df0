"""Directives whose content is what the package declares: options, objectives, solvers, names, values.

Nothing on these tables is typed by hand, so that a page cannot say what the package does not do.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import json
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from textwrap import dedent
from typing import Any

from docutils import nodes
from docutils.statemachine import StringList
from numpydoc.docscrape import NumpyDocString
from sphinx.util.docutils import SphinxDirective

VALUES = Path(__file__).parents[1] / "certified_values.json"
NO_DEFAULT = "–"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """A table in Markdown."""
    lines = [f"| {' | '.join(head)} |", f"| {' | '.join('---' for _ in head)} |"]
    for row in rows:
        cells = (str(cell).replace("|", "\\|").replace("\n", " ") for cell in row)
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def described(function: Any) -> dict[str, tuple[str, str]]:
    """By parameter of a function its type and its meaning, from its docstring."""
    text = NumpyDocString(dedent(inspect.getdoc(function) or ""))
    return {
        name: (item.type, " ".join(item.desc))
        for item in text["Parameters"]
        for name in item.name.split(", ")
    }


def annotated(kind: type) -> dict[str, str]:
    """By field of a class the text beneath it, of the class and of those above it."""
    found: dict[str, str] = {}
    for of in reversed(kind.__mro__[:-1]):
        (body,) = ast.parse(dedent(inspect.getsource(of))).body
        for field, text in zip(body.body, body.body[1:], strict=False):  # type: ignore[attr-defined]
            if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr):
                found[ast.unparse(field.target)] = " ".join(ast.literal_eval(text.value).split())
    return found


def rst(text: str) -> str:
    """What is literal in reStructuredText as it is in Markdown."""
    return text.replace("``", "`")


def planner_options(name: str) -> list[list[str]]:
    """Option, meaning, default and choices, a row each, for the planner `name`.

    Raises
    ------
    LookupError
        If an option is explained nowhere.
    """
    from msmrta_opt.planners import planners
    from msmrta_opt.stages.options import CHOICES, PRESETS, StagedOptions

    planner = planners()[name]
    said = described(planner.run)
    staged = annotated(StagedOptions)
    rows = []
    for option, default in planner.options.items():
        kind, meaning = said.get(option, ("", staged.get(option, "")))
        choices = PRESETS if option == "preset" else CHOICES.get(option, ())
        if kind.startswith("{"):
            choices = tuple(ast.literal_eval(f"({kind.strip('{}')},)"))
        if option == "preset":
            meaning = meaning or "Which options to begin with; others change single ones."
        if not meaning:
            raise LookupError(f"nothing says what {option} of the planner {name} means")
        given = f"`{default}`" if default not in (None, "", ()) else NO_DEFAULT
        words = ", ".join(f"`{choice}`" for choice in choices)
        rows.append([f"`{option}`", rst(meaning), given, words])
    return rows


class FromPackage(SphinxDirective):
    """Markdown that is worked out, and read as if it stood in the page."""

    has_content = False

    def run(self) -> list[nodes.Node]:
        """The nodes of `lines`."""
        box = nodes.Element()
        self.state.nested_parse(StringList(self.lines(), self.env.docname), 0, box)
        return list(box.children)

    def lines(self) -> list[str]:
        """What stands in the page."""
        raise NotImplementedError


class PlannerOptions(FromPackage):
    """``{planner-options} NAME``: a row an option."""

    required_arguments = 1

    def lines(self) -> list[str]:
        """The table."""
        head = ("option", "meaning", "default", "choices")
        return table(head, planner_options(self.arguments[0]))


class Planners(FromPackage):
    """``{planners}``: a row a planner."""

    def lines(self) -> list[str]:
        """The table."""
        from msmrta_opt.planners import planners

        rows = [
            (
                f"`{planner.name}`",
                planner.title,
                "yes" if planner.heeds_objective else "no",
                ", ".join(f"`{limit}`" for limit in planner.limits) or "none",
            )
            for planner in planners().values()
        ]
        return table(("planner", "what it is", "minimises an objective", "limits it keeps"), rows)


class TuningParameters(FromPackage):
    """``{tuning-parameters} GROUP``: a row a tuning parameter."""

    required_arguments = 1

    def lines(self) -> list[str]:
        """The table."""
        from msmrta_opt.routing.parameters import Parameters

        group = getattr(Parameters(), self.arguments[0])
        said = annotated(type(group))
        rows = [
            (f"`{item.name}`", rst(said[item.name]), f"`{getattr(group, item.name)}`")
            for item in fields(group)
        ]
        return table(("parameter", "meaning", "default"), rows)


class Objectives(FromPackage):
    """``{objectives}``: a row an objective."""

    def lines(self) -> list[str]:
        """The table."""
        from msmrta_opt.mission.metrics import METRICS
        from msmrta_opt.routing.objectives import OBJECTIVES

        rows = [(f"`{name}`", METRICS[name].label, METRICS[name].unit or "") for name in OBJECTIVES]
        return table(("objective", "what is minimised", "unit"), rows)


class Metrics(FromPackage):
    """``{metrics}``: a row a metric."""

    def lines(self) -> list[str]:
        """The table."""
        from msmrta_opt.mission.metrics import METRICS

        rows = [(f"`{name}`", entry.label, entry.unit or "") for name, entry in METRICS.items()]
        return table(("metric", "what it is", "unit"), rows)


class Solvers(FromPackage):
    """``{solvers}``: a row a solver."""

    def lines(self) -> list[str]:
        """The table."""
        from msmrta_opt.optimise.solvers import solvers

        rows = [
            (f"`{solver.name}`", solver.title, f"`{solver.package}`" if solver.package else "")
            for solver in solvers().values()
        ]
        return table(("solver", "what it is", "package"), rows)


class Formulations(FromPackage):
    """``{formulations}``: a row a shipped formulation."""

    def lines(self) -> list[str]:
        """The table."""
        import msmrta_opt as mo

        rows = [
            (
                f"[`{item.name}`](../models/{item.name}.py)",
                item.formulation.spec.stage,
                item.formulation.spec.title,
            )
            for item in mo.models()
        ]
        return table(("formulation", "stage", "what it is"), rows)


class Fields(FromPackage):
    """``{fields} MODULE:CLASS``: what the class says of itself, and a row a field."""

    required_arguments = 1

    def lines(self) -> list[str]:
        """The docstring and the table."""
        module, _, name = self.arguments[0].partition(":")
        kind = getattr(importlib.import_module(f"msmrta_opt.{module}"), name)
        (body,) = ast.parse(dedent(inspect.getsource(kind))).body
        types = {
            ast.unparse(field.target): ast.unparse(field.annotation)
            for field in body.body  # type: ignore[attr-defined]
            if isinstance(field, ast.AnnAssign) and not ast.unparse(field.target).startswith("_")
        }
        said = annotated(kind)
        rows = [(f"`{name}`", rst(said.get(name, "")), f"`{of}`") for name, of in types.items()]
        head = ("field", "meaning", "type")
        if not any(meaning for _, meaning, _ in rows):  # all is said above the table
            rows, head = [(name, of) for name, _, of in rows], ("field", "type")  # type: ignore[misc, assignment]
        return [*rst(inspect.cleandoc(kind.__doc__ or "")).splitlines(), "", *table(head, rows)]


class CertifiedValues(FromPackage):
    """``{certified-values} OBJECTIVE``: a row an instance."""

    required_arguments = 1

    def lines(self) -> list[str]:
        """The table."""
        rows = []
        for row in json.loads(VALUES.read_text(encoding="utf-8")):
            if row["objective"] != self.arguments[0]:
                continue
            gap = row["value"] - row["bound"]
            share = f"{gap / row['value']:.2%}" if row["value"] else "0"
            rows.append(
                (
                    f"`{row['instance']}`",
                    f"{row['robots']}\u00a0×\u00a0{row['victims']}",
                    f"{row['value']:.6g}",
                    f"{row['bound']:.6g}",
                    "optimal" if row["status"] == "optimal" else f"gap {share}",
                    row["proof"],
                )
            )
        self.env.note_dependency(str(VALUES))
        return table(("instance", "size", "value", "bound", "status", "the bound's proof"), rows)


class PublicNames(FromPackage):
    """``{public-names} HOME …``: the public names that are at home in these folders, documented."""

    required_arguments = 1
    final_argument_whitespace = True

    def lines(self) -> list[str]:
        """A directive of autodoc for each."""
        found = []
        for name in names_of(self.arguments[0].split()):
            found += ["```{eval-rst}", *documented(name), "```", ""]
        return found


def names_of(homes: Iterable[str]) -> list[str]:
    """The public names whose modules are in `homes`, functions that are used first in front."""
    from msmrta_opt.public import HOME

    homes = tuple(homes)
    return [name for name, place in HOME.items() if place.partition(":")[0].split(".")[0] in homes]


def documented(name: str) -> list[str]:
    """What autodoc is asked for."""
    import msmrta_opt as mo

    value = getattr(mo, name)
    if not inspect.isclass(value):
        return [f".. autofunction:: msmrta_opt.{name}"]
    if issubclass(value, Exception):
        return [f".. autoexception:: msmrta_opt.{name}"]
    names = ", ".join(getattr(value, "model_fields", ()))  # without the types of validation
    return [
        f".. autoclass:: msmrta_opt.{name}" + (f"(*, {names})" if names else ""),
        "   :members:",
    ]


def setup(app: Any) -> dict[str, Any]:
    """Make the directives known.

    All of the package is loaded before: autodoc writes into the annotations of pydantic's base class,
    and a record that is defined later would be refused.
    """
    import msmrta_opt as mo

    for name in mo.__all__:
        getattr(mo, name)
    for kind in (
        PlannerOptions, Planners, TuningParameters, Objectives, Metrics, Solvers, Formulations,
        Fields, CertifiedValues, PublicNames,
    ):  # fmt: skip
        name = "".join(f"-{c.lower()}" if c.isupper() else c for c in kind.__name__).lstrip("-")
        app.add_directive(name, kind)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
