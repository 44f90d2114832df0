"""What a page needs so that everybody can use it, and that Sphinx does not write by itself.

What scrolls by itself can be reached by keyboard; the empty corner of a table is no heading; parameters
of a long signature are a list. And the folder opens at its root.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

CHANGES = (
    (re.compile(r"<pre>"), '<pre tabindex="0">'),
    (re.compile(r'<table(?= class="(?:docutils|dataframe))'), '<table tabindex="0"'),
    (re.compile(r"<table(?= border)"), '<table tabindex="0"'),
    (re.compile(r'<div class="output text_html">'), '<div class="output text_html" tabindex="0">'),
    (re.compile(r'<th(?: class="head")?>(?:<p></p>)?</th>'), "<td></td>"),
    (re.compile(r'role="heading">'), 'role="heading" aria-level="2">'),
)
PARAMETERS = re.compile(r'<dl>\n((?:<dd><em class="sig-param">.*</dd>\n)+)</dl>')
"""A signature on several lines: definitions without anything that they define."""
FRONT = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="refresh" content="0; url={root}">
<title>{title}</title>
</head>
<body><p><a href="{root}">{title}</a></p></body>
</html>
"""


def change(app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """The body of a page, with `CHANGES`."""
    for old, new in CHANGES:
        context["body"] = old.sub(new, context.get("body", ""))
    context["body"] = PARAMETERS.sub(_listed, context.get("body", ""))


def _listed(found: re.Match[str]) -> str:
    items = found[1].replace("<dd>", "<li>").replace("</dd>", "</li>")
    return f'<ul class="parameters">\n{items}</ul>'


def front(app: Any, error: Exception | None) -> None:
    """A page at the root of the folder that leads to the first one."""
    if error is None and app.builder.name == "html":
        root = f"{app.config.root_doc}.html"
        text = FRONT.format(root=root, title=app.config.html_title)
        (Path(app.outdir) / "index.html").write_text(text, encoding="utf-8")


def setup(app: Any) -> dict[str, Any]:
    """Tell Sphinx."""
    app.connect("html-page-context", change)
    app.connect("build-finished", front)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
