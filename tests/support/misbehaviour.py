"""What a function in a process of its own may do wrong, and models whose ``build`` does it."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from msmrta_opt import interruption
from msmrta_opt.interruption import interrupted
from msmrta_opt.mission.files import write_text
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solvers import Options, Outcome, cpsat

EATEN_MEBIBYTES = 600
"""What a memory eater takes before it waits to be stopped."""


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


def work_until_interrupted(path: str) -> str:
    """Say so in `path` that work has begun, and go on until it is asked for what there is."""
    write_text(path, "begun")
    while not interrupted():
        time.sleep(0.01)
    return "what there is"


def cpsat_until_its_first_incumbent(asked: Program) -> Outcome:
    """CP-SAT's outcome, if it is interrupted as soon as it has an incumbent."""
    from ortools.sat.python import cp_model

    found = threading.Event()

    class Watch(cp_model.CpSolverSolutionCallback):
        def on_solution_callback(self) -> None:
            found.set()

    solve = cp_model.CpSolver.solve
    cp_model.CpSolver.solve = lambda solver, model: solve(solver, model, Watch())
    interruption.listen_to_parent(found.is_set)
    return cpsat._solve(asked, Options())


def eat() -> None:
    """Take much memory, and keep it."""
    eaten = b"x" * (EATEN_MEBIBYTES * 2**20)
    time.sleep(600)
    del eaten


def note_or_wait(what: str, path: str) -> None:
    """Write this process's id to `path` and hang; or wait until another has done so."""
    if what == "note":
        write_text(path, str(os.getpid()))  # at once or not at all, so that nobody reads half of it
        time.sleep(600)
    while not Path(path).exists():
        time.sleep(0.02)


def hold(path: str) -> None:
    """Write this process's id to `path`, and wait in a library that lets no Python run meanwhile."""
    write_text(path, str(os.getpid()))
    ctypes.PyDLL(None).sleep(600)


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
