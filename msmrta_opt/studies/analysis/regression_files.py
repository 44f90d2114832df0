"""What became of solves, for other programs to read: JUnit's XML, and Markdown.

A continuous integration shows both: test reports take the XML (a test case a solve), summaries of jobs
and comments on changes take the Markdown.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

from ...mission.display import counted, short
from ..record import Record
from .regression import Change, Regression

_ALLOWED = "\t\n"
_SILENT = ("error", "skipped")


def junit(
    records: Sequence[Record], regression: Regression | None = None, wrong: Iterable[str] = ()
) -> str:
    """The solves as test cases of JUnit's XML.

    Parameters
    ----------
    records : sequence of Record
        A case each: skipped as its solver cannot do it, in error as it gave no solution, failed where
        its check does not pass.
    regression : Regression, optional
        Its changes are failures of their solves; notes are their output.
    wrong : iterable of str
        What is wrong of no one solve, such as a disagreement: a failed case each.
    """
    changed = _by_solve(regression.changes if regression else ())
    noted = _by_solve(regression.notes if regression else ())
    suite = ElementTree.Element("testsuite", name="msmrta compare")
    for record in records:
        case = _case(suite, record)
        problems = [change.what for change in changed.pop(record.solve, [])]
        if record.check not in (None, "", "passed"):
            problems.append(f"check: {record.check}")
        if problems:
            _add(case, "failure", problems)
        elif record.verdict in _SILENT:
            _add(case, "skipped" if record.verdict == "skipped" else "error", [record.reason])
        if notes := noted.get(record.solve):
            ElementTree.SubElement(case, "system-out").text = _clean(
                "\n".join(note.what for note in notes)
            )
    for missing in changed.values():
        case = ElementTree.SubElement(
            suite, "testcase", classname="baseline", name=_clean(missing[0].name)
        )
        _add(case, "failure", [change.what for change in missing])
    for line in wrong:
        case = ElementTree.SubElement(suite, "testcase", classname="agreement", name=_clean(line))
        _add(case, "failure", [line])
    for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(kind, str(len(suite.findall(f"testcase/{tag}"))))
    suite.set("tests", str(len(suite)))
    suite.set("time", f"{sum(record.seconds or 0.0 for record in records):.6f}")
    ElementTree.indent(suite, " ")
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def markdown(
    records: Sequence[Record], regression: Regression | None = None, wrong: Sequence[str] = ()
) -> str:
    """The solves as Markdown: what is wrong or changed first, then information, then a table."""
    parts = ["# Solver regression" if regression else "# Comparison of solvers", ""]
    changes = regression.lines if regression else []
    parts += [_verdict(records, regression, [*wrong, *changes]), ""]
    for title, lines in (
        ("Wrong", list(wrong)),
        ("Changed", changes),
        ("For information", regression.information if regression else []),
    ):
        if lines:
            parts += [f"## {title}", "", *(f"- {_escaped(line)}" for line in lines), ""]
    columns = ("instance", "model", "solver", "status", "objective", "bound", "ms")
    parts += ["## Solves", "", f"| {' | '.join(columns)} |", f"|{' --- |' * len(columns)}"]
    for record in records:
        milliseconds = None if record.seconds is None else round(record.seconds * 1e3, 1)
        cells = (
            *(record.instance, record.model, record.solver, record.verdict),
            *(record.objective, record.bound, milliseconds),
        )
        parts.append(f"| {' | '.join(_escaped(short(cell)) for cell in cells)} |")
    return "\n".join(parts) + "\n"


def _verdict(records: Sequence[Record], regression: Regression | None, bad: Sequence[str]) -> str:
    against = (
        f" against {counted(len(regression.before), 'row')} of the baseline" if regression else ""
    )
    what = "all is as it should be" if not bad else f"**{counted(len(bad), 'line')} to look at**"
    return f"{counted(len(records), 'solve')}{against}: {what}."


def _case(suite: ElementTree.Element, record: Record) -> ElementTree.Element:
    seed = "" if record.solver_seed is None else f", seed {record.solver_seed}"
    return ElementTree.SubElement(
        suite,
        "testcase",
        classname=_clean(f"{record.instance}.{record.model}"),
        name=_clean(f"{record.solver}{seed}"),
        time=f"{record.seconds or 0.0:.6f}",
    )


def _add(case: ElementTree.Element, tag: str, problems: Sequence[str]) -> None:
    element = ElementTree.SubElement(case, tag, message=_clean(problems[0]))
    element.text = _clean("\n".join(problems))


def _by_solve(changes: Iterable[Change]) -> dict[object, list[Change]]:
    found: dict[object, list[Change]] = {}
    for change in changes:
        found.setdefault(change.solve, []).append(change)
    return found


def _clean(text: str) -> str:
    """Without the characters that XML cannot hold."""
    return "".join(x if x.isprintable() or x in _ALLOWED else "?" for x in text)


def _escaped(text: str) -> str:
    for character in "\\|*_`<>[]":
        text = text.replace(character, f"\\{character}")
    return " ".join(text.split())
