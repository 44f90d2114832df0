"""The space of plans over ψ and β: a page to explore, and the same as a picture."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.transforms import offset_copy

from ...mission.files import write_text
from ...mission.metrics import METRICS, metrics_of
from ...plots.figure import POINTS_PER_INCH, Picture
from ...plots.lettering import as_written, width_of
from ...plots.style import INK, readable_on
from ...plots.titles import name_of
from .tradeoff_pictures import NAME, SMALL, numbers_of, short
from .tradeoff_results import Regions

ACROSS, UP = "makespan", "total_time"
COLOURS = colormaps["cividis"]
STOPS = 256
RADIUS, APART = 60.0, 16.0
"""Points: of a dot that is all of the square; from one to the next of dots at one place."""
FRAME_HEIGHT = 900
"""Pixels that the page takes in a notebook."""


@dataclass(frozen=True)
class Dot:
    """One plan: its number in `Regions.plans` from 1, its share of the square, its metrics by name."""

    number: int
    share: Fraction
    metrics: dict[str, float]
    unique: bool
    """Whether it is the only optimum everywhere inside its regions."""


class PlanSpace:
    """One dot a plan, its area its share of the ψ × β square, and the square beside it.

    In a notebook the page shows itself; `save` writes it as a file for any browser, or a picture;
    `plot` is the picture.

    Parameters
    ----------
    regions : Regions
        Of `tradeoff_regions`.
    """

    def __init__(self, regions: Regions) -> None:
        self.regions = regions
        self._number = numbers_of(regions)

    @cached_property
    def dots(self) -> list[Dot]:
        """The plans, in the order of their numbers."""
        named = [metric.name for metric in metrics_of("plans")]
        share: dict[int, Fraction] = {}
        several: set[int] = set()
        for region in self.regions.regions:
            number = self._number[region.plan.routes]
            (left, right), (low, high) = region.psi, region.beta
            share[number] = share.get(number, Fraction(0)) + (right - left) * (high - low)
            if not region.unique:
                several.add(number)
        return [
            Dot(
                number,
                share[number],
                {name: float(getattr(plan.metrics, name)) for name in named},
                number not in several,
            )
            for number, plan in enumerate(self.regions.plans, start=1)
        ]

    @property
    def sentence(self) -> str:
        """Which plan has the largest share, and which the best by the two metrics of the axes."""
        dots = self.dots
        if len(dots) == 1:
            return "Neither ψ nor β has an effect on this mission: one plan for all."
        said = [f"Plan {(top := max(dots, key=lambda dot: dot.share)).number} holds the largest part"
                f" of the square, {100 * float(top.share):.3g} % of it."]  # fmt: skip
        for name in (ACROSS, UP):
            best = min(dots, key=lambda dot: dot.metrics[name])
            last = max(dots, key=lambda dot: dot.metrics[name])
            if best.metrics[name] == last.metrics[name]:
                said.append(f"All have the {METRICS[name].label} {best.metrics[name]:.6g}.")
                continue
            alike = [dot for dot in dots if dot.metrics[name] == best.metrics[name]]
            who = ", ".join(str(dot.number) for dot in alike)
            said.append(
                f"The smallest {METRICS[name].label} is {best.metrics[name]:.6g}, by plan"
                f"{'s' if len(alike) > 1 else ''} {who}; the largest {last.metrics[name]:.6g}."
            )
        return " ".join(said)

    def document(self) -> dict[str, Any]:
        """What the page draws: plans with shares and metrics, regions with their ends."""
        plans = self.regions.plans
        return {
            "mission": name_of(plans[0].instance),
            "axes": [ACROSS, UP],
            "names": {"psi": NAME["psi"], "beta": NAME["beta"]},
            "metrics": {
                metric.name: {"title": metric.title, "better": metric.better}
                for metric in metrics_of("plans")
            },
            "plans": [
                {
                    "number": dot.number,
                    "share": float(dot.share),
                    "unique": dot.unique,
                    "metrics": {n: METRICS[n].scaled(x) for n, x in dot.metrics.items()},
                    "robots": _robots(plan),
                }
                for dot, plan in zip(self.dots, plans, strict=True)
            ],
            "regions": [
                {
                    "plan": self._number[region.plan.routes],
                    "psi": [float(x) for x in region.psi],
                    "beta": [float(x) for x in region.beta],
                    "text": [f"{short(a)} to {short(b)}" for a, b in (region.psi, region.beta)],
                    "unique": region.unique,
                }
                for region in self.regions.regions
            ],
            "colours": [to_hex(c) for c in COLOURS(np.linspace(0, 1, STOPS))],
        }

    @cached_property
    def page(self) -> str:
        """The page as HTML, whole: it loads nothing."""
        place = files(__package__)
        script = place.joinpath("plan_space.js").read_text(encoding="utf-8")
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        document = self.document()
        # In a script's data only "<" could end it; JSON may write it in other letters.
        data = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
        parts = {
            "TITLE": html.escape(f"{document['mission']}: plans over ψ and β"),
            "SAID": html.escape(self.sentence),
            "DIGEST": digest,
            "DATA": data.replace("<", "\\u003c"),
            "SCRIPT": script,
        }
        page = place.joinpath("plan_space.html").read_text(encoding="utf-8")
        # In one pass: what is put in a place is not searched again.
        return re.sub(r"\{\{(\w+)\}\}", lambda place: parts[place[1]], page)

    @as_written
    def plot(self) -> Figure:
        """The dots, and the square in the same colours and numbers."""
        figure = Picture(figsize=(10.5, 4.9), layout="constrained")
        space, square = figure.subplots(1, 2, width_ratios=(1.25, 1))
        colour = _colours(self.dots)
        _draw_space(space, self.dots, colour)
        for region in self.regions.regions:
            number = self._number[region.plan.routes]
            _draw_region(square, region.psi, region.beta, colour[number - 1], str(number))
        square.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
        square.set_xlabel("ψ", fontsize=SMALL)
        square.set_ylabel("β", fontsize=SMALL)
        square.tick_params(labelsize=SMALL)
        square.set_title("Where each plan is optimal", fontsize=10)
        figure.suptitle(
            f"{name_of(self.regions.plans[0].instance)}: {len(self.dots)} plans over ψ and β",
            fontsize=11,
        )
        return figure

    def save(self, path: str | Path) -> None:
        """Write the page to `path`, or the picture if its suffix is that of one.

        Raises
        ------
        InputError
            If the suffix is none of ``.html`` and the pictures' formats, or it cannot be written.
        """
        if Path(path).suffix.lower() in (".html", ".htm"):
            write_text(path, self.page)
        else:
            from ...plots.saving import save_figure

            save_figure(self.plot(), path)

    def __repr__(self) -> str:
        return f"PlanSpace({len(self.dots)} plans, {len(self.regions.regions)} regions)"

    def _repr_html_(self) -> str:
        page = html.escape(self.page, quote=True)
        return (
            f'<iframe srcdoc="{page}" title="Plans over ψ and β" sandbox="allow-scripts" '
            f'style="width:100%;height:{FRAME_HEIGHT}px;border:0"></iframe>'
        )


def _robots(plan: Any) -> list[str]:
    """What each robot does, in a line: the victims that it visits, in order."""
    return [
        f"R{route.robot}: " + (" → ".join(f"v{visit.victim}" for visit in route.visits) or "stays")
        for route in plan.routes
    ]


def _colours(dots: Sequence[Dot]) -> list[tuple[float, ...]]:
    """A colour for each, from dark to bright in the order of the two metrics: no two are alike."""
    order = sorted(dots, key=lambda dot: (dot.metrics[ACROSS], dot.metrics[UP], dot.number))
    place = {dot.number: rank / max(len(dots) - 1, 1) for rank, dot in enumerate(order)}
    return [tuple(COLOURS(place[dot.number])) for dot in dots]


def _shifts(dots: Sequence[Dot]) -> list[float]:
    """Points to the right by which each is moved, so that those at one place stand side by side."""
    places = [(dot.metrics[ACROSS], dot.metrics[UP]) for dot in dots]
    return [
        APART * (places[:i].count(place) - (places.count(place) - 1) / 2)
        for i, place in enumerate(places)
    ]


def _draw_space(ax: Axes, dots: Sequence[Dot], colour: Sequence[tuple[float, ...]]) -> None:
    ax.set_xlabel(METRICS[ACROSS].title, fontsize=SMALL)
    ax.set_ylabel(METRICS[UP].title, fontsize=SMALL)
    ax.tick_params(labelsize=SMALL)
    ax.grid(alpha=0.3)
    ax.margins(0.28)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title("One dot a plan, its area its share of the square", fontsize=10)
    # The larger first, so that the smaller lie on them.
    order = sorted(range(len(dots)), key=lambda i: -dots[i].share)
    moved = _shifts(dots)
    for i in order:
        at = [dots[i].metrics[ACROSS]], [dots[i].metrics[UP]]
        area = (2 * RADIUS) ** 2 * float(dots[i].share)
        place = offset_copy(ax.transData, ax.get_figure(root=True), x=moved[i], units="points")
        ax.scatter(*at, s=area, color=[colour[i]], ec="white", lw=0.8, transform=place, zorder=3)
        ax.update_datalim(np.column_stack(at))
    inks = [readable_on(colour[i]) for i in order]
    _number_dots(ax, [dots[i] for i in order], [moved[i] for i in order], inks)


def _number_dots(
    ax: Axes, dots: Sequence[Dot], moved: Sequence[float], inks: Sequence[str]
) -> None:
    """A number in each dot, or beside one that is too small for it, where no other number is."""
    ax.autoscale_view()
    box = ax.get_window_extent()
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    dpi = POINTS_PER_INCH / ax.get_figure(root=True).dpi  # type: ignore[union-attr]
    across = [(dot.metrics[ACROSS] - left) / (right - left) * box.width * dpi for dot in dots]
    places = np.array(across) + moved
    heights = np.array([(dot.metrics[UP] - low) / (high - low) * box.height * dpi for dot in dots])
    radii = np.array([RADIUS * float(dot.share) ** 0.5 for dot in dots])
    taken: list[tuple[float, float, float]] = []
    for i, (dot, shift, ink) in enumerate(zip(dots, moved, inks, strict=True)):
        name, px, py, radius = str(dot.number), places[i], heights[i], radii[i]
        half = width_of(name, SMALL) / 2 + 1
        later = slice(i + 1, None)
        gaps = np.hypot(places[later] - px, heights[later] - py) - radii[later]
        inside = [(0.0, 0.0)] if radius > half + 3 and np.all(gaps > half + 1) else []
        for dx, dy in (*inside, (1, 0), (-1, 0), (0, 1), (0, -1), (0.75, 0.75), (-0.75, -0.75)):
            at = (px + dx * (radius + half + 2), py + dy * (radius + 7))
            if all(abs(at[0] - a) > half + h or abs(at[1] - b) > 11 for a, b, h in taken):
                taken.append((*at, half))
                ax.annotate(
                    name, (dot.metrics[ACROSS], dot.metrics[UP]), textcoords="offset points",
                    xytext=(shift + at[0] - px, at[1] - py), ha="center", va="center_baseline",
                    fontsize=SMALL, zorder=4,
                    color=INK if dx or dy else ink,
                    path_effects=[withStroke(linewidth=2.5, foreground="white")] if dx or dy else [],
                )  # fmt: skip
                break


def _draw_region(
    ax: Axes,
    psi: tuple[Fraction, Fraction],
    beta: tuple[Fraction, Fraction],
    colour: tuple[float, ...],
    text: str,
) -> None:
    from matplotlib.patches import Rectangle

    left, low = float(psi[0]), float(beta[0])
    width, height = float(psi[1] - psi[0]), float(beta[1] - beta[0])
    ax.add_patch(Rectangle((left, low), width, height, fc=colour, ec="white", lw=0.8))
    if width > 0.035 * len(text) + 0.015 and height > 0.04:
        ax.text(
            left + width / 2, low + height / 2, text, ha="center", va="center_baseline",
            fontsize=SMALL, color=readable_on(colour),
        )  # fmt: skip
