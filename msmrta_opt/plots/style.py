"""What stands for what in every picture: colours, line styles, hatches and marker shapes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from matplotlib.colors import to_rgb

from ..mission.instance import Instance
from ..mission.plan import Plan, Reason

PALETTE = (
    # Okabe and Ito (2008), without black, which walls and text have, and yellow, pale on white
    "#0072B2",  # blue
    "#D55E00",  # vermilion
    "#009E73",  # bluish green
    "#CC79A7",  # reddish purple
    "#E69F00",  # orange
    "#56B4E9",  # sky blue
    # Tol (2021), "muted" and "dark": apart from the six above under every colour-vision deficiency
    "#882255",  # wine
    "#332288",  # indigo
    "#DDCC77",  # sand
    "#661100",  # brown
)
LINES = ("-", (0, (4, 1.2)), (0, (1.2, 1.2)), (0, (5, 1, 1, 1)))
HATCHES = ("", "/////", "xxxxx", ".....")

WALL = "#4A4A4A"
INK = "#202020"
FAINT = "#8A8A8A"
NOBODY = "#9A9A9A"
SIGHT = "#F5A623"
FOUND = "#202020"
MISSED = "#C1121F"

STAGES = {
    "B2": "B2: cluster assignment",
    "B3": "B3: victim assignment",
    "B4": "B4: auction",
}
"""The stages of the paper's Algorithm 1 that assign, and what a legend says of them."""
SHAPES = ("o", "s", "^", "D", "h", "v", "p", "8", "<", ">", "d", "H")
REASONS = {
    Reason.NO_ROBOT_HAS_IT: "x",
    Reason.NO_CAPABLE_ROBOT_REACHES_IT: "+",
    Reason.NOT_FOUND: "$?$",
    Reason.BEYOND_ENDURANCE: "$!$",
    Reason.BEYOND_LONGEST_WALK: "$w$",
    Reason.BEYOND_BOTH: "$!w$",
}
"""The mark of an unserved requirement, by reason."""


@dataclass(frozen=True)
class RobotStyle:
    """How one robot is drawn; colour alone tells ten apart, lines and hatches tell the others."""

    colour: str
    line: str | tuple[int, tuple[float, ...]]
    hatch: str

    @property
    def ink(self) -> str:
        """Black or white, whichever can be read on the robot's colour."""
        red, green, blue = to_rgb(self.colour)
        return "black" if 0.299 * red + 0.587 * green + 0.114 * blue > 0.5 else "white"


def robot_style(index: int) -> RobotStyle:
    """The style of the robot at position `index` of its instance."""
    cycle, position = divmod(index, len(PALETTE))
    return RobotStyle(PALETTE[position], LINES[cycle % len(LINES)], HATCHES[cycle % len(HATCHES)])


def robot_colour(index: int) -> str:
    """The colour of the robot at position `index` of its instance, the same in every picture.

    Colours are safe for colour-blind readers (Okabe and Ito 2008, Tol 2021) and repeat after ten;
    dashes, hatches and the robots' numbers tell repeats apart.
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
