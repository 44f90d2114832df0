"""Writing pictures: whole or not at all, and the same bytes for the same picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..mission.errors import InputError
from ..mission.files import write_with
from .figure import cut_of

FORMATS = MappingProxyType(
    # Each format's own name for the stamp that would make every file differ.
    {
        "png": {"Software": None},
        "svg": {"Date": None},
        "pdf": {"CreationDate": None},
    }
)
"""The formats that can be written, by suffix, with the metadata to leave out."""


OPTIONS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {"png": {"pil_kwargs": {"compress_level": 4}}}  # much quicker, and hardly larger
)
"""What else a format's writer is told."""
SETTINGS: Mapping[Any, Any] = MappingProxyType(
    {
        "svg.hashsalt": "msmrta_opt",  # the same names inside each time
        "svg.fonttype": "none",  # text stays text, to be searched and edited
        "pdf.fonttype": 42,  # TrueType, as journals ask
    }
)
"""Of matplotlib, while a file is written."""


def save_figure(drawn: Figure | Axes, path: str | Path, dpi: float = 150) -> None:
    """Write a picture to `path`, in the format that its suffix names.

    Parameters
    ----------
    drawn : Figure or Axes
        What to write; of axes the whole figure.
    path : path
        The file, replaced whole; its suffix is one of `FORMATS`.
    dpi : float
        Dots per inch, of a PNG and of what is drawn as dots in the other formats.

    Notes
    -----
    A page, such as that of `plot_mission`, keeps its size; axes alone are cut to what they hold,
    with titles and legends that reach beyond the map.

    Raises
    ------
    InputError
        If the suffix is unknown or the file cannot be written.
    """
    suffix = Path(path).suffix
    kind = suffix.lower().removeprefix(".")
    if kind not in FORMATS:
        known = ", ".join(f".{name}" for name in FORMATS)
        raise InputError(
            f"unknown picture format {suffix!r}; the suffix is one of {known}", file=path
        )
    figure = drawn if isinstance(drawn, Figure) else drawn.get_figure(root=True)
    if figure is None:
        raise InputError("axes without a figure; give them one", field="drawn")
    with matplotlib.rc_context(dict(SETTINGS)):  # which end with the block
        write_with(
            path,
            lambda temporary: figure.savefig(
                temporary,
                format=kind,
                dpi=dpi,
                metadata=dict(FORMATS[kind]),
                bbox_inches=cut_of(figure),
                **OPTIONS.get(kind, {}),
            ),
        )
