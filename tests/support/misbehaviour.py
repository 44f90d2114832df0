"""What a function in a process of its own may do wrong, and models whose ``build`` does it."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

MOST_MEBIBYTES = 1500
"""Where the memory eaters stop, should nobody stop them."""


def double(number: int) -> int:
    return 2 * number


def do(what: str, number: int = 0) -> object:
    """Misbehave as `what` says, or return twice the `number`."""
    wrong: dict[str, Callable[[], object]] = {
        "kill": lambda: os.kill(os.getpid(), signal.SIGKILL),
        "abort": os.abort,
        "exit": lambda: sys.exit(3),
        "leave": lambda: os._exit(0),
        "hang": lambda: time.sleep(600),
        "eat": eat,
        "raise": lambda: 1 / 0,
        "lambda": lambda: lambda: None,
    }
    return wrong[what]() if what in wrong else double(number)


def eat() -> int:
    """Take ever more memory, 50 MiB at a time."""
    eaten = []
    while len(eaten) * 50 < MOST_MEBIBYTES:
        eaten.append(b"x" * (50 * 2**20))
        time.sleep(0.05)
    return len(eaten)


def note_or_wait(what: str, path: str) -> None:
    """Write this process's id to `path` and hang; or wait until another has done so."""
    if what == "note":
        Path(path).write_text(str(os.getpid()))
        time.sleep(600)
    while not (Path(path).exists() and Path(path).read_text()):
        time.sleep(0.02)


HEAD = '''"""A program for tests."""
import os, signal, sys, time
import cvxpy as cp
from msmrta_opt.optimise.formulation import ClusterData, Spec

SPEC = Spec(stage="cluster", title="a program for tests")


def build(data: ClusterData) -> cp.Problem:
    x = cp.Variable(data.w.shape, boolean=True, name="x")
    y = cp.Variable(name="y")
'''

MODELS = {
    "wrong_infeasible": "    return cp.Problem(cp.Minimize(cp.sum(x)), [cp.sum(x) >= 99])",
    "wrong_unbounded": "    return cp.Problem(cp.Maximize(y), [cp.sum(x) <= 1])",
    "wrong_not_convex": "    return cp.Problem(cp.Minimize(cp.sum(x)), [cp.square(y) >= 1])",
    "wrong_no_variables": "    return cp.Problem(cp.Minimize(cp.Constant(1)))",
    "wrong_syntax": "    return cp.Problem(cp.Minimize(",
    "wrong_loop": "    while True: time.sleep(0.05)",
    "wrong_memory": "    from support.misbehaviour import eat\n    eat()",
    "wrong_kill": "    os.kill(os.getpid(), signal.SIGKILL)",
    "wrong_exit": "    os._exit(7)",
    "right": "    return cp.Problem(cp.Maximize(cp.sum(x)), [cp.sum(x) <= 1])",
}


def write_models(folder: Path, *names: str, **more: str) -> Path:
    """Write the named `MODELS`, and `more` by name and body, to `folder`; returns it."""
    folder.mkdir(exist_ok=True)
    for name, body in {**{name: MODELS[name] for name in names}, **more}.items():
        (folder / f"{name}.py").write_text(f"{HEAD}{body}\n")
    return folder
