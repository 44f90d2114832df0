"""What a report holds: the sections, in order, of which there is something to show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ...plots.style import line_styles
from .baseline import ratios_table, savings_table
from .blocks import Block, Section, Table
from .heat import NOTE as HEAT_NOTE
from .heat import metric_heats, time_heat
from .outcomes import outcome_picture
from .policies import policy_section
from .profile import planning_profile, solving_profile
from .runs import METHODS, contenders, failures, of_method
from .scaling import scaling_blocks
from .tables import (
    contender_table,
    counts_table,
    failure_table,
    instance_table,
    quality_table,
    same_everywhere,
    solving_table,
    timing_table,
)
from .winner import who_won

if TYPE_CHECKING:
    import pandas as pd

    from ..record import Record
    from ..specification import Study


def sections(study: Study, runs: pd.DataFrame, records: Sequence[Record]) -> list[Section]:
    """The sections of the report of `study`, from its records, and these as of `table_of`."""
    if runs.empty:
        return []
    looks = line_styles(contenders(runs))
    kinds = [(method, of_method(runs, method)) for method in METHODS]
    kinds = [(method, mine) for method, mine in kinds if not mine.empty]
    planned = of_method(runs, "planner")
    solved = of_method(runs, "formulation")
    found = [
        who_won(runs, study.report.quality, looks),
        policy_section(records, study.report.quality),
        Section(
            "Results",
            _filled(
                counts_table(runs),
                same_everywhere(planned) if len(planned) else None,
                *(timing_table(mine, method) for method, mine in kinds if mine["counts"].any()),
                quality_table(planned) if planned["counts"].any() else None,
                solving_table(solved) if len(solved) else None,
            ),
        ),
        _against_the_baseline(study, kinds),
        Section(
            "Times over robots and victims",
            _filled(*(time_heat(m, k) for k, m in kinds)),
            HEAT_NOTE,
        ),
        Section("Plans over robots and victims", metric_heats(planned), HEAT_NOTE),
        Section("Growth", [block for k, mine in kinds for block in scaling_blocks(mine, k, looks)]),
        Section(
            "Performance profiles",
            _filled(planning_profile(runs, looks), solving_profile(runs)),
        ),
    ]
    found.append(Section("What was run on what", [contender_table(runs), instance_table(runs)]))
    if len(failures(runs)):
        found.append(Section("Failures", [outcome_picture(runs), failure_table(runs)]))
    return [section for section in found if section.blocks]


def _against_the_baseline(study: Study, kinds: Iterable[tuple[str, pd.DataFrame]]) -> Section:
    baseline = study.report.baseline
    tables: list[Block | None] = []
    for method, mine in kinds:
        if baseline is not None and baseline in contenders(mine):
            tables.append(
                savings_table(
                    mine, method, baseline, study.report.published, study.report.published_source
                )
            )
            if method == "planner":
                tables.append(ratios_table(mine, baseline))
    return Section(f"Against {baseline}", _filled(*tables))


def _filled(*blocks: Block | None) -> Sequence[Block]:
    """The blocks that there are, without empty tables."""
    return [
        block
        for block in blocks
        if block is not None and not (isinstance(block, Table) and block.data.empty)
    ]
