"""A study in Python: run it, see what is done, take its rows, write its report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..mission import display
from ..mission.errors import InputError
from .ledger import Ledger
from .record import Record, frame
from .runner import Execute, pending, run_study
from .runs import Run, current, runs
from .specification import Study

if TYPE_CHECKING:
    import pandas as pd

HOW = ("finished", "failed", "open")


@dataclass(frozen=True)
class State:
    """What there is of a study."""

    runs: tuple[Run, ...]
    """All that the study asks for, in its order."""
    known: Mapping[str, Record]
    """Everything in the ledger, by key."""

    @property
    def records(self) -> list[Record]:
        """Of the study's runs, in their order; where there is none of these versions, the newest."""
        return current(self.runs, self.known.values())

    @property
    def n_others(self) -> int:
        """Records in the ledger that are of other settings or versions."""
        return len(self.known) - sum(run.key in self.known for run in self.runs)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row a contender: how many runs, and how many of these versions are finished or failed."""
        counts: dict[str, Counter[str]] = {}
        for run in self.runs:
            record = self.known.get(run.key)
            how = "open" if record is None else "failed" if record.failed else "finished"
            counts.setdefault(run.contender, Counter())[how] += 1
        return [
            {"contender": who, "all": of.total(), **{how: of[how] for how in HOW}}
            for who, of in counts.items()
        ]

    @property
    def failures(self) -> list[dict[str, Any]]:
        """A row for each way in which runs of a contender failed."""
        counts: Counter[tuple[str, str, str]] = Counter()
        for run in self.runs:
            record = self.known.get(run.key)
            if record is not None and record.failed:
                counts[run.contender, record.outcome, record.error] += 1
        return [
            {"contender": who, "runs": count, "outcome": outcome, "error": error}
            for (who, outcome, error), count in counts.items()
        ]


class OpenStudy:
    """A study with its ledger; what is finished is kept, and `run` goes on from there.

    Parameters
    ----------
    specification : Study
        As read.
    """

    def __init__(self, specification: Study) -> None:
        self.specification = specification

    @property
    def ledger(self) -> Path:
        """The file in which finished runs are kept."""
        return self.specification.ledger

    def run(
        self,
        *,
        jobs: int = 1,
        retry: bool = False,
        dask: str | None = None,
    ) -> pd.DataFrame:
        """Do all runs that are not done yet, each in a process of its own; returns `rows`.

        Parameters
        ----------
        jobs : int
            How many at a time; more than one makes times less comparable.
        retry : bool
            Do failed runs again.
        dask : str, optional
            Run on the Dask cluster of this address, ``tcp://HOST:PORT``.

        Raises
        ------
        InputError
            If the study, its missions or its ledger are not right; nothing is run then.
        """
        if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
            raise InputError(f"{jobs!r}; give a whole number, 1 or more", field="jobs")
        execute = None
        if dask is not None:
            from .cluster import on_cluster

            execute = on_cluster(dask)
        with self.running(execute=execute, jobs=jobs, retry=retry) as (_, _, finished):
            for _ in finished:
                pass
        return self.rows()

    @contextmanager
    def running(
        self, *, execute: Execute | None = None, jobs: int = 1, retry: bool = False
    ) -> Iterator[tuple[list[Run], int, Generator[Record, None, None]]]:
        """All runs, how many of them are open, and the records of these as they are kept."""
        todo = runs(self.specification)
        with Ledger(self.ledger) as ledger:
            n_open = len(pending(self.specification, todo, ledger, retry=retry))
            finished = run_study(
                self.specification, todo, ledger, execute=execute, jobs=jobs, retry=retry
            )
            with closing(finished):
                yield todo, n_open, finished

    def state(self) -> State:
        """What is done, failed and open.

        Raises
        ------
        InputError
            If there is no ledger yet, or it cannot be read.
        """
        with Ledger(self.ledger, read_only=True) as ledger:
            todo = runs(self.specification, ledger.missions())
            return State(tuple(todo), {record.key: record for record in ledger.records()})

    def status(self) -> pd.DataFrame:
        """`State.rows` as a table: runs, finished, failed and open of each contender."""
        import pandas as pd

        return pd.DataFrame(self.state().rows)

    def rows(self) -> pd.DataFrame:
        """The runs there are, a row each; columns as in `Record`, and one for each metric."""
        return frame(self.state().records)

    to_frame = rows

    def report(self, folder: str | Path | None = None) -> Path:
        """Write the report, one HTML file with its pictures and data beside it.

        Parameters
        ----------
        folder : path, optional
            By default ``STUDY-report`` beside the study.

        Returns
        -------
        Path
            The page.
        """
        from .report import write_report

        path = self.specification.path
        state = self.state()
        where = folder or path.with_name(f"{path.stem}-report")
        return write_report(self.specification, state.records, where, expected=len(state.runs))

    def __repr__(self) -> str:
        return f"OpenStudy({self._summary})"

    def _repr_html_(self) -> str:
        rows = self.state().rows if self.ledger.exists() else []
        return display.page(
            self._summary,
            display.paragraph(self.specification.description),
            display.table("Runs", rows),
        )

    @property
    def _summary(self) -> str:
        kept = "" if self.ledger.exists() else ", not run yet"
        return f"{self.specification.title}, ledger {self.ledger}{kept}"


def study(what: str | Path | Mapping[str, Any], path: str | Path | None = None) -> OpenStudy:
    """Open a study, to run it and to read what there is of it.

    Parameters
    ----------
    what : path or mapping
        A study file, or a document with the fields of one.
    path : path, optional
        With a document: the study's name and folder; its ledger is beside it, with the suffix
        ``.sqlite``, and files are looked for from there. It need not exist.

    Raises
    ------
    InputError
        Naming the file, the field, the offending value and what would be right.
    """
    if not isinstance(what, Mapping):
        if path is not None:
            raise InputError("goes with a document, not with a study file", field="path")
        return OpenStudy(Study.read(what))
    if path is None:
        raise InputError("is missing; a document needs one, where its ledger is kept", field="path")
    return OpenStudy(Study.of(what, path))
