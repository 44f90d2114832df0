"""The key of a page: what marks and colours mean, in columns of sections that fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.artist import Artist
from matplotlib.legend import Legend

from .figure import POINTS_PER_INCH, Page
from .lettering import HINTED, fitted, width_of

FONT = 8.0
LINE, HEAD = 0.172, 0.24
"""Inches of an entry and of a heading."""
SAMPLE = 30.0
"""Points of the sample before an entry's words."""


@dataclass(frozen=True)
class Section:
    """Entries under a heading."""

    title: str
    handles: Sequence[Artist]

    def pairs(self, width: float) -> bool:
        """Whether two entries fit side by side in so many points."""
        words = (HINTED * width_of(str(handle.get_label()), FONT) for handle in self.handles)
        return len(self.handles) > 2 and max(words) + SAMPLE + 8 <= width / 2

    def height(self, width: float) -> float:
        """Inches, in a column of so many points."""
        lines = len(self.handles)
        return HEAD + LINE * (-(-lines // 2) if self.pairs(width) else lines) + 0.08


def columns_of(
    sections: Sequence[Section], width: float, count: int
) -> list[list[tuple[Section, float]]]:
    """The sections with their heights in up to `count` columns, in their order, as low as can be."""
    filled = [section for section in sections if section.handles]
    heights = [section.height(width / count * POINTS_PER_INCH) for section in filled]
    limit = max([*heights, sum(heights) / count], default=0.0)
    while True:
        columns: list[list[tuple[Section, float]]] = [[]]
        room = limit
        for section, height in zip(filled, heights, strict=True):
            if height > room + 1e-9 and columns[-1]:
                columns.append([])
                room = limit
            columns[-1].append((section, height))
            room -= height
        if len(columns) <= count:
            return columns
        limit += LINE


def columns_below(sections: Sequence[Section], width: float) -> int:
    """The most columns, up to three, together `width` inches wide, in which all words fit; else two."""
    words = [str(handle.get_label()) for section in sections for handle in section.handles]
    longest = max((width_of(text, FONT) * HINTED for text in words), default=0.0)
    room = width * POINTS_PER_INCH
    return next((n for n in (3, 2, 1) if longest <= room / n - SAMPLE - 6), 2)


def key_height(sections: Sequence[Section], width: float, count: int) -> float:
    """Inches that the key takes in so many columns, together `width` inches wide."""
    columns = columns_of(sections, width, count)
    return max(sum(height for _, height in column) for column in columns)


def draw_key(
    page: Page, sections: Sequence[Section], left: float, top: float, width: float, count: int
) -> None:
    """Draw the key in so many columns, in a box of a width, all in inches from the upper left."""
    across, down = page.get_size_inches()
    room = width / count
    for number, column in enumerate(columns_of(sections, width, count)):
        y = top
        for section, height in column:
            x = left + number * room
            page.write(x, y, fitted(section.title, FONT, room * POINTS_PER_INCH, bold=True), FONT,
                       fontweight="bold")  # fmt: skip
            pairs = section.pairs(room * POINTS_PER_INCH)
            words = room * POINTS_PER_INCH / (1 + pairs) - SAMPLE - 6
            legend = Legend(
                page,
                handles=list(section.handles),
                labels=[fitted(str(h.get_label()), FONT, words) for h in section.handles],
                loc="upper left",
                bbox_to_anchor=(x / across, 1 - (y + HEAD - 0.06) / down),
                bbox_transform=page.transFigure,
                borderpad=0, borderaxespad=0, frameon=False, fontsize=FONT,
                handlelength=2.4, handletextpad=0.8, ncols=1 + pairs, columnspacing=1.0,
                labelspacing=(LINE * POINTS_PER_INCH - 1.17 * FONT) / FONT,
            )  # fmt: skip
            page.add_artist(legend)
            y += height
