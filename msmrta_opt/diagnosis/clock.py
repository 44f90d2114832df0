"""What is left of a time limit that several steps share."""

from __future__ import annotations

import time

from ..interruption import interrupted
from ..mission.errors import InputError


class Clock:
    """Runs from its making on.

    Raises
    ------
    InputError
        If the limit is negative.
    """

    def __init__(self, limit: float | None) -> None:
        if limit is not None and not limit >= 0:
            raise InputError(f"{limit}; give seconds, 0 or more", field="time_limit")
        self._end = None if limit is None else time.perf_counter() + limit

    @property
    def left(self) -> float | None:
        """Seconds, 0 or more; ``None`` if there is no limit."""
        return None if self._end is None else max(self._end - time.perf_counter(), 0.0)

    @property
    def is_up(self) -> bool:
        """Whether the limit has passed, or the user wants an end."""
        return interrupted() or self.left == 0
