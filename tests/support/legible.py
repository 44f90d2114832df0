"""Whether all that is written on a picture can be read: inside the figure, over nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from msmrta_opt.arrays import Bools, Floats


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


def overlaps(some: Floats, others: Floats, slack: float = 1.0) -> Bools:
    """Which share more than `slack` pixels each way; of extents (n, 4) and (m, 4), which (n, m)."""
    low = np.maximum(some[:, None, :2], others[None, :, :2])
    high = np.minimum(some[:, None, 2:], others[None, :, 2:])
    return np.all(high - low > slack, axis=2)


def extents(boxes: Iterable[Bbox]) -> Floats:
    """Left, bottom, right and top of each box, (n, 4)."""
    return np.array([box.extents for box in boxes]).reshape(-1, 4)


def illegible(figure: Figure) -> list[str]:
    """Texts that reach out of the figure or share ink with another text or a victim's disc."""
    texts = written(figure)
    assert len(texts) > 10, "there is hardly anything to read"
    said, boxes = [said for said, _ in texts], extents(box for _, box in texts)
    page = figure.bbox
    is_outside = (boxes[:, :2] < page.min).any(axis=1) | (boxes[:, 2:] > page.max).any(axis=1)
    found = [f"{said[i]!r} is outside" for i in np.flatnonzero(is_outside)]
    pairs = np.argwhere(np.triu(overlaps(boxes, boxes), 1))
    found += [f"{said[i]!r} is on {said[j]!r}" for i, j in pairs]
    for on_it in overlaps(extents(discs(figure)), boxes):
        if on_it.sum() > 1:  # its own number is one
            found.append(f"on one disc are {[said[i] for i in np.flatnonzero(on_it)]}")
    return found
