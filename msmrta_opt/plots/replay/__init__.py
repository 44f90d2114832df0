"""A replay of a plan or a run that anyone can open: one HTML file that needs no network, or a film.

A page: `data` is the plan as it reads it, `run_data` the run; ``replay.html`` with ``replay.css`` and,
in this order, ``state.js``, ``draw.js``, ``timeline.js``, ``words.js`` and ``page.js`` are its parts,
which `page` puts together. A film, GIF or MP4: `film`, with `scene` for what
moves on it, and `run_scene` for what moves in a run.
"""

from __future__ import annotations

from .page import Replay, plot_replay

__all__ = ["Replay", "plot_replay"]
