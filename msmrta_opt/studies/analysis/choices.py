"""Who gets what by each formulation of a stage, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...mission.plan import Plan

Choices = Mapping[str, tuple[str, ...]]
"""By who decides or is decided on, what the formulation of a stage gives them, in ids."""
MARK = "*"
"""Behind what is not as in the first column."""


def choices(plan: Plan, stage: str) -> dict[str, tuple[str, ...]]:
    """What the formulation of `stage` has decided in `plan`.

    Of the stage ``cluster``: the clusters of each robot; of ``victim``: the victims of each robot in B3;
    of ``clustering``: who is in one cluster with each victim, whatever the clusters are called.
    """
    robots = [robot.id for robot in plan.known.robots]
    if stage == "cluster":
        return {
            f"robot {r}": tuple(f"C{c}" for c, item in enumerate(plan.clusters) if r in item.robots)
            for r in robots
        }
    if stage == "victim":
        return {
            f"robot {r}": tuple(
                f"v{visit.victim}" for visit in plan.route(r).visits if visit.stage == "B3"
            )
            for r in robots
        }
    return {
        f"victim {v}": tuple(f"v{other}" for other in item.victims if other != v)
        for item in plan.clusters
        for v in item.victims
    }


def side_by_side(made: Sequence[tuple[str, str, Choices]]) -> tuple[list[str], list[list[str]]]:
    """The columns and rows of a table: per instance and who, what each formulation gives them.

    `made` says of each instance and each formulation who gets what. What differs from the first
    formulation's is marked by `MARK`; a formulation without a plan has none.
    """
    models = list(dict.fromkeys(model for _, model, _ in made))
    rows = []
    for instance in dict.fromkeys(instance for instance, _, _ in made):
        own = {model: gets for where, model, gets in made if where == instance}
        for who in dict.fromkeys(
            name for gets in own.values() for name in sorted(gets, key=_order)
        ):
            texts = [_text(own.get(model, {}), who) for model in models]
            rows.append(
                [
                    *(instance, who),
                    *(text if text == texts[0] else f"{text} {MARK}" for text in texts),
                ]
            )
    return ["instance", "who", *models], rows


def _text(gets: Choices, who: str) -> str:
    if not gets:
        return "no plan"
    return ", ".join(sorted(gets.get(who, ()), key=_order)) or "nothing"


def _order(name: str) -> tuple[str, int]:
    """Names in the order of their ids."""
    digits = "".join(letter for letter in name if letter.isdigit())
    return name.rstrip("0123456789"), int(digits or 0)
