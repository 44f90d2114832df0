"""Figures that belong to the caller alone, and show themselves in a notebook."""

from __future__ import annotations

from io import BytesIO

from matplotlib.axes import Axes
from matplotlib.figure import Figure

POINTS_PER_INCH = 72


class Picture(Figure):
    """A figure that pyplot does not keep, and that shows itself in a notebook."""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        # A title may be wider than its map: what is shown is what there is, not the page.
        self.savefig(buffer, format="png", dpi=110, bbox_inches="tight")
        return buffer.getvalue()


class PictureAxes(Axes):
    """Axes alone in a `Picture`, which show it in a notebook."""

    def _repr_png_(self) -> bytes | None:
        return self.figure._repr_png_() if isinstance(self.figure, Picture) else None


def own_axes(width: float, height: float) -> Axes:
    """Axes in a new figure of `width` × `height` inches."""
    figure = Picture(figsize=(width, height), layout="constrained")
    return figure.add_subplot(axes_class=PictureAxes)


def size_of(ax: Axes) -> tuple[float, float]:
    """Width and height of `ax` in points, as far as known before the layout."""
    box = ax.get_window_extent().transformed(ax.figure.dpi_scale_trans.inverted())
    return box.width * POINTS_PER_INCH, box.height * POINTS_PER_INCH
