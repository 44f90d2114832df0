"""Two plans beside each other: which visits moved, and what that did to the metrics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..public import load
from . import display
from .metrics import metrics_of
from .plan_tables import Planned

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

SERVED = ("robot", "stop", "departure")
"""What is said of who serves a requirement, in which place of its route, and when it is done."""
Served = tuple[int, int, float]
CHANGES = ("another robot", "another place", "another time", "no longer served", "newly served")
NOBODY = (None, None, None)


@dataclass(frozen=True)
class PlanDifference:
    """What `after` does otherwise than `before`.

    Robots and victims are compared by their ids; ``same_mission`` says whether both plans are for
    one mission, without which metrics compare little.
    """

    before: Planned
    after: Planned

    @property
    def same_mission(self) -> bool:
        """Whether both plans are for one mission, whatever it is called."""
        return self.before.is_for(self.after.instance)

    @property
    def moved(self) -> list[dict[str, Any]]:
        """A row for each victim and the kinds of it that move together.

        ``change`` is one of `CHANGES`, where a place is that in the same robot's route. Columns that end
        in ``before`` and ``after`` name the robot, its stop and the departure. By victim.
        """
        old, new = _served(self.before), _served(self.after)
        grouped: dict[tuple[int, Served | None, Served | None], list[str]] = {}
        for victim, kind in sorted({*old, *new}):
            was, is_ = old.get((victim, kind)), new.get((victim, kind))
            if was != is_:
                grouped.setdefault((victim, was, is_), []).append(kind)
        return [
            {
                "victim": victim,
                "requirements": ", ".join(kinds),
                "change": _change(was, is_),
                **{f"{name} before": x for name, x in zip(SERVED, was or NOBODY, strict=True)},
                **{f"{name} after": x for name, x in zip(SERVED, is_ or NOBODY, strict=True)},
            }
            for (victim, was, is_), kinds in grouped.items()
        ]

    @property
    def metrics(self) -> list[dict[str, Any]]:
        """A row for each metric of the table of a plan: before, after, and the difference."""
        return [
            {
                "metric": entry.title,
                "before": (was := entry.scaled(entry.of(self.before.metrics))),
                "after": (is_ := entry.scaled(entry.of(self.after.metrics))),
                "difference": is_ - was,
            }
            for entry in metrics_of("plan")
        ]

    @property
    def moved_requirements(self) -> list[tuple[int, str]]:
        """Victim's id and kind of what another robot serves, or only one of the plans."""
        old, new = _served(self.before), _served(self.after)
        stays = ("another place", "another time")
        return sorted(
            key
            for key in {*old, *new}
            if (was := old.get(key)) != (is_ := new.get(key)) and _change(was, is_) not in stays
        )

    def to_frame(self) -> pd.DataFrame:
        """`moved` as a table."""
        import pandas as pd

        columns = [f"{name} {when}" for when in ("before", "after") for name in SERVED]
        frame = pd.DataFrame(self.moved, columns=["victim", "requirements", "change", *columns])
        whole = [name for name in columns if not name.startswith("departure")]
        return frame.astype(dict.fromkeys(whole, "Int64"))

    def plot(self) -> Figure:
        """Both plans' paths beside each other, in colour what moved to another robot."""
        figure: Figure = load("plots").plot_two_plans(
            self.before, self.after, moved=self.moved_requirements
        )
        return figure

    @property
    def summary(self) -> str:
        """In a line: how much moved."""
        old, new = _served(self.before), _served(self.after)
        changes = Counter(
            _change(old.get(key), new.get(key))
            for key in {*old, *new}
            if old.get(key) != new.get(key)
        )
        if not changes:
            return "the plans serve the same alike"
        words = ", ".join(f"{name} {changes[name]}" for name in CHANGES if name in changes)
        return f"{display.counted(changes.total(), 'requirement')} moved: {words}"

    def __repr__(self) -> str:
        return f"PlanDifference({self.before.planner} → {self.after.planner}: {self.summary})"

    def _repr_html_(self) -> str:
        other = "" if self.same_mission else "The plans are for different missions."
        return display.page(
            f"{self.before.planner} → {self.after.planner}: {self.summary}",
            display.paragraph(other),
            display.table("Metrics", self.metrics),
            display.table("Visits that moved", self.moved),
        )


def _served(plan: Planned) -> dict[tuple[int, str], Served]:
    """Who serves each requirement, by victim and kind."""
    return dict(_services(plan))


def _services(plan: Planned) -> Iterator[tuple[tuple[int, str], Served]]:
    for route in plan.routes:
        for stop, visit in enumerate(route.visits, start=1):
            for kind in visit.served:
                yield (visit.victim, kind), (route.robot, stop, visit.departure)


def _change(was: Served | None, is_: Served | None) -> str:
    if is_ is None or was is None:
        return CHANGES[3 if is_ is None else 4]
    return next(name for name, a, b in zip(CHANGES, was, is_, strict=False) if a != b)
