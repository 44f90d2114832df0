"""Records of solvers: what is missing is refused, what is there is loaded late or in its own process."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys

import pytest
from support.programs import INF, assert_solved_right, program
from support.solver_contract import (
    COMMERCIAL,
    FREE,
    KNOWN,
    record,
    solve,
)

from msmrta_opt.mission.errors import InputError, SolverError
from msmrta_opt.optimise.solvers import Options, apart, get, solvers
from msmrta_opt.optimise.solvers.highs import new_highs


def test_integer_and_continuous_programs_are_refused_by_name() -> None:
    with pytest.raises(SolverError, match="solver trial cannot do integer programs"):
        record().solve(KNOWN["general integers"].asked, Options())
    with pytest.raises(SolverError, match="solver trial cannot do continuous variables"):
        record(abilities=frozenset(["integer"])).solve(
            KNOWN["integer and continuous"].asked, Options()
        )


@pytest.mark.parametrize("module", ["no_such_module", "no_such_package.module"])
def test_a_solver_that_is_not_installed_says_how_to_install_it(module: str) -> None:
    absent = record(module=module)
    assert not absent.installed
    assert absent.version == ""
    with pytest.raises(SolverError, match="solver trial is not installed; pip install trial"):
        absent.solve(KNOWN["general integers"].asked, Options())


def test_a_solver_without_its_licence_is_not_installed() -> None:
    assert not record(available=lambda: False).installed


def test_an_unknown_solver_is_an_error_that_names_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"no solver 'simplex'; there are auto, highs, scip"):
        get("simplex")


def test_what_highs_prints_when_it_is_made_is_not_shown(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def made() -> object:
        os.write(1, b"Running HiGHS, with its notices")
        raise RuntimeError("a fault of the library")

    monkeypatch.setattr("highspy.Highs", made)
    with pytest.raises(RuntimeError, match="a fault of the library"):
        new_highs()
    os.write(1, b"and then")
    assert capfd.readouterr().out == "and then"


def test_records_are_complete() -> None:
    assert set(solvers()) == {*FREE, *COMMERCIAL, "lsa"}
    for name, known in solvers().items():
        assert known.name == name
        assert known.title
        assert known.install.startswith("pip install ")
        assert known.abilities & {"integer", "lp"}


def in_new_process(code: str) -> str:
    path = f"import sys; sys.path[:] = {sys.path!r}\n"
    done = subprocess.run(
        [sys.executable, "-c", path + code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_nothing_is_imported_until_a_solver_is_asked_to_solve() -> None:
    modules = {known.module for known in solvers().values()} - {"scipy"}
    code = (
        "from msmrta_opt.optimise.solvers import solvers\n"
        "_ = [(s.installed, s.package_version) for s in solvers().values()]\n"
        f"print([name for name in {sorted(modules)} if name in sys.modules])\n"
    )
    assert in_new_process(code) == "[]"


def test_solvers_that_bring_the_same_library_work_side_by_side() -> None:
    asked = pickle.dumps(KNOWN["general integers"].asked)
    code = (
        "import pickle\n"
        "from msmrta_opt.optimise.solvers import Options, get\n"
        f"asked = pickle.loads({asked!r})\n"
        "print([round(get(name).solve(asked, Options()).bound) for name in ('cpsat', 'highs')])\n"
    )
    assert in_new_process(code) == "[20, 20]"


def test_the_assignment_algorithm_takes_assignments_and_nothing_else() -> None:
    pairs = program(
        [[1, 1, 0, 0], [0, 0, 1, 1], [1, 0, 1, 0], [0, 1, 0, 1]],
        1,
        [4, 1, 2, 3],
        row_lower=[1, 1, -INF, -INF],
    )
    assert_solved_right(solve(get("lsa"), pairs), 3)
    assert solve(get("lsa"), KNOWN["general integers"].asked).status == "skipped"


def test_a_solver_whose_process_dies_is_an_error_and_the_next_request_is_served() -> None:
    with pytest.raises(SolverError, match="process ended with exit status 3"):
        apart.run_apart(exec, "import os; os._exit(3)", {})  # type: ignore[arg-type]
    assert_solved_right(solve(get("glpk"), KNOWN["general integers"].asked), 20)


def test_an_exception_in_the_process_is_an_error_that_says_what_it_was() -> None:
    with pytest.raises(SolverError, match="ZeroDivisionError: division by zero"):
        apart.run_apart(exec, "1 / 0", {})  # type: ignore[arg-type]
