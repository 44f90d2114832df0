"""What was meant by a name that is not known."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping

from .errors import InputError


def meant(name: object, known: Iterable[str], shown: Mapping[str, str] | None = None) -> str:
    """`` (did you mean 'psi'?)``, to follow what is wrong with `name`; empty if nothing is near.

    Case, hyphens and underscores make no difference. `shown` has what to say instead of a known name.
    """
    plain = {_plain(item): (shown or {}).get(item, item) for item in known}
    given = _plain(str(name))
    cutoff = 0.66 if len(given) <= 4 else 0.7  # one wrong letter of three counts
    near = difflib.get_close_matches(given, plain, n=1, cutoff=cutoff)
    return f" (did you mean {plain[near[0]]!r}?)" if near else ""


def none_of(name: object, known: Collection[str], field: str = "") -> InputError:
    """That `name` is none of those that are `known`, one of which is to be given."""
    problem = f"{name!r}{meant(name, known)}; give one of {', '.join(known)}"
    return InputError(problem, field=field)


def _plain(name: str) -> str:
    return name.casefold().replace("-", "_")
