"""What proofs cost: leaves, size, seconds to write and to check, beside those to solve.

    python benchmarks/proving.py [--instances FILE…] [--external DIR] [--models NAME…]
                                 [--time-limit 60] [--viprchk PATH]
    python benchmarks/proving.py --plans 4x20 10x50 … [--missions 10] [--objectives total_time makespan]
                                 [--time-limit 600] [--viprchk PATH]

All formulations on the shipped missions (of the stage routing those of up to 4 × 20), and with
``--external`` the generalised assignment, p-median and MPS files of DIR (see ``external.py``). With
``--viprchk`` the reference checker of the format, built apart from this project, is given each
certificate, too. With ``--plans`` it is plans of the missions of ``exact.py``, those that the exact
planner calls optimal. The exit status is 1 if a proof contradicts a claim, or a checker refuses one.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from exact import mission
from external import read_generalised, read_p_median
from scipy.sparse import csr_array, kron

import msmrta_opt as mo
from msmrta_opt.cli.console import say, table
from msmrta_opt.mission.errors import MsmrtaError
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.compile import compile_for
from msmrta_opt.optimise.data import ClusteringData
from msmrta_opt.optimise.export import read_program
from msmrta_opt.optimise.program import Block, Program, Sense
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options
from msmrta_opt.proofs.exact import Numbers
from msmrta_opt.proofs.prove import Proof, prove_program
from msmrta_opt.routing.objectives import OBJECTIVES
from msmrta_opt.stages.data import stage_data

INSTANCES = Path(__file__).parents[1] / "instances"
LARGEST_ROUTING = (4, 20)
"""Robots and victims up to which the whole joint problem is proved."""


@dataclass(frozen=True)
class Case:
    """A program by its family and its name; it is built when its turn comes."""

    family: str
    name: str
    build: Callable[[], Program]


def missions(files: list[Path], models: list[str]) -> Iterator[Case]:
    """Every formulation on every mission that its stage can do."""
    for file in files:
        instance = mo.read(str(file))
        for listing in registry.listings():
            stage = registry.get(listing.name).spec.stage
            size = (instance.n_robots, instance.n_victims)
            too_large = any(a > b for a, b in zip(size, LARGEST_ROUTING, strict=True))
            if (models and listing.name not in models) or (stage == "routing" and too_large):
                continue
            try:
                data = stage_data(instance, stage)
            except MsmrtaError as error:
                say(f"{file.stem}, {listing.name}: {error}")
                continue

            def build(name: str = listing.name, data: object = data) -> Program:
                return compile_for(name, data).program()

            yield Case(listing.name, f"{file.stem} {size[0]}x{size[1]}", build)


def external(folder: Path) -> Iterator[Case]:
    """The public programs in `folder`."""
    for file in sorted(folder.glob("gap/gap*")):
        for sense in ("min", "max"):
            yield Case("gap", f"{file.name} {sense}", lambda f=file, s=sense: assignment(f, s))  # type: ignore[misc]
    for file in sorted(folder.glob("pmed/*.txt")):
        if file.name != "SOURCE.txt":
            yield Case("pmed", file.stem, lambda f=file: medians(f))  # type: ignore[misc]
    for file in sorted(folder.glob("mps/*.mps")):
        yield Case("mps", file.stem, lambda f=file: read_program(f))  # type: ignore[misc]


def assignment(file: Path, sense: Sense) -> Program:
    """Generalised assignment: each item to one agent, within the agents' capacities."""
    cost, weight, capacity = read_generalised(file)
    m, n = cost.shape
    once = kron(np.ones((1, m)), np.eye(n))
    loads = np.zeros((m, m * n))
    for i in range(m):
        loads[i, i * n : (i + 1) * n] = weight[i]
    return Program(
        sense, cost.ravel(), 0.0, csr_array(np.vstack([once.toarray(), loads])),
        np.concatenate([np.ones(n), np.full(m, -np.inf)]), np.concatenate([np.ones(n), capacity]),
        np.zeros(m * n), np.ones(m * n), np.ones(m * n, dtype=bool),
        (Block("x", 0, (m * n,)),), (Block("item", 0, (n,)), Block("agent", n, (m,))),
    )  # fmt: skip


def medians(file: Path) -> Program:
    """The p-median problem by the shipped formulation."""
    distance, p = read_p_median(file)
    data = ClusteringData(distance, np.isfinite(distance), np.ones(len(distance)), p)
    return compile_for("clustering_pmedian", data).program()


@dataclass(frozen=True)
class Outcome:
    """A case that was tried."""

    family: str
    name: str
    proof: Proof
    solve_seconds: float
    reference: str
    """What the reference checker says; empty if it was not asked."""


def tried(case: Case, time_limit: float, viprchk: Path | None, folder: Path) -> Outcome:
    """Solve the case, then prove what the solver says."""
    program = case.build()
    began = time.perf_counter()
    solution = solve_program(program, options=Options(time_limit=time_limit))
    solved = time.perf_counter() - began
    path = folder / "proof.vipr"
    is_file = case.family == "mps"
    numbers: tuple[Numbers, ...] = ("decimal", "binary") if is_file else ("binary", "simple")
    proof = prove_program(program, solution, path, time_limit=time_limit, numbers=numbers)
    return Outcome(case.family, case.name, proof, solved, referred(viprchk, path))


def planned(
    sizes: list[str], objectives: list[str], missions: int, time_limit: float, viprchk: Path | None
) -> Iterator[Outcome]:
    """Plan each mission of `exact.py`, and prove what the planner says is optimal."""
    with tempfile.TemporaryDirectory() as folder:
        for size, objective, number in product(sizes, objectives, range(missions)):
            instance = mission(size, number)
            began = time.perf_counter()
            plan = mo.plan(instance, planner="exact", objective=objective, time_limit=time_limit)
            solved = time.perf_counter() - began
            if plan.certificates[0].status != "optimal":
                say(f"{objective} {size} {number}: left open by the planner")
                continue
            path = Path(folder) / f"proof.{'json' if objective == 'latency' else 'vipr'}"
            proof = mo.prove_plan(plan, path=path, time_limit=time_limit)
            said = "" if objective == "latency" else referred(viprchk, path)
            yield Outcome(f"{objective} {size}", str(number), proof, solved, said)


def referred(viprchk: Path | None, path: Path) -> str:
    """What the reference checker says of the certificate at `path`, if it is there to be asked."""
    if viprchk is None:
        return ""
    run = subprocess.run([viprchk, path], capture_output=True, check=False)
    return "accepted" if run.returncode == 0 else "refused"


def show(outcomes: list[Outcome]) -> None:
    """A line per family, then what was not proved."""
    families = dict.fromkeys(outcome.family for outcome in outcomes)
    rows = []
    for family in families:
        own = [outcome for outcome in outcomes if outcome.family == family]
        whole = [o for o in own if o.proof.status in ("proved", "infeasible")]
        took = [o.proof.seconds / max(o.solve_seconds, 1e-9) for o in whole]
        rows.append((
            family, len(own), f"{100 * len(whole) / len(own):.0f}",
            *_middle_and_most([o.proof.leaves for o in whole], "d"),
            *_middle_and_most([o.proof.size / 1e3 for o in whole], ".1f"),
            *_middle_and_most([o.proof.seconds for o in whole], ".3f"),
            *_middle_and_most([o.proof.check_seconds for o in whole], ".3f"),
            f"{statistics.median(took):.1f}" if took else "",
        ))  # fmt: skip
    table(
        "Proofs by family: median and largest",
        ["family", "cases", "proved %", "leaves", "most", "kB", "most", "write s", "most",
         "check s", "most", "write/solve"], rows,
    )  # fmt: skip
    left = [o for o in outcomes if o.proof.status not in ("proved", "infeasible")]
    table(
        "Not proved",
        ["family", "case", "value", "bound", "solve s", "prove s", "why"],
        [
            (o.family, o.name, o.proof.value, o.proof.bound, f"{o.solve_seconds:.1f}",
             f"{o.proof.seconds:.1f}", o.proof.remark) for o in left
        ],
    )  # fmt: skip
    ratios = [o.proof.seconds / o.solve_seconds for o in outcomes if o.proof.status != "none"]
    said = Counter(o.reference for o in outcomes if o.reference)
    say(f"{len(outcomes) - len(left)} of {len(outcomes)} proved")
    say(f"median of write/solve: {statistics.median(ratios):.2f}")
    say(f"the reference checker: {dict(said) or 'not asked'}")


def _middle_and_most(values: list[float] | list[int], form: str) -> tuple[str, str]:
    if not values:
        return "", ""
    middle = statistics.median(values)
    return format(int(middle) if form == "d" else middle, form), format(max(values), form)


def _outcomes(arguments: argparse.Namespace) -> Iterator[Outcome]:
    if arguments.plans:
        yield from planned(
            arguments.plans, arguments.objectives, arguments.missions, arguments.time_limit,
            arguments.viprchk,
        )  # fmt: skip
        return
    files = arguments.instances
    if files is None:
        shipped = [*INSTANCES.glob("*.json"), *INSTANCES.glob("suite/*.json")]
        files = [] if arguments.external else sorted(shipped)
    cases = list(missions(files, arguments.models))
    if arguments.external:
        cases += external(arguments.external)
    with tempfile.TemporaryDirectory() as folder:
        for case in cases:
            yield tried(case, arguments.time_limit, arguments.viprchk, Path(folder))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", nargs="*", type=Path, default=None)
    parser.add_argument("--external", type=Path, help="a folder of public programs")
    parser.add_argument("--models", nargs="*", default=[], help="formulations; default: all")
    parser.add_argument(
        "--time-limit", type=float, default=60.0, help="seconds, to solve and prove"
    )
    parser.add_argument("--viprchk", type=Path, help="the format's reference checker")
    parser.add_argument("--plans", nargs="+", help="sizes of missions to plan, such as 4x20")
    parser.add_argument("--objectives", nargs="+", default=list(OBJECTIVES), choices=OBJECTIVES)
    parser.add_argument("--missions", type=int, default=10, help="of each size")
    arguments = parser.parse_args()
    outcomes = []
    for outcome in _outcomes(arguments):
        outcomes.append(outcome)
        proof, solved = outcome.proof, outcome.solve_seconds
        print(f"{outcome.family:22s} {outcome.name:16s} {solved:8.2f} s  {proof.summary}", end="  ")
        print(f"check {proof.check_seconds:.2f} s {outcome.reference}", flush=True)
    show(outcomes)
    wrong = [o for o in outcomes if o.proof.contradiction or o.reference == "refused"]
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
