"""Everything that the README shows is run here, and its picture is the demo's own."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.testing.compare import compare_images

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    """The code blocks of the README in `language`."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


SHELL = [line for block in blocks("sh") for line in block.splitlines() if line]
MSMRTA = [line for line in SHELL if line.startswith("msmrta ")]
MAKE = [line for line in SHELL if line.startswith("make ")]


def run(command: str, cwd: Path) -> str:
    """The output of a shell command, run with this environment's programs first."""
    programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command,
        shell=True,
        cwd=cwd,
        env={**os.environ, "PATH": programs},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the README's commands find in a checkout, and may write into."""
    folder = tmp_path_factory.mktemp("readme")
    for name in ("instances", "models", "msmrta_opt", "pyproject.toml", "studies"):
        if (ROOT / name).is_dir():
            # With what is compiled: the copy need not compile it again.
            shutil.copytree(ROOT / name, folder / name)
        elif (ROOT / name).exists():
            shutil.copy(ROOT / name, folder / name)
    # The smallest missions of the study will do here: all of them take minutes.
    study = folder / "studies" / "paper_small.toml"
    text = study.read_text(encoding="utf-8")
    for all_of_them, few in {"[2, 4, 8]": "[2]", "[10, 20, 30]": "[10]"}.items():
        assert all_of_them in text
        text = text.replace(all_of_them, few)
    study.write_text(text, encoding="utf-8")
    return folder


def test_every_command_of_the_readme_is_of_a_kind_that_is_run() -> None:
    assert MSMRTA
    assert sorted(MSMRTA + MAKE) == sorted(SHELL)
    assert MAKE == ["make demo", "make test"]


TOUR = """
import shlex, sys
import msmrta_opt
from msmrta_opt.cli import run
for text in sys.argv[1:]:
    print("$", text.splitlines()[0], flush=True)
    if not text.startswith("msmrta "):
        exec(text, {"__name__": "__main__"})
    elif status := run(shlex.split(text)[1:]):
        sys.exit(f"{text}: exit status {status}")
print(msmrta_opt.__file__)
"""
"""All commands and blocks of code in one process, which imports once what they stand on."""


def test_the_commands_and_the_python_of_the_tour_work_in_their_order(workplace: Path) -> None:
    first, tour = blocks("python")
    assert len([line for line in first.splitlines() if line.strip()]) == 5
    arguments = shlex.join([sys.executable, "-c", TOUR, *MSMRTA, first, tour])
    output = run(f"PYTHONPATH=. {arguments}", workplace)
    assert [line for line in output.splitlines() if line.startswith("$ ")] == [
        f"$ {text.splitlines()[0]}" for text in (*MSMRTA, first, tour)
    ]
    *_, shown_by_first, shown_by_tour = output.split("\n$ ")
    assert "1.0 " in shown_by_first
    assert (workplace / "plan.png").is_file()
    assert "PlanDifference(msmrta → ssi: " in shown_by_tour
    assert "Comparison(1 solve: 1 optimal)" in shown_by_tour
    assert output.endswith(f"{workplace / 'msmrta_opt' / '__init__.py'}\n")  # the copied checkout


def recipe(target: str) -> str:
    """The commands of a make target, without the installation."""
    printed = subprocess.run(
        ["make", "--dry-run", "--always-make", "--no-print-directory", target, "VENV=THE_VENV"],
        cwd=ROOT,
        # Run from `make test`, it would take that one's flags for its own.
        env={name: value for name, value in os.environ.items() if not name.startswith("MAKE")},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    return "\n".join(
        line.replace("THE_VENV/bin/", "")
        for line in printed.splitlines()
        if "-m venv" not in line and "pip install" not in line and "touch" not in line
    )


def test_make_demo_plans_the_mission_and_draws_the_picture_of_the_readme(workplace: Path) -> None:
    commands = recipe("demo")
    assert "msmrta plan instances/paper.json" in commands
    output = run(commands, workplace)
    assert "picture written to out/paper.png" in output
    assert "docs/paper.png" in README
    difference = compare_images(
        str(ROOT / "docs" / "paper.png"), str(workplace / "out" / "paper.png"), tol=5
    )
    assert difference is None, difference


def test_make_test_checks_style_types_and_tests() -> None:
    commands = recipe("test")
    for program in ("ruff check", "ruff format --check", "mypy", "pytest"):
        assert program in commands
