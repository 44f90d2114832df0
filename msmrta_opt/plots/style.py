"""What stands for what in every picture: colours, line styles, hatches and marker shapes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from matplotlib.colors import to_rgb

from ..mission.instance import Instance
from ..mission.plan import Plan, Reason

PALETTE = (
    # Okabe and Ito (2008); orange and sky blue darkened, so that all stand out from pale walls
    "#0072B2",  # blue
    "#D55E00",  # vermilion
    "#009E73",  # bluish green
    "#CC79A7",  # reddish purple
    "#C49000",  # gold
    "#45A6E0",  # sky blue
    # Tol (2021), "muted" and "dark", and a green
    "#882255",  # wine
    "#332288",  # indigo
    "#5A783C",  # moss
    "#661100",  # brown
)
Dashes = str | tuple[int, tuple[float, ...]]
LINES: tuple[Dashes, ...] = (
    *("-", "-", "-", "-"),
    (0, (4, 1.2)),
    (0, (1.3, 1.1)),
    (0, (7, 1.2, 1.3, 1.2)),
    (0, (2.4, 2)),
    (0, (10, 2)),
    (0, (4, 1.1, 1.2, 1.1, 1.2, 1.1)),
)
"""By place in the palette; those who repeat a colour have other dashes, see `robot_style`."""
MARKS = ("o", "s", "D", "^", "o", "s", "D", "p", "h", "P")
HATCHES = ("", "/////", "xxxxx", ".....")

WALL, WALL_EDGE = "#E2E5E9", "#9AA2AD"
INK = "#202020"
FAINT = "#666666"
NOBODY = "#767676"
FOUND = "#202020"
MISSED = "#C1121F"
"""Of what stays unserved or unfound, and of nothing else."""
NEVER_SEEN = "#A9A3CF"
DEFERRED = "#FFE98A"
TURNED_UP = "#FFB347"
"""Of victims that nobody knew of when a run began."""
FADED = "#B9BDC4"
"""Of what is the same in both of two plans."""
SERIES = ("#202020", "#6A4C93", "#8A5A00")
STEPS = ("#CFC4E3", "#A48FCB", "#7757A5", "#452673")
"""Colours of what is no robot: lines of a chart, and steps of one thing."""

STAGES = {
    "B2": "B2: cluster assignment",
    "B3": "B3: victim assignment",
    "B4": "B4: auction",
}
"""The stages of the paper's Algorithm 1 that assign, and what a legend says of them."""
SHAPES = ("o", "s", "^", "D", "h", "v", "p", "8", "<", ">", "d", "H")
REASONS = tuple(Reason)
"""Why something stays unserved, in the order of legends."""


@dataclass(frozen=True)
class RobotStyle:
    """How one robot is drawn: four by solid lines, the others by dashes; marks tell the four apart.

    So ten are told apart by dash and mark alone, without their colours.
    """

    colour: str
    line: Dashes
    mark: str
    hatch: str

    @property
    def ink(self) -> str:
        """Black or white, whichever can be read on the robot's colour."""
        return readable_on(self.colour)


def luminance(colour: Any) -> float:
    """Relative luminance, 0 (black) to 1 (white), as the WCAG 2 define it."""
    rgb = to_rgb(colour)
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in rgb]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: Any, other: Any) -> float:
    """Contrast of two colours, 1 to 21, as the WCAG 2 define it."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def readable_on(colour: Any) -> str:
    """Black or white, whichever has the larger contrast: never less than 4.58."""
    return max("black", "white", key=lambda ink: contrast(ink, colour))


@cache
def robot_style(index: int) -> RobotStyle:
    """The style of the robot at position `index` of its instance."""
    cycle, place = divmod(index, len(PALETTE))
    # Solid lines are for the first four alone; six dashes and ten colours repeat after thirty.
    line = LINES[4 + (place + 2 + 2 * cycle) % 6] if cycle or place >= 4 else "-"
    return RobotStyle(PALETTE[place], line, MARKS[place], HATCHES[cycle % len(HATCHES)])


def robot_colour(index: int) -> str:
    """The colour of the robot at position `index` of its instance, the same in every picture.

    Colours are chosen for colour-blind readers (after Okabe and Ito 2008 and Tol 2021) and repeat
    after ten; dashes, marks, hatches and the robots' numbers tell apart what colour does not.
    """
    return robot_style(index).colour


def line_styles(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """For each of those who are compared its colour, line and marker, as `Axes.plot` takes them."""
    found = {}
    for index, name in enumerate(names):
        look = robot_style(index)
        marker = SHAPES[index % len(SHAPES)]
        found[name] = {"color": look.colour, "linestyle": look.line, "marker": marker}
    return found


def robot_styles(instance: Instance) -> dict[int, RobotStyle]:
    """The style of each robot, by id."""
    return {robot.id: robot_style(index) for index, robot in enumerate(instance.robots)}


def stage_shapes(plan: Plan) -> dict[str, str]:
    """A marker per stage name of `plan`: the paper's stages keep theirs, others get the next."""
    present = dict.fromkeys(visit.stage for route in plan.routes for visit in route.visits)
    staged = tuple(STAGES) if any(name in STAGES for name in present) else ()
    names = [*staged, *(name for name in present if name not in STAGES)]
    return {name: SHAPES[i % len(SHAPES)] for i, name in enumerate(names) if name in present}
