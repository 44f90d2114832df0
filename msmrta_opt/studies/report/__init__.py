"""The report of a study: one HTML file that needs no network, its pictures and its data beside it.

`write_report` composes it from parts that a notebook can use as well: `runs` (records as a table and
what is comparable in it), `tables`, `baseline`, `scaling`, `profile`, `heat`, `outcomes`, `winner` with
its `pairs`, and `policies` for what was executed; each takes the table of runs, or the records, and
returns `blocks`: words, tables or pictures, in the page's `style`. `content` puts them in order,
`render` writes the page, `folder` puts it in place, `text` writes names and numbers. Everything heavy
is imported when one is written.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..record import Record
    from ..specification import Study


def write_report(
    study: Study, records: Sequence[Record], folder: str | Path, *, expected: int
) -> Path:
    """Write the report of `study` into `folder`, whole or not at all.

    The same records give the same bytes.

    Parameters
    ----------
    study : Study
        What was asked.
    records : sequence of Record
        What came of it so far, contenders in the order in which they are to be listed.
    folder : path
        Made if missing; an older report there is replaced, anything else is left alone.
    expected : int
        How many runs the study has.

    Returns
    -------
    Path
        The page; ``figures/*.png`` and ``data/*.csv`` are beside it.

    Raises
    ------
    InputError
        If `folder` holds something else than a report, or cannot be written.
    """
    from .content import sections
    from .folder import PAGE, replaced_folder
    from .render import write_page
    from .runs import table_of

    folder = Path(folder)
    with replaced_folder(folder) as fresh:
        runs = table_of(records)
        write_page(fresh, study, runs, sections(study, runs, records), expected=expected)
    return folder / PAGE
