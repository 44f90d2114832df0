"""The table of a comparison, as a pandas table that shows itself in a few columns."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from ..mission import display
from .record import Record
from .solves import table_of

SHORT = ("instance", "model", "solver", "seed", "status", "objective", "bound", "total_seconds")
"""The columns that are shown; all others are there."""


class Comparison(pd.DataFrame):  # type: ignore[misc]  # pandas comes without types
    """A row a solve, a column per entry of `solves.COLUMNS`; what is taken from it is plain pandas."""

    @classmethod
    def of(cls, records: Sequence[Record]) -> Comparison:
        """The table of `records`."""
        return cls(table_of(records))

    @property
    def _summary(self) -> str:
        if "status" not in self:
            return f"Comparison({display.counted(len(self), 'row')})"
        counts = self["status"].value_counts().to_dict()
        statuses = ", ".join(f"{count} {status}" for status, count in counts.items())
        return f"Comparison({display.counted(len(self), 'solve')}: {statuses or 'none'})"

    @property
    def _short(self) -> pd.DataFrame:
        columns = [name for name in SHORT if name in self and not self[name].isna().all()]
        return pd.DataFrame(self)[columns]

    def __repr__(self) -> str:
        return f"{self._summary}\n{self._short.to_string(max_rows=display.MAX_ROWS)}"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        rows = self._short.astype(object).where(self._short.notna(), None).to_dict("records")
        return display.page(self._summary, display.table("Solves", rows))
