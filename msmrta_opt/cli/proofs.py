"""Proofs on the command line: the command checker, and what solve, check and compare share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from ..optimise.registry import Formulation
    from ..optimise.solution import Solution
    from ..proofs.prove import Proof
    from ..studies.proving import Verdict
    from ..studies.record import Record

SUFFIX = ".vipr"


def register(app: typer.Typer) -> None:
    """Add this file's command to `app`."""
    app.command()(checker)


def checker() -> None:
    """Print the checker of proofs, a single file that needs nothing but Python.

    msmrta checker > check.py, then: python check.py FILE.vipr
    """
    from importlib.resources import files

    typer.echo((files("msmrta_opt.certify") / "vipr.py").read_text(encoding="utf-8"), nl=False)


def require_suffix(path: Path | None) -> None:
    """Refuse a proof's file of another suffix."""
    from ..mission.errors import InputError

    if path is not None and path.suffix != SUFFIX:
        raise InputError(f"{str(path)!r}; the suffix is {SUFFIX}", field="--proof")


def proved(
    solution: Solution,
    what: str | Formulation,
    data: Any,
    path: Path,
    time_limit: float,
    parameters: dict[str, Any],
) -> Proof:
    """Prove what `solution` says, say what came of it, and give it back."""
    from ..proofs.prove import prove

    found = prove(what, data, path=path, solution=solution, time_limit=time_limit, **parameters)
    say_proof(str(path), found)
    return found


def say_proof(name: str, proof: Proof) -> None:
    """What was proved, in a line; what is contradicted, in red."""
    from .console import console, say

    say(f"{name}: {proof.summary}")
    if proof.contradiction:
        text = f"contradicted: {proof.claimed_by}: {proof.contradiction}"
        console().print(text, style="bold red", markup=False)


def held_against(verdicts: Sequence[Verdict], rows: Sequence[Record]) -> list[Record]:
    """The records, those that a proof contradicts with that as the verdict of their check."""
    from dataclasses import replace

    wrong = {id(row): what for verdict in verdicts for row, what in verdict.contradicted}
    return [
        replace(row, check=f"contradicted: {wrong[id(row)]}") if id(row) in wrong else row
        for row in rows
    ]


def show_verdicts(verdicts: Sequence[Verdict]) -> None:
    """What was proved of each program, and in red which solvers that contradicts."""
    from .console import console, table

    if verdicts:
        table(
            "Proofs (leaves of the tree, kB, seconds to find and to check)",
            [
                "instance",
                "model",
                "status",
                "value",
                "bound",
                "leaves",
                "kB",
                "find",
                "check",
                "why",
            ],
            [
                (verdict.instance, verdict.model, *_told(verdict.proof), verdict.reason)
                for verdict in verdicts
            ],
        )
    for verdict in verdicts:
        for row, what in verdict.contradicted:
            text = f"contradicted: {row.solver} on {row.model}, {row.instance}: {what}"
            console().print(text, style="bold red", markup=False)


def _told(proof: Proof | None) -> tuple[object, ...]:
    if proof is None:
        return "none", None, None, None, None, None, None
    size, spent = f"{proof.size / 1e3:.1f}", (proof.seconds, proof.check_seconds)
    return proof.status, proof.value, proof.bound, proof.leaves, size, *(f"{s:.2f}" for s in spent)


def check_proofs(
    files: Sequence[Path], options: list[str] | None, params: list[str] | None
) -> None:
    """Check proofs; one that a program follows, as `solve` takes it, must be of that program."""
    from ..mission.errors import CheckError, InputError
    from ..proofs.stated import check_proof
    from .subjects import asked

    proofs = [file for file in files if file.suffix == SUFFIX]
    rest = list(files[len(proofs) :])
    if list(files[: len(proofs)]) != proofs or len(rest) > 2 or (rest and len(proofs) != 1):
        raise InputError(
            "give proofs alone, or one proof and a formulation with its instance or a file"
        )
    if not rest and (options or params):
        raise InputError(
            "is for a formulation; give FILE.vipr, the formulation and the instance",
            field="--param" if params else "--option",
        )
    what: Any = None
    data: Any = None
    values: dict[str, Any] = {}
    if rest:
        instance = rest[1] if len(rest) == 2 else None
        what, data, values = asked(str(rest[0]), instance, params, options, None)
    failed = False
    for file in proofs:
        try:
            claim = check_proof(file, what, data, **values)
        except CheckError as error:
            typer.echo(str(error), err=True)
            failed = True
        else:
            of = f", of {' on '.join(map(str, rest))}" if rest else ""
            typer.echo(f"{file}: proved: {claim}{of}")
    if failed:
        raise typer.Exit(1)
