"""A study on a Dask cluster gives the rows that it gives here."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import psutil
import pytest
from studies.test_runner import unmeasured
from support.studies import do, kept, many_runs

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies import runner
from msmrta_opt.studies.cluster import on_cluster
from msmrta_opt.studies.ledger import Ledger
from msmrta_opt.studies.runner import run_study
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study


@dataclass
class Cluster:
    """A scheduler and its workers, each a process of this machine, talking over TCP."""

    folder: Path
    address: str = ""
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start(self, *arguments: str) -> subprocess.Popen[bytes]:
        with (self.folder / f"{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
                stdout=log,
                stderr=log,
                cwd=self.folder,
            )
        self.processes.append(process)
        return process

    def logs(self) -> str:
        return "\n".join(path.read_text() for path in sorted(self.folder.glob("*.log")))


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    from distributed import Client

    folder = tmp_path / "cluster"
    folder.mkdir()
    found = Cluster(folder)
    contact = folder / "scheduler.json"
    try:
        found.start(
            *("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
            *("--scheduler-file", str(contact)),
        )
        _wait_for(contact.exists, found)
        found.address = json.loads(contact.read_text())["address"]
        # One as `dask worker` starts it, watched over by a nanny, and one without.
        for nanny in ("--nanny", "--no-nanny"):
            found.start(
                *("dask_worker", found.address, "--nthreads", "1", "--no-dashboard", nanny),
                *("--local-directory", str(folder)),
            )
        with Client(found.address, set_as_default=False) as client:
            _wait_for(lambda: len(client.nthreads()) == 2, found)
        yield found
    finally:
        for process in found.processes:
            family = [psutil.Process(process.pid), *psutil.Process(process.pid).children(True)]
            for member in family:
                member.kill() if member.is_running() else None
            process.wait()


def _wait_for(ready: Callable[[], bool], cluster: Cluster) -> None:
    """Wait for as long as all of its processes live: how busy the machine is decides nothing."""
    while not ready():
        assert all(process.poll() is None for process in cluster.processes), cluster.logs()
        time.sleep(0.1)


def test_a_cluster_gives_the_same_rows_and_a_lost_worker_loses_nothing(
    tmp_path: Path, cluster: Cluster
) -> None:
    assert cluster.address.startswith("tcp://")
    path = many_runs(tmp_path, 10)
    study = Study.read(path)
    with Ledger(study.ledger) as ledger:
        results = run_study(study, runs(study), ledger, execute=on_cluster(cluster.address))
        for n, _ in enumerate(results):
            if n == 2:
                cluster.processes[-1].kill()
    (tmp_path / "here").mkdir()
    here = many_runs(tmp_path / "here", 10)
    do(here, execute=runner.here)
    assert unmeasured(kept(path)) == unmeasured(kept(here))
    assert len(kept(path)) == 10


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://"])
def test_without_a_scheduler_there_is_one_clear_line(
    tmp_path: Path, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("msmrta_opt.studies.cluster.CONNECT_SECONDS", 1.0)
    study = Study.read(many_runs(tmp_path, 1))
    with (
        Ledger(study.ledger) as ledger,
        pytest.raises(InputError, match=r"--dask: no scheduler at '.*\Z"),
    ):
        list(run_study(study, runs(study), ledger, execute=on_cluster(address)))
