"""What HiGHS, SCIP, GLPK and CBC read in our files is the program that was written."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.other_readers import READERS, Found, found_in
from support.programs import INF, best_value, program

from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.export import export, write_program
from msmrta_opt.optimise.formats.written import RESERVED
from msmrta_opt.optimise.program import Block, Program, Sense
from msmrta_opt.optimise.solve import solve
from msmrta_opt.stages.data import stage_data

Trial = tuple[Program, float | None]
"""A program and its optimum, ``None`` if there is no feasible point."""
Wanted = dict[Path, Any]
"""By file, what is to be found in it."""


def expected(best: float | None, sense: Sense, suffix: str) -> Any:
    """What is to be found where `best` is meant; in an MPS file a maximisation is negated."""
    if best is None:
        return "infeasible"
    negated = sense == "max" and suffix == ".mps"
    return pytest.approx(-best if negated else best, rel=1e-6, abs=1e-6)


def written(trials: Iterable[Trial], folder: Path) -> Wanted:
    wanted = {}
    for number, (trial, best) in enumerate(trials):
        for suffix in (".mps", ".lp"):
            path = folder / f"trial_{number}{suffix}"
            write_program(trial, path)
            wanted[path] = expected(best, trial.sense, suffix)
    return wanted


@pytest.fixture(scope="module")
def files(
    tmp_path_factory: pytest.TempPathFactory, paper: Instance, instances_dir: Path
) -> dict[str, Wanted]:
    """Files of each kind."""
    draw = random.Random(7)
    drawn = [random_program(draw) for _ in range(80)]
    kinds: dict[str, Callable[[Path], Wanted]] = {
        "random": lambda folder: written([(trial, best_value(trial)) for trial in drawn], folder),
        "features": lambda folder: written(features(), folder),
        "scaled": lambda folder: written(scaled(), folder),
        "names": lambda folder: written(named(), folder),
        "formulations": lambda folder: formulations(paper, instances_dir, folder),
    }
    return {kind: make(tmp_path_factory.mktemp(kind)) for kind, make in kinds.items()}


@pytest.fixture(scope="module", params=READERS)
def found(request: pytest.FixtureRequest, files: dict[str, Wanted]) -> dict[Path, Found]:
    """What a reader finds in all files."""
    paths = [path for wanted in files.values() for path in wanted]
    return dict(zip(paths, found_in(paths, request.param), strict=True))


def assert_found(found: dict[Path, Found], wanted: Wanted) -> None:
    for path, value in wanted.items():
        assert found[path] == value, path.read_text()


def test_the_optimum_of_random_programs_is_that_of_all_their_points(
    found: dict[Path, Found], files: dict[str, Wanted]
) -> None:
    assert_found(found, files["random"])


def test_senses_constants_ranges_and_bounds_of_all_kinds_are_read_as_they_are_meant(
    found: dict[Path, Found], files: dict[str, Wanted]
) -> None:
    assert_found(found, files["features"])


def test_coefficients_beyond_what_solvers_keep_reach_them_all_the_same(
    found: dict[Path, Found], files: dict[str, Wanted]
) -> None:
    assert_found(found, files["scaled"])


def test_no_name_is_taken_for_anything_else(
    found: dict[Path, Found], files: dict[str, Wanted]
) -> None:
    assert_found(found, files["names"])


def test_every_formulation_has_its_optimum_in_the_file(
    found: dict[Path, Found], files: dict[str, Wanted]
) -> None:
    assert_found(found, files["formulations"])


def random_program(draw: random.Random) -> Program:
    """A pure integer program with finite bounds, and rows of all kinds."""

    def numbers(n: int) -> list[float]:
        return draw.choices([0, 0, 0, 1, 1, 2, -1, -3, 1 / 3, -2.5, 0.1, 1e5 / 3], k=n)

    n_columns, n_rows = draw.randint(1, 4), draw.randint(0, 4)
    low = np.array(draw.choices(range(-3, 3), k=n_columns))
    sides = []
    for _ in range(n_rows):
        side = draw.randint(-6, 3)
        wider = side + draw.randint(1, 6)
        sides.append(draw.choice([(side, side), (-INF, side), (side, INF), (side, wider)]))
    matrix = np.array(numbers(n_rows * n_columns)).reshape(n_rows, n_columns)
    row_lower, row_upper = np.array(sides, dtype=float).reshape(n_rows, 2).T
    return program(
        matrix,
        row_upper,
        numbers(n_columns),
        row_lower=row_lower,
        lower=low,
        upper=low + draw.choices(range(4), k=n_columns),
        sense=draw.choice(["min", "max"]),
        offset=numbers(1)[0],
    )


def by_hand(sense: Sense) -> Program:
    """3 a + 2 b - c + d / 2 + 10 with a ≤ 1 binary, b integer, c free, d ≤ -1, and four rows.

    a + b ≤ 4;  1 ≤ b ≤ 3;  c - b = 0.5;  d ≥ -6.  So c = b + 0.5, and the objective is
    3 a + b + d / 2 + 9.5: least at a = 0, b = 1, d = -6, where it is 7.5, and largest at a = 1,
    b = 3, d = -1, where it is 15.
    """
    return program(
        [[1, 1, 0, 0], [0, -1, 0, 0], [0, -1, 1, 0], [0, 0, 0, -1]],
        [4, -1, 0.5, 6],
        [3, 2, -1, 0.5],
        row_lower=[-INF, -3, 0.5, -INF],
        lower=[0, -INF, -INF, -INF],
        upper=[1, INF, INF, -1],
        integer=[True, True, False, False],
        sense=sense,
        offset=10,
    )


def one_bounded_by(low: float, high: float, *, integer: bool) -> list[Trial]:
    """The least and the greatest value of a variable, of which -40.5 ≤ 2 x ≤ 40.5 is asked."""
    within = max(low, -20.25), min(high, 20.25)
    ends = (np.ceil(within[0]), np.floor(within[1])) if integer else within
    minimum = program([[2]], 40.5, [1], row_lower=-40.5, lower=low, upper=high, integer=integer)
    return [(minimum, float(ends[0])), (replace(minimum, sense="max"), float(ends[1]))]


def features() -> list[Trial]:
    trials: list[Trial] = [(by_hand("min"), 7.5), (by_hand("max"), 15.0)]
    for low in (-INF, -3, 0, 1, 2):
        for high in (INF, 0, -3, -1, 1, 4):
            for integer in (True, False):
                if low <= high:
                    trials += one_bounded_by(low, high, integer=integer)
    trials += [
        # No rows, no variable in a row, no cost, a row without coefficients that holds or not.
        (program(np.zeros((0, 2)), [], [1, -1], offset=-2.5), -3.5),
        (program(np.zeros((1, 2)), [0], [1, -1], row_lower=-1, sense="max", offset=-2.5), -1.5),
        (program([[1, 1]], [1], [0, 0], offset=0.5), 0.5),
        (program([[0, 0], [1, 1]], [INF, 2], [1, 1], row_lower=[-1, 0]), 0.0),
        (program([[0, 0], [1, 1]], [INF, 2], [1, 1], row_lower=[1, 0]), None),
    ]
    return trials


def scaled() -> list[Trial]:
    return [
        # At least a second in nanoseconds; a picosecond; a rate of 1e16 a year.
        (program([[1e-9]], INF, [1], row_lower=1, upper=1e12), 1e9),
        (program([[1e-12, 0]], INF, [1, 0], row_lower=1e-9, upper=1e12), 1e3),
        (program([[1e16, 2e16]], 3e16, [1, 1], sense="max"), 2.0),
        (program([[3e15, 2e15]], 4e15, [1, 1], sense="max"), 1.0),
    ]


LIKE_WORDS = """
    infinity1 infx nanx freedom bound1 boundsX general_manager min_load max_load stock st.x subject_to
    such_that sos1x semifinal integers2 binaryx to that maxi Maximize1 minimum_ endurance e1 E5x each
    x.1 x,2 x(1) (a) .b 9 objx obj_ rhsx lo up RHS BND BOUND R1 C1 c1 N G L E UP LO FX FR MI PL BV rng
    INTORG lazy_cut user.cut sin_1 section objective_constant no_rows MARKER objective_constant_2
""".split()  # noqa: SIM905 - a list of as many strings reads worse


def named() -> Iterator[Trial]:
    # min x + 2 y with x + y ≤ 1.5, x - y ≤ 0.5, x binary, y ≥ -3: -1 at x = 0, y = -0.5.
    plain = program(
        [[1, 1], [1, -1]], [1.5, 0.5], [1, 2], lower=[0, -3], upper=[1, INF], integer=[True, False]
    )
    for word in (*LIKE_WORDS, *sorted(RESERVED), "l" * 300):
        pair = (Block(word, 0, ()), Block("other", 1, ()))
        yield replace(plain, columns=pair, rows=pair), -1.0


def formulations(paper: Instance, instances: Path, folder: Path) -> Wanted:
    """Every formulation on the paper's mission, and one for two values of its parameter."""
    small = Instance.read(instances / "corridor.json")
    wanted = {}
    for name, given in [
        *((listing.name, {}) for listing in registry.listings()),
        ("cluster_printed", {"psi": 0.0}),
        ("cluster_printed", {"psi": 1.0}),
    ]:
        formulation = registry.get(name)
        stage = formulation.spec.stage
        # Of the whole mission's routes GLPK does not find the end.
        data = stage_data(small if stage == "routing" else paper, stage)
        best = solve(formulation, data, **given).require()
        for suffix in (".mps", ".lp"):
            path = folder / f"{name}{''.join(map(str, given.values()))}{suffix}"
            export(formulation, data, path, **given)
            wanted[path] = expected(best.objective, best.sense, suffix)
    return wanted


def test_parameters_are_those_asked_for(files: dict[str, Wanted], paper: Instance) -> None:
    # Of two readings of ψ only one counts everything that is met, the other what is met in full.
    data = stage_data(paper, "cluster")
    by_name = {path.name: value for path, value in files["formulations"].items()}
    for psi, worth in {0.0: data.w, 1.0: data.w_full}.items():
        assert by_name[f"cluster_printed{psi}.lp"] == float(worth.max(axis=0).sum())


@pytest.mark.parametrize(
    ("name", "best"),
    [
        ("cluster_one_to_one", 6.15),
        ("cluster_printed", 6.25),
        ("cluster_distance", 2.35),
        ("victim_balanced", 530 / 3),
        ("victim_bottleneck", 156.25),
        ("victim_one_to_one", 1340 / 3),
    ],
)
def test_what_is_sought_in_the_papers_files_is_its_optimum(
    name: str, best: float, files: dict[str, Wanted]
) -> None:
    """Maxima for clusters, which an MPS file negates; minima for victims, the relaxation's below."""
    by_name = {path.name: value for path, value in files["formulations"].items()}
    assert by_name[f"{name}.lp"] == best
    assert by_name[f"{name}.mps"] == (-best if name.startswith("cluster") else best)
