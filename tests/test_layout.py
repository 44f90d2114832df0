"""The house: which folder may know of which, no circle of files, no room too large.

An import counts wherever it stands: at the top, in a function, or for type checkers alone.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "msmrta_opt"
SHARED = {"arrays", "compiled", "interruption", "isolation", "public", "worker_process", "_version"}
"""Files that stand by themselves beside the folders; see `LEAVES`."""
MAY_USE = {
    "mission": set(),
    "certify": {"mission"},
    "plots": {"mission"},
    "formulations": set(),
    "optimise": {"formulations", "mission"},
    "proofs": {"certify", "optimise", "mission"},
    "diagnosis": {"proofs", "certify", "optimise", "mission"},
    "routing": {"proofs", "certify", "optimise", "mission"},
    "stages": {"routing", "optimise", "mission"},
    "planners": {"proofs", "certify", "stages", "routing", "optimise", "mission"},
    "execution": {"certify", "planners", "stages", "routing", "optimise", "mission"},
    "studies": {
        *("diagnosis", "proofs", "certify", "plots", "execution", "planners", "stages", "routing"),
        *("optimise", "mission"),
    },
    "cli": {
        *(
            "studies",
            "diagnosis",
            "proofs",
            "certify",
            "plots",
            "execution",
            "planners",
            "stages",
            "routing",
            "optimise",
        ),
        "mission",
    },
}
"""By folder, the folders that it may import from: always downwards."""
LEAVES = {"arrays": {"mission"}, "isolation": {"mission"}, "worker_process": {"mission"}}
"""By shared file, the folders that it may import from; the others import from none."""
MODELS_MAY_USE = {"msmrta_opt.optimise.formulation", "msmrta_opt.routing.problem"}
"""The contract of formulations."""
LARGEST_SHARE = 0.215
"""Of all lines, that one folder may hold: a fifth, and a little for the two largest."""


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {
    module_of(path): path for path in sorted(PACKAGE.rglob("*.py")) if "_shipped" not in path.parts
}


def imported(path: Path) -> Iterator[str]:
    """The modules of ours that a file imports."""
    name = module_of(path)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (x.name for x in node.names if x.name.split(".")[0] == "msmrta_opt")
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) + 1 - node.level]
            base = ".".join([*(above if node.level else []), *filter(None, [node.module])])
            if base.split(".")[0] == "msmrta_opt":
                inside = (f"{base}.{x.name}" for x in node.names)
                yield from (x if x in FILES else base for x in inside)


def folder_of(module: str) -> str:
    return module.partition(".")[2].partition(".")[0]


def arrows() -> Iterator[tuple[str, str]]:
    for module, path in FILES.items():
        # The table of public names, for type checkers, and the command line as a module.
        if module not in ("msmrta_opt", "msmrta_opt.__main__"):
            yield from ((module, target) for target in imported(path) if target != module)


def test_every_folder_has_its_place() -> None:
    there = {path.name for path in PACKAGE.iterdir() if path.is_dir() and any(path.glob("*.py"))}
    assert there - {"_shipped"} == set(MAY_USE)
    assert {path.stem for path in PACKAGE.glob("*.py")} - {"__init__", "__main__"} == SHARED


def test_arrows_run_one_way() -> None:
    wrong = []
    for module, target in arrows():
        here, there = folder_of(module), folder_of(target)
        allowed = MAY_USE.get(here, set()) | ({here} | SHARED if here in MAY_USE else set())
        allowed |= LEAVES.get(here, set()) | (
            SHARED if here in ("isolation", "worker_process") else set()
        )
        if there not in allowed:
            wrong.append(f"{module} imports {target}")
    assert wrong == []


def test_folders_are_in_an_order() -> None:
    """That is, none of those that a folder may use may use it."""
    assert nx.is_directed_acyclic_graph(nx.DiGraph((a, b) for a in MAY_USE for b in MAY_USE[a]))


def test_no_circle_of_files() -> None:
    graph = nx.DiGraph(arrows())
    assert [group for group in nx.strongly_connected_components(graph) if len(group) > 1] == []


def test_formulations_know_the_contract_alone() -> None:
    used = {target for path in (ROOT / "models").glob("*.py") for target in imported_by_model(path)}
    assert used <= MODELS_MAY_USE


def imported_by_model(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("msmrta_opt"):
            yield node.module or ""


def test_no_folder_holds_more_than_a_fifth_of_the_code() -> None:
    lines: Counter[str] = Counter()
    for module, path in FILES.items():
        lines[folder_of(module)] += len(path.read_text(encoding="utf-8").splitlines())
    models = (ROOT / "models").glob("*.py")
    lines["models"] = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in models)
    total = sum(lines.values())
    shares = {name: count / total for name, count in lines.items()}
    assert {name: share for name, share in shares.items() if share > LARGEST_SHARE} == {}


@pytest.mark.parametrize(
    "module",
    [
        *(
            "mission",
            "diagnosis",
            "execution",
            "execution/policies",
            "planners",
            "planners/support",
            "stages",
            "plots",
        ),
        "plots/replay",
        *("studies", "studies/analysis", "studies/report"),
    ],
)
def test_a_folder_says_in_what_order_to_read_it(module: str) -> None:
    """Every file and folder in it is named in the docstring of its ``__init__``, in backquotes."""
    said = ast.get_docstring(ast.parse((PACKAGE / module / "__init__.py").read_text())) or ""
    inside = {
        path.stem
        for path in (PACKAGE / module).iterdir()
        if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    assert [name for name in sorted(inside - {"__init__"}) if f"`{name}`" not in said] == []
