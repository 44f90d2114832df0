"""The page of a replay: its parts in one file."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Sequence
from functools import cache, cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...mission.errors import InputError
from ...mission.files import write_text
from ...mission.plan import Plan
from ...mission.run import Run
from ..titles import says
from .data import document
from .run_data import document_of_run

SCRIPTS = ("state.js", "draw.js", "timeline.js", "words.js", "page.js")
MAX_PLANS = 2
FRAME_HEIGHT = 760
"""Pixels that a replay takes in a notebook."""


class Replay:
    """A plan or a run, or two in step side by side, from scouting to the last robot's last service.

    In a notebook it shows itself; `save` writes it as a file for any browser, or as a film.

    Parameters
    ----------
    plans : sequence of Plan or Run
        One or two. A run has events, and what was decided on the way.
    labels : sequence of str, optional
        What each is called; by default who planned it, or the run's policy, behind A and B where there
        are two.

    Raises
    ------
    InputError
        If there are more plans, or a walk in one is none.
    """

    def __init__(self, plans: Sequence[Plan | Run], labels: Sequence[str] | None = None) -> None:
        self.plans = tuple(plans)
        if not 1 <= len(self.plans) <= MAX_PLANS:
            raise InputError(f"{len(self.plans)} plans; give one or two", field="plans")
        if labels is None:
            names = [says(plan) for plan in self.plans]
            labels = names if len(names) == 1 else [f"A: {names[0]}", f"B: {names[1]}"]
        self.labels = tuple(labels)
        self._data = [
            {"label": label, **_document(plan)}
            for label, plan in zip(self.labels, self.plans, strict=True)
        ]

    @cached_property
    def page(self) -> str:
        """The page as HTML, whole: it loads nothing."""
        # In a script's data only "<" could end it; JSON may write it in other letters.
        data = json.dumps(self._data, ensure_ascii=False, separators=(",", ":"))
        script = "\n".join(_part(name) for name in SCRIPTS)
        parts = {
            "TITLE": html.escape(self._title()),
            "STYLE": _part("replay.css"),
            "SCRIPT": f'"use strict";\n(() => {{\n{script}}})();\n',
            "DATA": data.replace("<", "\\u003c"),
        }
        return _filled(_part("replay.html"), parts)

    def save(self, path: str | Path) -> None:
        """Write the page to `path`, or a film if its suffix is that of one; whole or not at all.

        Raises
        ------
        InputError
            If the suffix is none of ``.html``, ``.gif`` and ``.mp4``, there is no ffmpeg to make an
            MP4, or the file cannot be written.
        """
        suffix = Path(path).suffix
        if suffix.lower() in (".html", ".htm"):
            write_text(path, self.page)
        elif suffix.lower() in (".gif", ".mp4"):
            from .film import save_film

            save_film(self.plans, self.labels, path)
        else:
            raise InputError(
                f"unknown format {suffix!r}; the suffix is one of .html, .gif, .mp4", file=path
            )

    def __repr__(self) -> str:
        return f"Replay({self._title()})"

    def _repr_html_(self) -> str:
        page = html.escape(self.page, quote=True)
        title = html.escape(f"Replay of {self._title()}", quote=True)
        return (
            f'<iframe srcdoc="{page}" title="{title}" sandbox="allow-scripts" '
            f'style="width:100%;height:{FRAME_HEIGHT}px;border:0"></iframe>'
        )

    def _title(self) -> str:
        names = dict.fromkeys(data["name"] for data in self._data)
        return f"{' and '.join(names)} · {' and '.join(self.labels)}"


def _document(plan: Plan | Run) -> dict[str, Any]:
    return document_of_run(plan) if isinstance(plan, Run) else document(plan)


def plot_replay(
    plan: Plan | Run, beside: Plan | Run | None = None, *, labels: Sequence[str] | None = None
) -> Replay:
    """A replay of `plan`, or of two in step side by side.

    Parameters
    ----------
    plan : Plan or Run
        Of any planner, or of any policy.
    beside : Plan or Run, optional
        Another, for the same mission or another one.
    labels : sequence of str, optional
        What each is called; by default who planned it, or the run's policy.

    Returns
    -------
    Replay
        A notebook shows it; its `save` writes a file for any browser, which needs no network.

    Raises
    ------
    InputError
        If a robot or a scout jumps.
    """
    return Replay([plan] if beside is None else [plan, beside], labels)


def _filled(template: str, parts: dict[str, str]) -> str:
    """The template with each part in its place; what is put there is not searched again."""
    places = re.compile(r"\{\{(\w+)\}\}")
    return places.sub(lambda place: parts[place[1]], template)


@cache
def _part(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
