"""A study, its ledger, its missions and its outputs may be called anything."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from support.studies import kept

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study

NAMES = [
    "runs [2024]",
    "a*b?c",
    'it\'s "quoted"',
    "100% $HOME ${x} #1",
    "救援 Москва",
    " -dash and spaces ",
    "[!a]",
]
TEXT = 'title = "Anywhere"\n[[instances]]\nfiles = "*.json"\n[[planners]]\nplanner = "greedy"\n'


@pytest.mark.parametrize("name", NAMES)
def test_a_study_works_in_any_folder_under_any_name(
    name: str,
    tmp_path: Path,
    instances_dir: Path,
    msmrta: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
) -> None:
    folder = tmp_path / name
    folder.mkdir()
    mission = (instances_dir / "corridor.json").read_text(encoding="utf-8")
    (folder / f"{name}.json").write_text(mission, encoding="utf-8")
    path = folder / f"{name}.toml"
    path.write_text(TEXT, encoding="utf-8")
    assert msmrta("study", "run", path) == 0
    assert [record.instance for record in kept(path)] == ["corridor"]
    assert msmrta("study", "status", path) == 0
    outputs = {suffix: folder / f"{name} out.{suffix}" for suffix in ("csv", "parquet")}
    options = [part for suffix, file in outputs.items() for part in (f"--{suffix}", file)]
    assert msmrta("study", "export", path, *options) == 0
    assert all(file.stat().st_size for file in outputs.values())
    assert msmrta("study", "report", path, "--output", folder / f"{name} report") == 0
    assert (folder / f"{name} report" / "report.html").is_file()
    assert capsys.readouterr().err == ""


@pytest.fixture
def names(tmp_path: Path, instances_dir: Path) -> Callable[[str], list[str]]:
    """The missions that a study finds by a pattern, among some with odd names."""
    mission = Instance.read(instances_dir / "corridor.json")
    (tmp_path / "b [1]").mkdir()
    for name in ("a1", "a2", "a[1]", "b [1]/c"):
        mission.replace(name=name).save(tmp_path / f"{name}.json")
    path = tmp_path / "study.toml"

    def found(pattern: str) -> list[str]:
        path.write_text(TEXT.replace('"*.json"', json.dumps(pattern)), encoding="utf-8")
        return [run.mission.name for run in runs(Study.read(path))]

    return found


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("a[1].json", ["a[1]"]),  # the file of that name comes before the pattern
        ("a[12].json", ["a1", "a2"]),
        ("a?.json", ["a1", "a2"]),
        ("b [1]/*.json", ["b [1]/c"]),  # the pattern matches nothing, the name does
        ("**/*.json", ["a1", "a2", "a[1]", "b [1]/c"]),
    ],
)
def test_what_a_study_says_of_files_is_a_name_or_else_a_pattern(
    names: Callable[[str], list[str]], pattern: str, found: list[str]
) -> None:
    assert names(pattern) == found


def test_a_pattern_that_matches_nothing_is_refused(names: Callable[[str], list[str]]) -> None:
    with pytest.raises(InputError, match=r"'x\[1\]\.json' matches no file"):
        names("x[1].json")
