"""What other programs read in LP and MPS files: HiGHS, SCIP, GLPK and CBC, each by its own reader.

Run as a program, ``python other_readers.py READER FILE…``, it prints a line of JSON a file: the optimum
that the reader's solver finds, ``"infeasible"`` or ``"unbounded"``, or what is wrong with the file. Each
reader has a process of its own: some end it on a file that they do not like.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

Found = float | str


def by_highs(path: Path) -> Found:
    import highspy

    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("mip_rel_gap", 0.0)
    if (status := highs.readModel(str(path))) != highspy.HighsStatus.kOk:
        return f"not read: {status}"
    highs.run()
    status = highs.getModelStatus()
    if status == highspy.HighsModelStatus.kUnboundedOrInfeasible:
        highs.setOptionValue("presolve", "off")
        highs.run()
        status = highs.getModelStatus()
    if status == highspy.HighsModelStatus.kOptimal:
        return float(highs.getObjectiveValue())
    return str(status).removeprefix("HighsModelStatus.k").lower()


def by_scip(path: Path) -> Found:
    from pyscipopt import Model

    scip = Model()
    scip.hideOutput()
    try:
        scip.readProblem(str(path))
    except Exception as error:
        return f"not read: {error}"
    scip.setPresolve(0)
    scip.optimize()
    return float(scip.getObjVal()) if scip.getStatus() == "optimal" else str(scip.getStatus())


def by_glpk(path: Path) -> Found:
    import swiglpk as glpk

    glpk.glp_term_out(glpk.GLP_OFF)
    problem = glpk.glp_create_prob()
    if path.suffix == ".lp":
        wrong = glpk.glp_read_lp(problem, None, str(path))
    else:
        wrong = glpk.glp_read_mps(problem, glpk.GLP_MPS_FILE, None, str(path))
    if wrong:
        return "not read"
    simplex = glpk.glp_smcp()
    glpk.glp_init_smcp(simplex)
    glpk.glp_simplex(problem, simplex)
    status = glpk.glp_get_status(problem)
    if status == glpk.GLP_OPT:
        glpk.glp_intopt(problem, None)
        status = glpk.glp_mip_status(problem)
        if status == glpk.GLP_OPT:
            return float(glpk.glp_mip_obj_val(problem))
    return {glpk.GLP_NOFEAS: "infeasible", glpk.GLP_UNBND: "unbounded"}.get(status, str(status))


def by_cbc(path: Path, *options: str) -> Found:
    import pulp

    command = [pulp.PULP_CBC_CMD().path, str(path), "-ratioGap", "0", *options, "-solve"]
    with TemporaryDirectory() as folder:
        solution = Path(folder) / "solution"
        log = subprocess.run(
            [*command, "-solu", str(solution)], capture_output=True, text=True, check=False
        )
        said = log.stdout + log.stderr
        lines = solution.read_text().splitlines() if solution.exists() else []
    if re.search(r"Coin\d+W|### |read with [1-9]", said) or not lines:
        return f"not read: {said}"
    if "try without preprocessing" in said and not options:
        return by_cbc(path, "-preprocess", "off")
    # The status line rounds the value to fewer digits than the log.
    if found := re.match(r"Optimal - objective value (\S+)", lines[0]):
        exact = re.search(r"^Objective value:\s+(\S+)", said, re.MULTILINE)
        return float((exact or found)[1])
    return lines[0].split(" - ")[0].lower().removeprefix("integer ")


READERS: dict[str, Callable[[Path], Found]] = {
    "highs": by_highs,
    "scip": by_scip,
    "glpk": by_glpk,
    "cbc": by_cbc,
}


def found_in(paths: Sequence[Path], reader: str) -> list[Found]:
    """What `reader` finds in each of `paths`, in a process of its own."""
    command = [sys.executable, __file__, reader, *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = done.stdout.splitlines()
    if len(lines) != len(paths):
        raise AssertionError(f"{reader} read {len(lines)} of {len(paths)}: {done.stderr}")
    return [json.loads(line) for line in lines]


if __name__ == "__main__":
    for name in sys.argv[2:]:
        print(json.dumps(READERS[sys.argv[1]](Path(name))), flush=True)
