"""Pictures of missions and plans, after the paper's Fig. 2: scouting, assignment, paths, and a Gantt.

Every ``plot_x(..., ax=None)`` draws into the axes it is given, or into a figure of its own, and
returns the axes; `plot_mission` composes them and returns the figure. Figures made here belong to
the caller alone: pyplot does not know them, no global setting changes, no display is needed. In a
notebook, what these functions return shows itself as the last value of a cell.

Panels: `scouting` and `coverage`, `assignment`, `paths`, `gantt`, and `mission` with all of them and a
`key`; `two_plans` beside each other, a `run`, as it was `walked`, beside its plan, with the `moments`
at which something came in between; `floor` is what a map was made of.
Charts: `convergence`, `workload`. On a map, a `canvas`, stand `marks` that `placing` keeps apart,
`walks` and `clusters`, or the `overview` of a large mission. What all share: `figure`, `legends`,
`titles`, `lettering` (any name as it is written), `style` (what stands for what), `saving`. Not a
picture but a page: `replay`.

A robot keeps its colour in every picture (`robot_colour`), and red means unserved or unfound. Names on
the pictures are short: R0 is the robot with id 0, S0 a scout, C0 a cluster; a disc holds a victim's id.
"""

from .assignment import plot_assignment
from .canvas import plot_map
from .convergence import plot_convergence
from .coverage import plot_coverage
from .floor import plot_floor
from .gantt import plot_gantt
from .mission import plot_mission
from .paths import plot_paths
from .replay import Replay, plot_replay
from .run import plot_run
from .saving import FORMATS, save_figure
from .scouting import plot_scouting
from .style import robot_colour
from .two_plans import plot_two_plans
from .workload import plot_workload

__all__ = [
    "FORMATS",
    "Replay",
    "plot_assignment",
    "plot_convergence",
    "plot_coverage",
    "plot_floor",
    "plot_gantt",
    "plot_map",
    "plot_mission",
    "plot_paths",
    "plot_replay",
    "plot_run",
    "plot_scouting",
    "plot_two_plans",
    "plot_workload",
    "robot_colour",
    "save_figure",
]
