"""Machine code for the inner loops: numba, where it is there.

Only files of kernels import this, and they are imported when one of their functions is first needed:
numba takes half a second to import. A kernel is compiled for one signature, once ever: its code is kept
where numba can write (beside the file, or in the user's cache folder), else in memory only.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, TypeVar

import numba
from numba.core import event

if numba.config.DISABLE_JIT:
    raise ImportError("numba is told not to compile")

Function = TypeVar("Function", bound=Callable[..., Any])


class _Notice(event.Listener):  # type: ignore[misc]
    """One line on a terminal before the first function is compiled."""

    said = False

    def on_start(self, event: object) -> None:
        if not _Notice.said and sys.stderr.isatty():
            print("msmrta: compiling its inner loops, once and for all …", file=sys.stderr)
        _Notice.said = True

    def on_end(self, event: object) -> None:
        """Nothing is said when it is done."""


def kernel(signature: object, *, allocates: bool = True) -> Callable[[Function], Function]:
    """Compile a function for `signature`, in numba's words, or load its code.

    It does not hold the interpreter's lock, and sums are taken in the order in which they are written.
    One that makes no arrays counts no references to arrays either, which takes most of the time where
    functions hand many of them on.
    """

    def decorate(function: Function) -> Function:
        with _noticed():
            try:
                return _compiled(function, signature, cache=True, _nrt=allocates)
            except Exception:
                # Whatever is wrong with the cache: no folder to write to, a full disk, a broken file.
                return _compiled(function, signature, cache=False, _nrt=allocates)

    return decorate


def inlined(function: Function) -> Function:
    """Make `function`, which kernels of its file call, part of each of them."""
    made: Function = numba.njit(function)
    return made


def inlined_in_place(function: Function) -> Function:
    """As `inlined`, for kernels that make no arrays."""
    made: Function = numba.njit(_nrt=False)(function)
    return made


def _compiled(function: Function, signature: object, **options: bool) -> Function:
    made: Function = numba.njit(signature, nogil=True, **options)(function)
    return made


def _noticed() -> AbstractContextManager[None]:
    noticed: AbstractContextManager[None] = event.install_listener("numba:compile", _Notice())
    return noticed
