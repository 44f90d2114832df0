"""Whether all that is written on a picture can be read: inside the figure, over nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox


def written(figure: Figure) -> list[tuple[str, Bbox]]:
    """Each text that is drawn, with the box that the renderer gives it, its frame included."""
    texts: dict[Text, None] = {}
    draw = Text.draw

    def note(text: Text, *arguments: Any, **options: Any) -> None:
        texts[text] = None
        draw(text, *arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", note)
        FigureCanvasAgg(figure).draw()
    frames = {text: text.get_bbox_patch() for text in texts if text.get_text().strip()}
    return [
        (text.get_text(), (text if frame is None else frame).get_window_extent())
        for text, frame in frames.items()
    ]


def discs(figure: Figure) -> Iterator[Bbox]:
    """The boxes of the victims' discs."""
    for ax in figure.axes:
        for group in ax.collections:
            if isinstance(group, EllipseCollection):
                sizes = np.broadcast_to(2 * np.asarray(group._widths), len(group.get_offsets()))
                for (x, y), size in zip(group.get_offsets(), sizes, strict=True):
                    half = size / 2
                    corners = ax.transData.transform([(x - half, y - half), (x + half, y + half)])
                    yield Bbox([corners.min(axis=0), corners.max(axis=0)])


def overlap(one: Bbox, other: Bbox, slack: float = 1.0) -> bool:
    """Whether boxes share more than `slack` pixels each way."""
    both = Bbox.intersection(one, other)
    return both is not None and both.width > slack and both.height > slack


def illegible(figure: Figure) -> list[str]:
    """Texts that reach out of the figure or share ink with another text or a victim's disc."""
    texts = written(figure)
    assert len(texts) > 10, "there is hardly anything to read"
    page = figure.bbox
    found = [
        f"{said!r} is outside"
        for said, box in texts
        if box.x0 < page.x0 or box.y0 < page.y0 or box.x1 > page.x1 or box.y1 > page.y1
    ]
    pairs = combinations(texts, 2)
    found += [f"{a!r} is on {b!r}" for (a, one), (b, other) in pairs if overlap(one, other)]
    for disc in discs(figure):
        on_it = [said for said, box in texts if overlap(box, disc)]
        if len(on_it) > 1:  # its own number is one
            found.append(f"on one disc are {on_it}")
    return found
