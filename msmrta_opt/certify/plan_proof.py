"""What a proof proves of a plan: of its total time or makespan (`joint_proof`), or its latency."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..mission.errors import CheckError, InputError
from ..mission.plan import Plan
from ..mission.proof import LatencyTree
from ..mission.validation import read_model
from .joint_proof import check_joint_proof
from .latency_proof import check_latency_proof
from .verdict import Verdict

TREE = ".json"
"""Suffix of the proof of a latency; the others are VIPR certificates."""


def digest_of(path: str | Path) -> str:
    """The SHA-256 of a proof's file, by which a plan names it.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", file=path) from None


def check_plan_proof(path: str | Path, plan: Plan) -> Verdict:
    """Check a proof of `plan`, which passes its own check (`certify.plan.problems`).

    Parameters
    ----------
    path : path
        The proof: in VIPR 1.0, or in JSON if it is of a latency.
    plan : Plan
        With the mission and the limits that it should be about.

    Raises
    ------
    InputError
        If the file cannot be read.
    CheckError
        If it proves nothing about the plan; of a certificate with the line at which it fails.
    """
    if Path(path).suffix != TREE:
        return check_joint_proof(path, plan)
    proof = read_model(LatencyTree, path)
    try:
        return check_latency_proof(proof, plan)
    except CheckError as error:
        raise CheckError(f"{path}: {error}") from None
