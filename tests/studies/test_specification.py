"""A study file is read whole, or refused in one line that says where."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.studies import write_study

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study

SOUND = """
title = "Sound"
[[instances]]
maps = "open.map"
robots = [1, 2]
victims = 3
kinds = 3
seeds = [0, 1]
[[planners]]
planner = "greedy"
"""


def test_every_combination_is_a_run(tmp_path: Path) -> None:
    text = SOUND + (
        '[[planners]]\nname = "staged"\npsi = [0.1, 0.9]\nseed = [0, 1, 2]\n'
        '[[formulations]]\nstage = "cluster"\nmodels = ["cluster_printed", "cluster_fair"]\n'
        'solvers = ["auto", "highs"]\n'
    )
    todo = runs(Study.read(write_study(tmp_path, text)))
    # 2 robot counts × 2 seeds; greedy, 2 ψ × 3 seeds of the staged planner, 2 models × 2 solvers.
    assert len(todo) == 4 * (1 + 6 + 4)
    assert len({run.key for run in todo}) == len(todo)
    assert list(dict.fromkeys(run.contender for run in todo)) == [
        "greedy",
        "staged, psi = 0.1",
        "staged, psi = 0.9",
        *(f"{m} by {s}" for m in ("cluster_printed", "cluster_fair") for s in ("auto", "highs")),
    ]


def test_files_are_found_from_the_studys_folder_and_each_once(tmp_path: Path) -> None:
    from msmrta_opt import generate_mission, read_map

    path = write_study(
        tmp_path,
        'title = "Files"\n[[instances]]\nfiles = ["a*.json", "ab.json"]\n[[planners]]\n',
    )
    grid = read_map(tmp_path / "open.map")
    for name in ("ab", "aa"):
        mission = generate_mission(grid, 1, 1, seed=0, solvable=False).replace(name=name)
        mission.save(tmp_path / f"{name}.json")
    assert [run.instance.name for run in runs(Study.read(path))] == ["aa", "ab"]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("title =", "titel ="), "title: is missing"),
        (('"greedy"', '"greedi"'), "planners[0].planner: 'greedi' (did you mean 'greedy'?)"),
        (('"greedy"', '"greedy"\npsi = 0.5'), "planners[0].psi: planner greedy has no such option"),
        (('"greedy"', '"greedy"\nseed = 9223372036854775808'), "planners[0].seed: 922337203685"),
        (('"greedy"', '"greedy"\nseed = -1'), "planners[0].seed: -1; give a whole number, 0 to"),
        (
            ('"greedy"', '"greedy"\nseed = true'),
            "planners[0].seed: True; give a whole number, 0 to",
        ),
        (('"greedy"', '"mrga"\nalpha = "1"'), "planners[0].alpha: '1'; give a number from 0 to 1"),
        (
            ('"greedy"', '"exact"\ntime_limit = "5"'),
            "planners[0].time_limit: '5'; give a number, 0",
        ),
        (('"greedy"', '"exact"\nendurance = "5"'), "planners[0].endurance: '5'; give time units"),
        (('"greedy"', '"msmrta"\npsi = 1.5'), "planners[0].psi: 1.5; give a number from 0 to 1"),
        (('"greedy"', '"msmrta"\npsi = []'), "psi: no value; give at least one"),
        (('"greedy"', '"msmrta"\npsi = [[1]]'), "psi: [1]; give a number, a text, true or false"),
        (("robots = [1, 2]", "robots = [0]"), "instances[0].robots[0]: 0; give a number above 0"),
        (("robots = [1, 2]", ""), "instances[0].robots: is missing"),
        (("victims = 3", "victims = 3.5"), "instances[0].victims[0]: 3.5; give a whole number"),
        (("victims = 3", "victims = 3\nseed = 1"), "instances[0].seed: 1; there is no such field"),
        (('"open.map"', '"shut.map"'), "shut.map"),
        (('"open.map"', '"maze"'), "instances[0].size: missing; map maze needs one"),
        (("victims = 3", "victims = 3\nsize = [9, 9]"), "instances[0].size: not for map"),
        (("victims = 3", "victims = 3\nunreachable = 2"), "instances[0].unreachable: 2;"),
        (("victims = 3", "victims = 3\nsize = [9, 9, 9]"), "instances[0].size"),
        (("[[instances]]", "[[instances]]\nfiles = 'x*.json'\n[[instances]]"), "'x*.json' matches"),
        (('planner = "greedy"', ""), None),
        (("[[planners]]", "[timing]\nrepetitions = 0\n[[planners]]"), "timing.repetitions: 0;"),
        (("[[planners]]", "[limits]\nseconds = -1\n[[planners]]"), "limits.seconds: -1;"),
        (("[[planners]]", "[report]\nbaseline = 'x'\n[[planners]]"), "report.baseline: 'x' is not"),
        (("[[planners]]", "[[planners]]\n[[planners]]\n[[planners]]"), "planners[1]: 'msmrta' is"),
        (("[[planners]]", "path = 'x'\n[[planners]]"), "instances[0].path"),
        (('title = "Sound"', 'title = "Sound"\npath = "x"'), "path: there is no such field"),
        (("[[planners]]", "[[planners"), "broken TOML"),
        (("[[planners]]", "[[formulations]]\nstage = 'lunch'\n[[planners]]"), "no stage 'lunch'"),
        (
            ("[[planners]]", "[[formulations]]\nstage = 'cluster'\nlunch = 1\n[[planners]]"),
            "formulations[0].lunch: no such parameter; these formulations have psi",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage = 'cluster'\nsolvers = 'x'\n[[planners]]"),
            "formulations[0]",
        ),
        (
            (
                "[[planners]]",
                "[[formulations]]\nstage='cluster'\ntime_limit=[1, 'a']\n[[planners]]",
            ),
            "formulations[0].time_limit: 'a'; give a number",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage='cluster'\ntime_limit='a'\n[[planners]]"),
            "formulations[0].time_limit: 'a'; give a number",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage = 'cluster'\ngap = true\n[[planners]]"),
            "formulations[0].gap: True; give a number",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage='cluster'\nsolver_seed='x'\n[[planners]]"),
            "formulations[0].solver_seed: 'x'; give a number",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage='cluster'\nsolver_seed=1.5\n[[planners]]"),
            "formulations[0].solver_seed: 1.5; give a whole number",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage = 'cluster'\npsi = 'x'\n[[planners]]"),
            "formulations[0].psi: 'x'",
        ),
        (
            ("[[planners]]", "[[formulations]]\nstage='cluster'\ntime_limit=nan\n[[planners]]"),
            "time_limit",
        ),
        (("robots = [1, 2]", "robots = ['a', 2]"), "instances[0].robots[0]: 'a'; give a whole"),
    ],
)
def test_a_mistake_is_named_in_one_line(
    tmp_path: Path, change: tuple[str, str], says: str | None
) -> None:
    assert change[0] in SOUND
    path = write_study(tmp_path, SOUND.replace(*change))
    if says is None:  # a planner's table has a default for everything
        assert runs(Study.read(path))[0].contender == "msmrta"
        return
    with pytest.raises(InputError) as caught:
        runs(Study.read(path))
    assert says in str(caught.value)
    assert str(caught.value).count(str(path)) == 1
    assert "\n" not in str(caught.value)


def test_two_instances_of_one_name_are_refused(tmp_path: Path) -> None:
    text = SOUND.replace(
        "[[planners]]", "[[instances]]\nmaps='open.map'\nrobots=1\nvictims=3\nkinds=3\n"
        "per_victim=[1,1]\n[[planners]]"
    )  # fmt: skip
    with pytest.raises(InputError, match="two instances are called 'open-1x3-s0'"):
        runs(Study.read(write_study(tmp_path, text)))


def test_generated_maps_and_shares_are_the_generators(tmp_path: Path) -> None:
    text = """
    title = "Layouts"
    [[instances]]
    maps = ["rooms", "maze"]
    size = [11, 13]
    robots = 3
    victims = 10
    seeds = [0, 1]
    unreachable = 0.2
    [[planners]]
    """
    todo = runs(Study.read(write_study(tmp_path, text)))
    assert len(todo) == 4
    assert {run.instance.map.shape for run in todo} == {(11, 13)}
    assert len({run.instance.map.free.tobytes() for run in todo}) == 4
    for run in todo:
        within = run.instance.map.fields([run.instance.robots[0].start])[0]
        cut_off = [v for v in run.instance.cells if not within[v] < float("inf")]
        assert len(cut_off) == 2


def test_a_study_without_anything_to_run_is_refused(tmp_path: Path) -> None:
    text = SOUND[: SOUND.index("[[planners]]")]
    with pytest.raises(InputError, match="nothing to run"):
        Study.read(write_study(tmp_path, text))


def test_a_missing_study_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        Study.read(tmp_path / "none.toml")
