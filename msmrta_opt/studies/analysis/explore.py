"""Sliders over a trade-off, and the map of the plan that they point to: `explore`.

A notebook that runs shows the sliders. Where nothing runs, as on a page, the same object is a film
strip: every plan that the parameters can give, once, with the interval in which it is the plan.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

from ...mission.errors import InputError
from ...mission.plan import Plan
from ...plots.figure import Picture, cut_of
from ...plots.lettering import as_written
from ...plots.paths import plot_paths
from .plan_space import PlanSpace
from .tradeoff_pictures import SYMBOL, numbers_of, plot_regions, short
from .tradeoff_results import Regions, Segment, Tradeoff

MAX_FRAMES = 12
"""Of a film strip; the rest is counted in its title."""
FRAME = (3.6, 4.1)
"""Width and height of a frame in inches."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A plan that a trade-off gives, and where."""

    title: str
    words: str
    plan: Plan


class Explorer:
    """The plans of a trade-off, by the values of its parameters.

    Parameters
    ----------
    result : Tradeoff or Regions
        Over one parameter, or over ψ and β.

    Raises
    ------
    InputError
        If `result` is neither, or has no piece.
    """

    def __init__(self, result: Tradeoff | Regions) -> None:
        if not isinstance(result, Tradeoff | Regions):
            raise InputError(
                f"{type(result).__name__}; give what `tradeoff` or `tradeoff_regions` returns",
                field="result",
            )
        if not (result.segments if isinstance(result, Tradeoff) else result.regions):
            raise InputError("it was interrupted before its first piece", field="result")
        self.result = result
        self.frames = tuple(_pieces(result) if isinstance(result, Tradeoff) else _plans(result))

    @property
    def parameters(self) -> dict[str, tuple[float, float]]:
        """By symbol the range of each parameter."""
        if isinstance(self.result, Regions):
            return {"ψ": (0.0, 1.0), "β": (0.0, 1.0)}
        over, (low, high) = self.result.over, self.result.span
        return {SYMBOL.get(over, over): (float(low), float(high))}

    def at(self, *values: float) -> Frame:
        """The frame where the parameters are `values`; where two meet, the one before.

        Raises
        ------
        InputError
            If there are too many or too few values, or one is outside its range.
        """
        ranges = self.parameters
        if len(values) != len(ranges):
            raise InputError(f"{len(values)} values; give one each of {', '.join(ranges)}")
        for value, (name, (low, high)) in zip(values, ranges.items(), strict=True):
            if not low <= value <= high:
                raise InputError(f"{value}; it lies in [{low:g}, {high:g}]", field=name)
        if isinstance(self.result, Tradeoff):
            return self.frames[self.result.segments.index(self.result.at(values[0]))]
        number = numbers_of(self.result)
        region = next(
            region
            for region in self.result.regions
            if region.psi[0] <= values[0] <= region.psi[1]
            and region.beta[0] <= values[1] <= region.beta[1]
        )
        return self.frames[number[region.plan.routes] - 1]

    @as_written
    def film(self) -> Picture:
        """The film strip: a map a frame, and of two parameters the square with the plans' numbers."""
        shown = self.frames[:MAX_FRAMES]
        square = isinstance(self.result, Regions)
        count = len(shown) + square
        columns = min(count, 4 if count != 5 else 3)
        rows = -(-count // columns)
        film = Picture(figsize=(columns * FRAME[0], rows * FRAME[1]), layout="constrained")
        places = film.subplots(rows, columns, squeeze=False).ravel()
        for ax in places[count:]:
            ax.remove()
        if isinstance(self.result, Regions):
            plot_regions(self.result, places[0], metric="makespan")
        for ax, frame in zip(places[square:count], shown, strict=True):
            plot_paths(frame.plan, ax, robot_key=False)
            if (legend := ax.get_legend()) is not None:
                legend.remove()
            ax.set_title(frame.title, fontsize=9)
            ax.set(xlabel="", ylabel="", xticks=[], yticks=[])
        if len(self.frames) > len(shown):
            film.suptitle(f"{len(shown)} of {len(self.frames)} plans", fontsize=10)
        return film

    @cached_property
    def space(self) -> PlanSpace:
        """All plans over ψ and β at once: one dot a plan, linked to the square; a page and a picture.

        Raises
        ------
        InputError
            If the trade-off is over one parameter alone.
        """
        if not isinstance(self.result, Regions):
            raise InputError(
                "is over one parameter; give what `tradeoff_regions` returns", field="result"
            )
        return PlanSpace(self.result)

    def save(self, path: str | Path) -> None:
        """Write `space` as a page (``.html``), or as a picture; see `PlanSpace.save`."""
        self.space.save(path)

    def controls(self) -> Any:
        """The sliders, the map and its words, as a widget.

        Raises
        ------
        ImportError
            Where ipywidgets is not installed.
        """
        import ipywidgets

        sliders = [
            ipywidgets.FloatSlider(min=low, max=high, step=(high - low) / 100, description=name)
            for name, (low, high) in self.parameters.items()
        ]
        words, image = ipywidgets.HTML(), ipywidgets.Image(format="png", width=480)
        number = {id(frame): n for n, frame in enumerate(self.frames)}
        picture = cache(lambda n: _png(plot_paths(self.frames[n].plan).figure))

        def move(_change: object = None) -> None:
            frame = self.at(*(slider.value for slider in sliders))
            image.value, words.value = picture(number[id(frame)]), frame.words

        for slider in sliders:
            slider.observe(move, "value")
        move()
        return ipywidgets.HBox([image, ipywidgets.VBox([*sliders, words])])

    def __repr__(self) -> str:
        return f"Explorer({len(self.frames)} plans over {', '.join(self.parameters)})"

    def _repr_mimebundle_(self, **_which: object) -> dict[str, Any]:
        """Sliders where a kernel runs and ipywidgets is there; the film strip for everywhere else."""
        shown: dict[str, Any] = {"text/plain": repr(self), "image/png": _png(self.film())}
        try:
            return dict(self.controls()._repr_mimebundle_()) | shown
        except ImportError:
            return shown


def explore(result: Tradeoff | Regions) -> Explorer:
    """Sliders over the parameters of a trade-off; see `Explorer`.

    Parameters
    ----------
    result : Tradeoff or Regions
        What `tradeoff` or `tradeoff_regions` returns.

    Returns
    -------
    Explorer
        Shows itself in a notebook: sliders and a map while it runs, a film strip where it does not.
    """
    return Explorer(result)


def _pieces(result: Tradeoff) -> list[Frame]:
    symbol, n = SYMBOL.get(result.over, result.over), len(result.segments)
    return [
        Frame(
            f"{symbol} from {short(segment.low)} to {short(segment.high)}\n{_ends(segment.plan)}",
            f"Piece {i} of {n}, {symbol} from {short(segment.low)} to {short(segment.high)}: "
            f"robots take {_takes(result, segment)}; {_ends(segment.plan)}.",
            segment.plan,
        )
        for i, segment in enumerate(result.segments, start=1)
    ]


def _plans(result: Regions) -> list[Frame]:
    return [
        Frame(f"plan {n}\n{_ends(plan)}", f"Plan {n}: {_ends(plan)}.", plan)
        for n, plan in enumerate(result.plans, start=1)
    ]


def _takes(result: Tradeoff, segment: Segment) -> str:
    return ", ".join(name or "nothing" for name in result.named(segment.assignment))


def _ends(plan: Plan) -> str:
    return f"{plan.metrics.distance} cells, makespan {plan.metrics.makespan:.6g}"


def _png(picture: Any) -> bytes:
    buffer = BytesIO()
    picture.savefig(buffer, format="png", dpi=100, bbox_inches=cut_of(picture))
    return buffer.getvalue()
