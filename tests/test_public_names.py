"""The public names: each is the same thing whatever was imported or used before it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import msmrta_opt as mo
from msmrta_opt.public import HOME, MODULES

ROOT = Path(__file__).parents[1]
CORRIDOR = str(ROOT / "instances" / "corridor.json")
EVERY_MODULE = """
import importlib, pkgutil
for info in pkgutil.walk_packages(mo.__path__, "msmrta_opt."):
    if "_shipped" not in info.name and "formulations." not in info.name:
        importlib.import_module(info.name)
"""
"""Imports every module of the package, which sets each in the package above it."""
LOADED = "found = {name: getattr(mo, name) for name in sorted(mo.__all__)}\n"
ORDERS = {
    "as they are": LOADED,
    "from the last to the first": (
        "found = {name: getattr(mo, name) for name in sorted(mo.__all__, reverse=True)}"
    ),
    "after a plan": f"mo.plan(mo.read({CORRIDOR!r}))\n{LOADED}",
    "after every module": EVERY_MODULE + LOADED,
    "before every module": LOADED + EVERY_MODULE + LOADED,
    "by a star": EVERY_MODULE
    + "from msmrta_opt import *\nfound = {n: globals()[n] for n in mo.__all__}",
}
EACH_ON_ITS_OWN = """
import importlib, json, os, sys, types
for library in ("cvxpy", "matplotlib.pyplot", "networkx", "pandas", "pydantic", "sklearn.cluster"):
    importlib.import_module(library)
for order, program in json.loads(sys.argv[1]).items():
    if os.fork():
        if os.wait()[1]:
            sys.exit(order)
        continue
    import msmrta_opt as mo
    exec(program)
    del found["__version__"]
    said = {}
    for name, value in sorted(found.items()):
        home = value.__name__ if isinstance(value, types.ModuleType) else value.__module__
        said[name] = [home, getattr(value, "__qualname__", ""), callable(value)]
    print(json.dumps([order, said]), flush=True)
    os._exit(0)
"""
"""Follows each order in a process that has the libraries, and nothing of the package yet."""

Names = dict[str, tuple[str, str, bool]]


@pytest.fixture(scope="module")
def found() -> dict[str, Names]:
    """By order, where each name is from, what it is called there, and whether it can be called."""
    ended = subprocess.run(
        [sys.executable, "-c", EACH_ON_ITS_OWN, json.dumps(ORDERS)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert ended.returncode == 0, ended.stderr
    return dict(json.loads(line) for line in ended.stdout.splitlines())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks processes")
def test_every_public_name_is_the_same_in_any_order(found: dict[str, Names]) -> None:
    assert set(found) == set(ORDERS)
    for order in ORDERS:
        assert found[order] == found["as they are"], order


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks processes")
def test_what_is_called_can_be_called(found: dict[str, Names]) -> None:
    names = found["as they are"].items()
    assert {name for name, (_, _, is_called) in names if not is_called} == {"algorithm", "plots"}


def test_no_public_name_is_that_of_a_module() -> None:
    own = {path.stem for path in (ROOT / "msmrta_opt").iterdir()}
    assert own.isdisjoint(HOME)
    assert set(MODULES) - own <= {"algorithm"}


def test_the_lists_have_one_kind_of_name_and_that_of_before_goes_on() -> None:
    mo.plan(mo.read(CORRIDOR))
    assert mo.planners() == mo.list_planners()
    assert mo.models() == mo.list_models()
    assert {"msmrta", "exact"} <= set(mo.list_planners())
    assert {"highs", "scip"} <= set(mo.list_solvers())
    assert "cluster_one_to_one" in {item.name for item in mo.list_models()}


def test_what_there_is_not_is_refused() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'solvers_of'"):
        mo.solvers_of  # noqa: B018
