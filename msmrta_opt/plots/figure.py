"""Figures that belong to the caller alone, and show themselves in a notebook."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

POINTS_PER_INCH = 72


class Picture(Figure):
    """A figure that pyplot does not keep, and that shows itself in a notebook."""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        # A title may be wider than its map: what is shown is what there is, not the figure.
        self.savefig(buffer, format="png", dpi=110, bbox_inches=cut_of(self))
        return buffer.getvalue()


class Page(Picture):
    """A picture of a size of its own, whose parts are placed in inches from its upper left."""

    def __init__(self, width: float, height: float) -> None:
        super().__init__(figsize=(width, height))

    def place(self, left: float, top: float, width: float, height: float) -> Axes:
        """Axes of `width` × `height` inches, ticks and titles outside."""
        across, down = self.get_size_inches()
        bottom = down - top - height
        return self.add_axes((left / across, bottom / down, width / across, height / down))

    def write(self, left: float, top: float, text: str, size: float, **style: Any) -> Text:
        """A line of text, its top at `top` inches."""
        across, down = self.get_size_inches()
        style = {"va": "top", "ha": "left", "fontsize": size, **style}
        return self.text(left / across, 1 - top / down, text, **style)


class PictureAxes(Axes):
    """Axes alone in a `Picture`, which show it in a notebook."""

    def _repr_png_(self) -> bytes | None:
        return self.figure._repr_png_() if isinstance(self.figure, Picture) else None


def cut_of(figure: Figure) -> str | None:
    """How a figure is cut when it is written: a page and parts of figures are as large as they are."""
    return None if isinstance(figure, Page) or figure.subfigs else "tight"


def own_axes(width: float, height: float) -> Axes:
    """Axes in a new figure of `width` × `height` inches."""
    figure = Picture(figsize=(width, height), layout="constrained")
    return figure.add_subplot(axes_class=PictureAxes)


def size_of(ax: Axes) -> tuple[float, float]:
    """Width and height of `ax` in points, as far as known before the layout."""
    box = ax.get_window_extent().transformed(ax.figure.dpi_scale_trans.inverted())
    return box.width * POINTS_PER_INCH, box.height * POINTS_PER_INCH
