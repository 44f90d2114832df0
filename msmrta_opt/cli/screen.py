"""Standard output and standard error that never cost a result.

A command goes on, and writes its files, where its screen cannot take what it shows: a reader such as
``head`` that has left, a full device, a closed stream, an encoding without a letter.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO


class Screen(io.TextIOBase):
    """`stream`, but for characters that it has not, which are shown as ``?``, and for failures.

    After the first failure nothing is shown any more; `failure` is it, unless a reader just left.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._has_failed = False
        self.failure: OSError | None = None

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """That of the stream."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    def isatty(self) -> bool:
        """Whether a person looks at it."""
        return self._stream.isatty()

    def fileno(self) -> int:
        """The stream's descriptor."""
        return self._stream.fileno()

    def writable(self) -> bool:
        """It is."""
        return True

    def write(self, text: str, /) -> int:
        """Show `text` as far as that is possible."""
        if not self._has_failed:
            try:
                self._stream.write(text)
            except UnicodeEncodeError:
                shown = text.encode(self.encoding, "replace").decode(self.encoding)
                return self.write(shown)
            except OSError as error:
                self._give_up(error)
        return len(text)

    def flush(self) -> None:
        """Show what is held back."""
        if not self._has_failed:
            try:
                self._stream.flush()
            except OSError as error:
                self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        self._has_failed = True
        if error.errno != errno.EPIPE:
            self.failure = error
        # What the stream still holds is lost at exit without a further word.
        with suppress(OSError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)


@contextmanager
def screens() -> Iterator[tuple[Screen, Screen]]:
    """Standard output and standard error as screens, within the block."""
    before = sys.stdout, sys.stderr
    out, err = Screen(before[0] or _nowhere()), Screen(before[1] or _nowhere())
    sys.stdout, sys.stderr = out, err
    try:
        yield out, err
    finally:
        for screen in (out, err):
            screen.flush()
        sys.stdout, sys.stderr = before


def _nowhere() -> TextIO:
    """For a stream that was closed before this program began."""
    return open(os.devnull, "w", encoding="utf-8")


def open_closed_descriptors() -> None:
    """Open what was closed, or the next file that is opened would take what libraries print."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free, which is this one


def keep_from_libraries() -> None:
    """Keep standard output for what is shown here; what libraries print goes to standard error.

    HiGHS prints a line about a column now and then, in the midst of a document.
    """
    stream = sys.stdout
    if not isinstance(stream, io.TextIOWrapper) or stream.fileno() != 1:
        return
    stream.flush()
    own = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.stdout = io.TextIOWrapper(
        own,
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
