"""The marks on a map: victims with what they need, and badges of robots, none on another.

A victim is a disc with its number. Around it stands an arc for each requirement, at the hour of its
kind as on a clock, so that what is needed is seen without a word: in the colour of the robot that
serves it, red if none does. A red ring around all says that something stays unserved. What would lie
on another mark is moved aside, and a line leads to the cell it stands for.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection, PatchCollection
from matplotlib.patches import Wedge
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from ..mission.grid import Cell
from ..mission.instance import Instance, Victim
from ..mission.plan import Plan, Visit
from .canvas import Scale
from .placing import Box, apart
from .style import FADED, FAINT, INK, MISSED, TURNED_UP, RobotStyle, robot_styles

MAX_KINDS = 12
"""Kinds that have an hour each; of more, a victim's own requirements share its clock."""
LONGEST_NUMBER = 5
"""Digits of an id that a mark can hold; of a longer one the last are shown."""


@dataclass(frozen=True)
class Mark:
    """One badge: a word on a shape, or in a rounded box if it has none."""

    text: str
    face: str
    ink: str = "white"
    edge: str = INK
    shape: str = ""


@dataclass(frozen=True)
class Group:
    """What stands at one cell, side by side: perhaps a victim, and badges."""

    cell: Cell
    badges: tuple[Mark, ...] = ()
    disc: Mark | None = None
    arcs: tuple[tuple[float, float, str], ...] = ()
    """From, to (degrees, anticlockwise from the right) and colour."""
    ring: bool = False
    """Whether something stays unserved."""
    weight: float = 1.0
    """The disc's diameter over that of a victim of the lowest priority."""


def short_number(identity: int) -> str:
    """An id as the shape of a badge can hold it: colour stands alone for a longer one."""
    text = str(identity)
    return text if len(text) <= 3 else ""


def number_of(identity: int) -> str:
    """An id as a mark shows it."""
    text = str(identity)
    return text if len(text) <= LONGEST_NUMBER else f"…{text[1 - LONGEST_NUMBER :]}"


def start_of(cell: Cell, robot: int, style: RobotStyle) -> Group:
    """The start of a robot."""
    return Group(cell, (Mark(f"R{number_of(robot)}", style.colour, style.ink),))


def disc_of(victim: Victim, face: str = "white", ink: str = INK, edge: str = INK) -> Mark:
    """The disc of a victim, with its number."""
    return Mark(number_of(victim.id), face, ink, edge)


def weights_of(instance: Instance) -> dict[int, float]:
    """By victim the diameter of its disc, 1 to 1.4, by priority: 1 for all if they are alike."""
    priorities = [victim.priority for victim in instance.victims]
    low, high = min(priorities, default=1.0), max(priorities, default=1.0)
    span = high - low or 1.0
    return {v.id: 1 + 0.4 * (v.priority - low) / span for v in instance.victims}


def fades(visit: Visit, faded: Collection[tuple[int, str]]) -> bool:
    """Whether a visit is grey: all that it serves is among the requirements `faded`."""
    return bool(faded) and all((visit.victim, kind) in faded for kind in visit.served)


def served_groups(
    plan: Plan, faded: Collection[tuple[int, str]] = (), tinted: Collection[int] = ()
) -> list[Group]:
    """The victims with the arcs of what they need, by who serves it; requirements `faded` in grey.

    The discs of those `tinted` say that they turned up on the way.
    """
    styles = robot_styles(plan.instance)
    server = {
        (visit.victim, kind): FADED if (visit.victim, kind) in faded else styles[route.robot].colour
        for route in plan.routes
        for visit in route.visits
        for kind in visit.served
    }
    weights, rings = weights_of(plan.instance), unserved_victims(plan)
    return [
        Group(
            victim.cell,
            disc=disc_of(victim, face=TURNED_UP if victim.id in tinted else "white"),
            arcs=tuple(
                (*hours(plan.instance, victim, kind), server.get((victim.id, kind), MISSED))
                for kind in victim.requirements
            ),
            ring=victim.id in rings,
            weight=weights[victim.id],
        )
        for victim in plan.instance.victims
    ]


def unserved_victims(plan: Plan) -> set[int]:
    """The ids of the victims of whom something is served by no visit."""
    served = {(v.victim, kind) for r in plan.routes for v in r.visits for kind in v.served}
    return {
        victim.id
        for victim in plan.instance.victims
        if any((victim.id, kind) not in served for kind in victim.requirements)
    }


def hours(instance: Instance, victim: Victim, kind: str) -> tuple[float, float]:
    """Where the arc of a requirement begins and ends, in degrees anticlockwise from the right."""
    kinds = instance.capabilities
    if len(kinds) > MAX_KINDS:
        kinds = victim.requirements
    return hour(kinds.index(kind), len(kinds))


def hour(place: int, count: int) -> tuple[float, float]:
    """The `place`-th of `count` equal arcs, clockwise from the top."""
    width = 360 / count
    gap = min(8.0, width / 5) if count > 1 else 0.0
    return 90 - (place + 1) * width + gap / 2, 90 - place * width - gap / 2


def clock_marker(place: int, count: int) -> Path:
    """A marker for legends: a disc with the `place`-th of `count` arcs."""
    low, high = hour(place, count)
    arc = Wedge((0, 0), 1, low, high, width=0.45).get_path()
    disc = Path.unit_circle().transformed(Affine2D().scale(0.38))
    return Path.make_compound_path(arc, disc)


# Drawing


def draw_groups(
    ax: Axes, groups: Sequence[Group], shape: tuple[int, int], scale: Scale
) -> list[Box]:
    """Draw what stands at cells, none on another, with lines to the cells of those moved aside.

    Returns the boxes that they cover.
    """
    if not groups:
        return []
    sizes = np.array([_size(group, scale) for group in groups]) / scale.cell
    cells = np.array([group.cell for group in groups], dtype=float)
    centres = apart(cells, sizes, shape, scale.margin(shape))
    _draw_leaders(ax, cells, centres, scale)
    _draw_arcs(ax, groups, centres, scale)
    discs: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for group, (row, col), (_, width) in zip(groups, centres, sizes, strict=True):
        at = col - width / 2
        if group.disc is not None:
            own = _disc(group, scale) / scale.cell
            outer = _outer(group, scale) / scale.cell
            middle = at + outer / 2
            discs.setdefault((group.disc.face, group.disc.edge), []).append((middle, row, own))
            _write(ax, middle, row, group.disc.text, scale.font, group.disc.ink)
            at += outer
        for badge in group.badges:
            wide = _badge_width(badge, scale) / scale.cell
            _badge(ax, at + wide / 2, row, badge, scale)
            at += wide
    for (face, edge), found in discs.items():
        x, y, size = np.array(found).T
        ax.add_collection(
            EllipseCollection(
                size, size, 0 * size, units="xy", offsets=np.column_stack([x, y]),
                transOffset=ax.transData, facecolors=face, edgecolors=edge,
                linewidths=1.0, zorder=6,
            ),
            autolim=False,
        )  # fmt: skip
    return [(*place, *size) for place, size in zip(centres.tolist(), sizes.tolist(), strict=True)]


def _size(group: Group, scale: Scale) -> tuple[float, float]:
    """Height and width of a group in points."""
    widths = [_badge_width(badge, scale) for badge in group.badges]
    heights = [_badge_height(scale)] * len(widths)
    if group.disc is not None:
        widths.append(_outer(group, scale))
        heights.append(_outer(group, scale))
    return max(heights), sum(widths)


def _disc(group: Group, scale: Scale) -> float:
    """Diameter of the disc itself, in points: as wide as its number needs."""
    assert group.disc is not None
    letters = 0.68 * scale.font * len(group.disc.text) + 3
    return max(scale.mark * group.weight, letters)


def _outer(group: Group, scale: Scale) -> float:
    """Diameter with arcs and ring."""
    band = 2 * BAND if group.arcs else 1.0
    return _disc(group, scale) + band + (2 * RING if group.ring else 0)


BAND, RING = 4.2, 3.0
"""Points: of arcs, and of the ring around them."""


def _badge_height(scale: Scale) -> float:
    return 1.75 * scale.font


def _badge_width(badge: Mark, scale: Scale) -> float:
    letters = 0.72 * scale.font * len(badge.text)
    return max(letters + 5, _badge_height(scale)) if not badge.shape else 1.75 * scale.font


def _draw_leaders(ax: Axes, cells: np.ndarray, centres: np.ndarray, scale: Scale) -> None:
    moved = np.hypot(*(cells - centres).T) > max(3.0 / scale.cell, 0.3)
    lines = np.stack([cells, centres], axis=1)[moved][..., ::-1]
    if not len(lines):
        return
    for colour, width in (("white", 2.4), (FAINT, 0.9)):
        ax.add_collection(
            LineCollection(list(lines), colors=colour, linewidths=width, zorder=4.6), autolim=False
        )
    ax.plot(*lines[:, 0].T, "o", ms=3, mfc=INK, mec="white", mew=0.5, zorder=4.7)


def _draw_arcs(ax: Axes, groups: Sequence[Group], centres: np.ndarray, scale: Scale) -> None:
    arcs, colours, rings, backs = [], [], [], []
    for group, (row, col) in zip(groups, centres, strict=True):
        if group.disc is None:
            continue
        width = _size(group, scale)[1] / scale.cell
        outer = _outer(group, scale) / scale.cell
        middle = (col - width / 2 + outer / 2, row)
        inside = _disc(group, scale) / 2 / scale.cell
        band = BAND / scale.cell if group.arcs else 0.0
        backs.append(Wedge(middle, inside + band + 0.8 / scale.cell, 0, 360))
        for low, high, colour in group.arcs:
            # Rows grow downwards: an arc above the middle has a negative angle here.
            arcs.append(Wedge(middle, inside + band, -high, -low, width=band))
            colours.append(colour)
        if group.ring:
            radius = inside + band + RING / scale.cell
            rings.append(Wedge(middle, radius, 0, 360, width=0.66 * RING / scale.cell))
    for patches, faces, order in (
        (backs, "white", 5.0), (rings, MISSED, 5.1), (arcs, colours, 5.2),
    ):  # fmt: skip
        if patches:
            ax.add_collection(
                PatchCollection(patches, facecolors=faces, edgecolors="none", zorder=order),
                autolim=False,
            )


def _badge(ax: Axes, x: float, y: float, badge: Mark, scale: Scale) -> None:
    if badge.shape:
        size = scale.font * (1.55 if badge.shape not in "^v" else 1.8)
        (mark,) = ax.plot(
            [x], [y], badge.shape, ms=size, mfc=badge.face, mec=badge.edge, mew=0.6, zorder=6.5
        )
        mark.set_in_layout(False)
        lift = {"^": 0.13, "v": -0.13}.get(badge.shape, 0.0) * scale.font / scale.cell
        size = scale.font * (0.85 if len(badge.text) < 3 else 0.62)
        _write(ax, x, y + lift, badge.text, size, badge.ink)
        return
    text = ax.text(
        x, y, badge.text, ha="center", va="center_baseline", fontsize=scale.font,
        fontweight="bold", color=badge.ink, zorder=6.5,
        bbox={"boxstyle": "round,pad=0.2", "fc": badge.face, "ec": "white", "lw": 0.8},
    )  # fmt: skip
    text.set_in_layout(False)


def _write(ax: Axes, x: float, y: float, text: str, size: float, ink: str) -> None:
    ax.text(
        x, y, text, ha="center", va="center_baseline", fontsize=size, fontweight="bold",
        color=ink, zorder=7,
    ).set_in_layout(False)  # fmt: skip


def visit_badges(
    plan: Plan, shapes: Mapping[str, str], styles: Mapping[int, RobotStyle]
) -> dict[int, tuple[Mark, ...]]:
    """By victim a badge for each visit: the robot's colour and number, the stage's shape."""
    found: dict[int, list[Mark]] = {}
    for route in plan.routes:
        style = styles[route.robot]
        for visit in route.visits:
            badge = Mark(
                short_number(route.robot), style.colour, style.ink, INK, shapes[visit.stage]
            )
            found.setdefault(visit.victim, []).append(badge)
    return {victim: tuple(badges) for victim, badges in found.items()}
