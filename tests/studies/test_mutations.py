"""Broken studies, ledgers and baselines are read, or refused in one line: never a traceback."""

from __future__ import annotations

import json
import random
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from support.studies import write_study

from msmrta_opt.mission.errors import MsmrtaError
from msmrta_opt.studies.analysis.regression import changes, read_baseline
from msmrta_opt.studies.ledger import Ledger
from msmrta_opt.studies.record import frame
from msmrta_opt.studies.runs import current, runs
from msmrta_opt.studies.specification import Study

DATA = Path(__file__).parents[1] / "data"
STUDY = """title = "Mutated"
[[instances]]
maps = "open.map"
robots = [1, 2]
victims = 3
seeds = [0, 1]
per_victim = [1, 2]
[[planners]]
psi = [0.1, 0.9]
[[planners]]
planner = "mrga"
alpha = 0.25
[[formulations]]
stage = "cluster"
models = "cluster_printed"
solvers = ["auto", "highs"]
time_limit = 5
gap = 0.1
[limits]
seconds = 5
[timing]
repetitions = 2
[report]
baseline = "mrga"
"""
TOKENS = [
    "-1",
    "0",
    "1e999",
    "nan",
    "'x'",
    "[]",
    "{}",
    "true",
    '"',
    "[",
    "=",
    "\n",
    "\x00",
    "é",
    "1.5",
]
FEW = range(60)
MANY = pytest.param(range(60, 2000), marks=pytest.mark.slow)


def mutated(text: str, chance: random.Random) -> str:
    for _ in range(chance.randint(1, 3)):
        start = chance.randrange(len(text) + 1)
        end = min(start + chance.choice([0, 1, 1, 3, 12]), len(text))
        text = text[:start] + chance.choice(["", chance.choice(TOKENS)]) + text[end:]
    return text


def refused(read: Callable[[], object]) -> bool:
    """Whether what was read was refused, in one line."""
    try:
        read()
    except MsmrtaError as error:
        said = str(error)
    else:
        return False
    assert "\n" not in said
    return True


@pytest.mark.parametrize("seeds", [FEW, MANY], ids=["few", "many"])
def test_mutated_studies(tmp_path: Path, seeds: range) -> None:
    n_refused = 0
    for seed in seeds:
        path = write_study(tmp_path, mutated(STUDY, random.Random(seed)))
        n_refused += refused(lambda path=path: runs(Study.read(path)))  # type: ignore[misc]
    assert n_refused > 0


@pytest.mark.parametrize("seeds", [FEW, MANY], ids=["few", "many"])
def test_mutated_baselines(tmp_path: Path, seeds: range) -> None:
    whole = json.loads((DATA / "solver_baseline.json").read_text(encoding="utf-8"))
    text = json.dumps({**whole, "rows": whole["rows"][:3]})
    path = tmp_path / "baseline.json"
    n_refused = 0
    for seed in seeds:
        path.write_text(mutated(text, random.Random(seed)), encoding="utf-8")

        def read() -> None:
            rows = read_baseline(path)
            changes(rows, rows, slower=2.0)

        n_refused += refused(read)
    assert n_refused > 0


@pytest.mark.parametrize("seeds", [FEW, MANY], ids=["few", "many"])
def test_mutated_ledgers(tmp_path: Path, seeds: range) -> None:
    """Bytes are changed, the file is cut, or a value in a row is another."""
    folder = tmp_path / "study"
    shutil.copytree(DATA / "ledger_of_layout_1", folder)
    study = Study.read(folder / "study.toml")
    todo, sound = runs(study), study.ledger.read_bytes()
    n_refused = 0
    for seed in seeds:
        chance = random.Random(seed)
        broken = bytearray(sound)
        if chance.random() < 0.5:
            for _ in range(chance.choice([1, 5, 50])):
                broken[chance.randrange(len(broken))] = chance.randrange(256)
            if chance.random() < 0.3:
                del broken[chance.randrange(len(broken)) :]
        study.ledger.write_bytes(broken)
        if broken == sound:
            with sqlite3.connect(study.ledger) as database:
                names = [name for _, name, *_ in database.execute("PRAGMA table_info(runs)")]
                value = chance.choice([None, -1, 1.5, "x", "{", "[]", b"\x00", "1e999", 2**62])
                column = chance.choice(names[1:])
                database.execute(f'UPDATE OR IGNORE runs SET "{column}" = ?', (value,))
            database.close()

        def read() -> None:
            with Ledger(study.ledger, read_only=True) as ledger:
                known = ledger.missions()
                frame(current(todo, ledger.records()))
                assert isinstance(known, dict)

        n_refused += refused(read)
        for rest in study.ledger.parent.glob("study.sqlite-*"):
            rest.unlink()
    assert 0 < n_refused < len(seeds)
