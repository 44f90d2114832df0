"""The project as it is installed: from a checkout, in place, and as a wheel."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OWN_MODEL = (
    (ROOT / "models" / "cluster_one_to_one.py")
    .read_text()
    .replace("SPEC = Spec(", "SPEC = Spec(  # a copy under another name")
)


def python(code: str, *, path: Path | None, cwd: Path, **environment: str) -> str:
    """The output of `code` in a fresh interpreter, with `path` first on its import path."""
    variables = {**os.environ, **environment, "PYTHONPATH": str(path or "")}
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=cwd,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    # Built from a copy, so that no build folder of the checkout can lend it a stale file.
    for name in listed.stdout.splitlines():
        if name.startswith(("msmrta_opt/", "models/", "instances/")) or "/" not in name:
            target = source / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((ROOT / name).read_bytes())
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", out, source],
        check=True,
        capture_output=True,
    )
    (built,) = out.glob("*.whl")
    return built


@pytest.fixture(scope="session")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    site = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    # What is compiled here is not compiled again there: it goes by the time of its source.
    for index in (ROOT / "msmrta_opt").rglob("*.nbi"):
        name = f"{index.name.partition('.')[0]}.py"
        source = index.parents[1] / name
        copy = site / source.relative_to(ROOT)
        if copy.exists() and copy.read_bytes() == source.read_bytes():
            shutil.copytree(index.parent, copy.parent / "__pycache__", dirs_exist_ok=True)
            os.utime(copy, ns=(source.stat().st_atime_ns, source.stat().st_mtime_ns))
    return site


def test_the_wheel_carries_models_instances_maps_and_the_parts_of_pages(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder, pattern in (
        ("models", "*.py"),
        ("instances", "*.json"),
        ("instances", "maps/*"),
        ("instances", "suite/*"),
    ):
        shipped = {
            f"msmrta_opt/_shipped/{path.relative_to(ROOT)}"
            for path in (ROOT / folder).glob(pattern)
        }
        assert shipped
        assert shipped <= names
    assert "msmrta_opt/py.typed" in names
    parts = {
        f"msmrta_opt/{path.relative_to(ROOT / 'msmrta_opt')}"
        for kind in ("html", "css", "js", "jinja")
        for path in (ROOT / "msmrta_opt").rglob(f"*.{kind}")
    }
    assert len(parts) > 10
    assert parts <= names
    assert not any(name.startswith(("tests/", "models/", "instances/")) for name in names)


USE_IT = """
import sys
import msmrta_opt as mo, numpy as np, pytest
from msmrta_opt.cli import run
from msmrta_opt.optimise import registry
if __name__ == '__main__':
    assert mo.plan(mo.example('paper')).metrics.served_share == 1.0
    assert 'cluster_mine' in [item.name for item in registry.listings('cluster')]
    data = mo.ClusterData(np.array([[1., 4.], [2., 3.]]), np.zeros((2, 2)), np.array([1, 1]))
    assert mo.solve('cluster_mine', data, psi=0.0).require().objective == 6.0
    compared = ['--models', 'cluster_mine', '--solvers', 'auto,highs', '--no-scores']
    assert run(['compare', 'small.json', *compared, '--json', 'rows.json']) == 0
    assert run(['export', 'cluster_mine', 'small.json', '-o', 'mine.mps']) == 0
    print(mo.__file__)
    sys.exit(pytest.main(sys.argv[1:]))
"""
"""The mission is the installation's own; the contract that comes last is held by the tests named."""


@pytest.mark.parametrize("where", ["in place", "wheel"])
def test_its_own_mission_is_planned_and_a_new_file_listed_solved_compared_exported_and_checked(
    where: str, installed: Path, tmp_path: Path
) -> None:
    # "in place" is the editable install in which the tests run; the tour of the README runs in a
    # checkout on the path.
    own = tmp_path / "own"
    own.mkdir()
    (own / "cluster_mine.py").write_text(OWN_MODEL)
    (tmp_path / "small.json").write_bytes((ROOT / "instances" / "two_rooms.json").read_bytes())
    (tmp_path / "use_it.py").write_text(USE_IT)
    path = installed if where == "wheel" else None
    contract = str(ROOT / "tests" / "models" / "test_formulations.py")
    quietly = ["-q", "-p", "no:cacheprovider", "-k", "cluster_mine", contract]
    words = [*quietly, "--rootdir", str(ROOT), "-c", str(ROOT / "pyproject.toml")]
    code = (
        f"import runpy, sys; sys.argv = {['use_it.py', *words]!r};"
        "runpy.run_path('use_it.py', run_name='__main__')"
    )
    output = python(code, path=path, cwd=tmp_path, MSMRTA_MODELS=str(own))
    used, tested = output.split("__init__.py\n")
    package = Path(used.splitlines()[-1]).parent
    assert package == (installed if where == "wheel" else ROOT)
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["status"] for row in rows] == ["optimal", "optimal"]
    assert (tmp_path / "mine.mps").stat().st_size > 0
    assert " passed" in tested


def test_importing_the_package_loads_none_of_its_dependencies(tmp_path: Path) -> None:
    code = (
        "import sys, msmrta_opt, msmrta_opt.cli;"
        "heavy = {'cvxpy', 'numpy', 'pandas', 'scipy', 'sklearn', 'networkx', 'matplotlib', 'pydantic'};"
        "print(sorted(heavy & set(sys.modules)))"
    )
    assert python(code, path=ROOT, cwd=tmp_path).strip() == "[]"


def test_every_public_name_can_be_loaded() -> None:
    import msmrta_opt

    for name in msmrta_opt.__all__:
        assert getattr(msmrta_opt, name) is not None


def test_an_unknown_public_name_is_an_attribute_error() -> None:
    import msmrta_opt

    with pytest.raises(AttributeError, match="no_such_name"):
        _ = msmrta_opt.no_such_name
