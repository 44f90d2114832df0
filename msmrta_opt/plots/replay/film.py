"""A replay as moving pictures: a GIF, or an MP4 where ffmpeg is.

The ground of every frame is the package's own picture of the map and of the timeline, drawn once; what
moves is drawn over it.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from ...mission.errors import InputError
from ...mission.files import write_with
from ...mission.plan import Plan
from ...mission.run import Run
from ..canvas import panel_size, plot_map
from ..figure import POINTS_PER_INCH
from ..gantt import plot_gantt
from ..lettering import as_written, fitted, shortened, width_of
from ..titles import name_of
from ..walked import walked
from .run_scene import RunScene
from .scene import ABOVE, TITLE, Moving, Scene

DPI = 80
SCOUTING, MISSION, LAST = 3.0, 9.0, 1.5
"""Seconds of the film; the last frame stays for a while."""
RATES = {".gif": 8, ".mp4": 24}
"""Frames a second, by suffix."""
COLOURS = 128
"""Of a GIF, the same in all frames, so that what does not move takes no room."""


def save_film(plans: Sequence[Plan | Run], labels: Sequence[str], path: str | Path) -> None:
    """Write a film of one plan or run, or of several side by side, as the suffix of `path` says.

    Raises
    ------
    InputError
        If there is no ffmpeg for an MP4, or the file cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".mp4":
        check_ffmpeg(path)
    pictures = frames(plans, labels, RATES[suffix])
    write = _write_gif if suffix == ".gif" else _write_mp4
    write_with(path, lambda temporary: write(pictures, RATES[suffix], temporary))


def check_ffmpeg(path: str | Path) -> None:
    """Refuse to write an MP4 where there is no program for it.

    Raises
    ------
    InputError
        If there is no ffmpeg.
    """
    if shutil.which("ffmpeg") is None:
        raise InputError("needs the program ffmpeg; install it, or write a .gif", file=path)


def frames(plans: Sequence[Plan | Run], labels: Sequence[str], rate: int) -> Iterator[Image.Image]:
    """The pictures of a film, `rate` a second: scouting, if there was any, then the mission."""
    figure = _page(plans, labels)
    canvas: Any = FigureCanvasAgg(figure)  # whose methods have no types
    canvas.draw()
    ground = canvas.copy_from_bbox(figure.bbox)
    columns = np.array([ax for ax in figure.axes if ax.get_subplotspec()]).reshape(2, -1).T
    scenes = [
        RunScene(plan, *axes) if isinstance(plan, Run) else Scene(plan, *axes)
        for plan, axes in zip(plans, columns, strict=True)
    ]
    # What is written over all that moves is the same in all frames.
    canvas.get_renderer().clear()
    for scene in scenes:
        scene.write_names()
    names = Image.fromarray(np.asarray(canvas.buffer_rgba()).copy())

    def picture(moving: Iterable[Moving]) -> Image.Image:
        canvas.restore_region(ground)
        for ax, artist in chain.from_iterable(moving):
            ax.draw_artist(artist)
            artist.remove()
        drawn = Image.fromarray(np.asarray(canvas.buffer_rgba()).copy())
        return Image.alpha_composite(drawn, names).convert("RGB")

    steps = max(scene.steps for scene in scenes)
    if steps >= 0:
        for step in np.linspace(0, steps, round(rate * SCOUTING)).astype(int):
            yield picture([scene.scouting(int(step)) for scene in scenes])
    horizon = max(plan.metrics.makespan for plan in plans)
    for t in np.linspace(0, horizon, round(rate * MISSION)):
        last = picture([scene.mission(float(t)) for scene in scenes])
        yield last
    for _ in range(round(rate * LAST)):
        yield last


@as_written
def _page(plans: Sequence[Plan | Run], labels: Sequence[str]) -> Figure:
    """Maps above, timelines below, a column for each plan."""
    drawn = [walked(plan) if isinstance(plan, Run) else plan for plan in plans]
    sizes = [panel_size(plan.instance.map) for plan in drawn]
    width = sum(max(wide, 5.4) + 0.5 for wide, _ in sizes)
    tall = max(high for _, high in sizes) + 0.7
    low = max(min(0.9 + 0.2 * plan.instance.n_robots, 4.0) for plan in drawn)
    figure = Figure(figsize=(width, tall + low), dpi=DPI)
    figure.set_layout_engine("constrained", w_pad=0.12, h_pad=0.06)
    axes = figure.subplots(2, len(plans), squeeze=False, height_ratios=(tall, low))
    horizon = max(plan.metrics.makespan for plan in plans)
    for told, plan, label, (ground, timeline) in zip(plans, drawn, labels, axes.T, strict=True):
        plot_map(plan.instance.map, ground)
        plot_gantt(told, timeline, until=horizon)
        for panel in (ground, timeline):
            panel.set(title="", xlabel="", ylabel="")
            if (legend := panel.get_legend()) is not None:
                legend.remove()
        ground.set_anchor("NW")  # below its title, however narrow
        room = POINTS_PER_INCH * (width / len(plans) - 0.8)
        who = f" · {shortened(label)}"
        name = fitted(name_of(plan.instance), TITLE, room - width_of(who, TITLE))
        # The second line is left to what is said of each moment.
        ground.set_title(f"{name}{who}\n ", fontsize=TITLE, pad=ABOVE, loc="left")
    return figure


def _write_gif(pictures: Iterator[Image.Image], rate: int, path: Path) -> None:
    every = list(pictures)
    palette = _both(every[0], every[-1]).quantize(COLOURS)
    first, *others = (
        picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in every
    )
    first.save(
        path,
        save_all=True,
        append_images=others,
        duration=round(1000 / rate),
        loop=0,
        optimize=True,
    )


def _both(first: Image.Image, last: Image.Image) -> Image.Image:
    """Two pictures in one, which together have the colours of a film."""
    both = Image.new("RGB", (first.width, 2 * first.height))
    both.paste(first)
    both.paste(last, (0, first.height))
    return both


def _write_mp4(pictures: Iterator[Image.Image], rate: int, path: Path) -> None:
    first = next(pictures)
    size = f"{first.width}x{first.height}"
    command = [
        *("ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"),
        *("-s", size, "-r", str(rate), "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"),
        *("-pix_fmt", "yuv420p", "-movflags", "+faststart", "-bitexact", str(path)),
    ]
    run = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    assert run.stdin is not None
    try:
        for picture in (first, *pictures):
            run.stdin.write(picture.tobytes())
        _, said = run.communicate()
    finally:
        run.kill()
    if run.returncode:
        problem = said.decode(errors="replace").strip().splitlines()[-1:]
        raise InputError(f"ffmpeg could not write it: {' '.join(problem)}", file=path)
