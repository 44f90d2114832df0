"""The public names: each is the same thing whatever was imported or used before it."""

from __future__ import annotations

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
NAMES = "names = sorted(mo.__all__)\n"
SAY = """
import types
for name in sorted(found):
    value = found[name]
    home = value.__name__ if isinstance(value, types.ModuleType) else value.__module__
    print(name, home, getattr(value, "__qualname__", ""), callable(value))
"""
ORDERS = {
    "as they are": NAMES + "found = {name: getattr(mo, name) for name in names}",
    "from the last to the first": NAMES + "found = {n: getattr(mo, n) for n in reversed(names)}",
    "after a plan": (
        f"mo.plan(mo.read({CORRIDOR!r}))\n"
        + NAMES
        + "found = {name: getattr(mo, name) for name in names}"
    ),
    "after every module": EVERY_MODULE + NAMES + "found = {n: getattr(mo, n) for n in names}",
    "before every module": (
        NAMES
        + "for name in names: getattr(mo, name)\n"
        + EVERY_MODULE
        + "found = {name: getattr(mo, name) for name in names}"
    ),
    "by a star": (
        EVERY_MODULE + "from msmrta_opt import *\nfound = {n: globals()[n] for n in mo.__all__}"
    ),
}


def said(program: str) -> str:
    """What a fresh process prints."""
    ended = subprocess.run(
        [sys.executable, "-c", "import msmrta_opt as mo\nmo.__version__\n" + program],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


WITHOUT_VERSION = "\nfound.pop('__version__')\n"


@pytest.fixture(scope="module")
def expected() -> str:
    return said(ORDERS["as they are"] + WITHOUT_VERSION + SAY)


@pytest.mark.parametrize("order", [name for name in ORDERS if name != "as they are"])
def test_every_public_name_is_the_same_in_any_order(order: str, expected: str) -> None:
    assert said(ORDERS[order] + WITHOUT_VERSION + SAY) == expected


def test_what_is_called_can_be_called(expected: str) -> None:
    modules = {line.split()[0] for line in expected.splitlines() if line.endswith("False")}
    assert modules == {"algorithm", "plots"}


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
