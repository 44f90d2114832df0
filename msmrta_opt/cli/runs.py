"""The commands run and policies: a plan executed, once or many times, and compared."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import Json
from .missions import Figure, Seed

if TYPE_CHECKING:
    from ..execution.many_runs import Outcome
    from ..mission.metrics import Metric
    from ..mission.plan import Plan
    from ..mission.run import Run
    from ..mission.scenario import Scenario


def register(app: typer.Typer) -> None:
    """Add this file's commands to `app`."""
    for command in (run, policies):
        app.command()(command)


def run(
    plan: Annotated[Path, typer.Argument(help="A plan file.", metavar="PLAN")],
    scenario: Annotated[
        Path | None,
        typer.Option(help="What may happen, a TOML file.  [default: nothing]", metavar="FILE"),
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="What to do when something happens; give several to compare them on the same "
            "seeds.  [default: keep]",
            metavar="NAME…",
        ),
    ] = None,
    seed: Seed = None,
    runs: Annotated[int, typer.Option(help="How many, on seeds from --seed on.", metavar="N")] = 1,
    jobs: Annotated[int, typer.Option(help="How many processes.", metavar="K")] = 1,
    by: Annotated[
        list[float] | None,
        typer.Option(
            help="With several runs: the probability that victims are served by this time.  "
            "[default: when the plan says]",
            metavar="TIME",
        ),
    ] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="An option of those policies that have it.", metavar="NAME=VALUE"),
    ] = None,
    regret: Annotated[
        float | None,
        typer.Option(
            help="Of one run: seconds to find, and prove, the best that could have been.",
            metavar="SECONDS",
        ),
    ] = None,
    objective: Annotated[
        str | None,
        typer.Option(help="By what --regret judges.  [default: total_time]", metavar="NAME"),
    ] = None,
    json: Json = None,
    figure: Figure = None,
) -> None:
    """Execute a plan, and print what happened, and what came of it beside what was planned.

    With several runs or policies: quantiles of the metrics, the probability that each victim is served
    by a time, and the differences of policies, with intervals of 95 %. Ctrl-C keeps what is finished.
    """
    from ..execution.execute import execute
    from ..mission.errors import InputError
    from ..mission.plan import Plan
    from ..mission.scenario import Scenario
    from ..routing.objectives import DEFAULT, objective_of
    from .console import say
    from .outputs import check_outputs, named_values, write_document, write_picture

    for name, number in {"--runs": runs, "--jobs": jobs}.items():
        if number < 1:
            raise InputError(f"{number}; give 1 or more", field=name)
    check_outputs(json, figure=figure, inputs=[plan, scenario])
    for time in by or ():
        if not 0 <= time < math.inf:
            raise InputError(f"{time!r}; give a time, 0 or more", field="--by")
    names = policy or ["keep"]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"{name!r} is repeated; give each policy once", field="--policy")
    options = _options(names, named_values(option))
    made = Plan.read(plan)
    given = Scenario() if scenario is None else Scenario.read(scenario, made.instance.map)
    try:
        given.check_for(made.instance)
    except InputError as error:
        raise error.within(scenario or "") from None
    if scenario is not None and not given.says_something:
        say(f"Nothing happens: {scenario} has no table.")
    if regret is not None and not regret >= 0:
        raise InputError(f"{regret!r}; give 0 or more", field="--regret")
    if objective is not None:
        if regret is None:
            raise InputError("says by what to judge; give --regret with it", field="--objective")
        objective_of(objective)
    if runs > 1 or len(names) > 1:
        if regret is not None:
            raise InputError("is for one run; give one policy and no --runs", field="--regret")
        if figure is not None:
            raise InputError("is for one run; give one policy and no --runs", field="--figure")
        seeds = range(seed or 0, (seed or 0) + runs)
        _many(made, given, options, seeds, jobs, by or [], json)
        return
    if by:
        raise InputError("is for several runs; give --runs with it", field="--by")
    happened = execute(made, given, names[0], seed or 0, **options[names[0]])
    if regret is not None:
        from ..execution.hindsight import hindsight

        best = hindsight(happened, objective=objective or DEFAULT, time_limit=regret)
        happened = happened.model_copy(update={"hindsight": best})
    write_document("run", happened, json)
    if figure is not None:
        write_picture(figure, happened.plot)
    _show(happened)
    if happened.hindsight is not None:
        say(f"Hindsight, for what was served: {happened.hindsight}.")


def policies(json: Json = None) -> None:
    """List the policies with their options and defaults."""
    from ..execution.policies import COMMON
    from ..execution.policies import policies as all_policies
    from .console import table, write_json
    from .outputs import check_outputs

    check_outputs(json)
    found = [(x.name, x.title, {**COMMON, **x.defaults}) for x in all_policies().values()]
    write_json(json, [{"name": n, "title": t, "options": o} for n, t, o in found])
    rows = [(n, t, ", ".join(f"{k}={_plain(x)}" for k, x in o.items())) for n, t, o in found]
    table("Policies", ["name", "what it does", "options"], rows)


def _plain(value: object) -> str:
    import json

    return value if isinstance(value, str) else json.dumps(value)


def _options(names: Sequence[str], given: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """By policy its options among those given; each must be that of one of the policies."""
    from ..execution.policies import COMMON, policy_of
    from ..execution.policies import policies as all_policies

    known = all_policies()
    takes = {n: {*COMMON, *known[n].defaults} if n in known else set() for n in names}
    nobody = {k: x for k, x in given.items() if not any(k in takes[name] for name in names)}
    options = {name: {k: x for k, x in given.items() if k in takes[name]} for name in names}
    for name in names:
        policy_of(name, {**options[name], **(nobody if name == names[-1] else {})})
    return options


def _many(
    plan: Plan,
    scenario: Scenario,
    options: Mapping[str, Mapping[str, Any]],
    seeds: Sequence[int],
    jobs: int,
    by: Sequence[float],
    json: Path | None,
) -> None:
    from ..execution.distributions import of_policy
    from ..execution.many_runs import execute_many
    from ..interruption import interrupted, interruptible
    from .console import say, write_json

    found: list[Outcome] = []
    with interruptible():
        found += execute_many(plan, scenario, options, seeds, jobs=jobs)
        found = [outcome for name in options for outcome in of_policy(found, name)]
        write_json(json, _document(plan, found, options, by), what="runs")
        if found:
            _show_many(plan, found, list(options), by)
        if interrupted():
            say(f"Interrupted after {len(found)} of {len(seeds) * len(options)} runs.")
            raise KeyboardInterrupt


def _document(
    plan: Plan,
    found: Sequence[Outcome],
    options: Mapping[str, Mapping[str, Any]],
    by: Sequence[float],
) -> dict[str, Any]:
    from dataclasses import asdict

    names = [name for name in options if any(x.policy == name for x in found)]
    return {
        "policies": {name: dict(given) for name, given in options.items()},
        "quantiles": [
            {"policy": policy, "metric": metric, **asdict(quantile)}
            for policy, metric, each in _quantiles(found, names)
            for quantile in each
        ],
        "served": [
            {"policy": policy, "victim": victim, "by": time, **asdict(chance)}
            for policy, victim, time, chance in _served(plan, found, names, by)
        ],
        "differences": [
            {"policy": other, "less": names[0], "metric": metric, **asdict(gap)}
            for other, metric, gap in _differences(found, names)
        ],
        "runs": [
            {
                "policy": x.policy,
                "seed": x.seed,
                **x.figures,
                "served_at": {str(victim): time for victim, time in x.served.items()},
            }
            for x in found
        ],
    }


def _quantiles(found: Sequence[Outcome], names: Sequence[str]) -> list[tuple[str, str, list[Any]]]:
    from ..execution.distributions import QUANTILES, of_policy, quantile
    from ..mission.run_metrics import RUN_METRICS

    return [
        (name, metric, [quantile(values, share) for share in QUANTILES])
        for name in names
        for metric in RUN_METRICS
        for values in [[x.figures[metric] for x in of_policy(found, name)]]
    ]


def _served(
    plan: Plan, found: Sequence[Outcome], names: Sequence[str], by: Sequence[float]
) -> list[tuple[str, int, float, Any]]:
    from ..execution.distributions import of_policy, served_by

    planned: dict[int, float] = {}
    for route in plan.routes:
        for visit in route.visits:
            if visit.served:
                planned[visit.victim] = max(planned.get(visit.victim, 0.0), visit.departure)
    needy = {victim.id for victim in plan.instance.victims if victim.requirements}
    victims = sorted(needy.union(*(x.victims for x in found)))
    end = plan.metrics.makespan
    return [
        (name, victim, time, served_by(of_policy(found, name), victim, time))
        for name in names
        for victim in victims
        for time in (by or [planned.get(victim, end)])
    ]


def _differences(found: Sequence[Outcome], names: Sequence[str]) -> list[tuple[str, str, Any]]:
    from ..execution.distributions import paired
    from ..mission.run_metrics import RUN_METRICS

    return [
        (other, metric, paired(found, names[0], other, metric))
        for other in names[1:]
        for metric in RUN_METRICS
    ]


def _show_many(
    plan: Plan, found: Sequence[Outcome], names: Sequence[str], by: Sequence[float]
) -> None:
    from ..execution.distributions import QUANTILES, of_policy
    from ..mission.run_metrics import RUN_METRICS
    from .console import table

    names = [name for name in names if any(x.policy == name for x in found)]

    def interval(of: Any, entry: Metric[Any]) -> str:
        return f"{_short(entry.scaled(of.low))} to {_short(entry.scaled(of.high))}"

    for policy in names:
        quantiles = [(RUN_METRICS[name], each) for _, name, each in _quantiles(found, [policy])]
        middle = len(QUANTILES) // 2
        has_interval = all(None not in (q[middle].low, q[middle].high) for _, q in quantiles)
        few = "" if has_interval else ", too few for an interval of the median"
        table(
            f"{policy}: quantiles of {len(of_policy(found, policy))} runs{few}",
            [
                "metric",
                *(f"{share:.0%}" for share in QUANTILES),
                *(["median, 95 %"] if has_interval else []),
            ],
            [
                (
                    _with_unit(entry),
                    *(_short(entry.scaled(quantile.value)) for quantile in each),
                    *([interval(each[middle], entry)] if has_interval else []),
                )
                for entry, each in quantiles
            ],
        )
    rows = [
        (policy, victim, time, f"{chance.value:.1%}", f"{chance.low:.1%} to {chance.high:.1%}")
        for policy, victim, time, chance in _served(plan, found, names, by)
    ]
    table(
        "Probability that a victim has, by a time, all that robots can give",
        ["policy", "victim", "by", "probability", "95 %"],
        rows,
    )
    differences = _differences(found, names)
    for other in names[1:]:
        gaps = [(RUN_METRICS[name], gap) for who, name, gap in differences if who == other]
        has_interval = all(None not in (gap.low, gap.high) for _, gap in gaps)
        few = "" if has_interval else "; too few runs for an interval"
        table(
            f"On the same seeds: {other} minus {names[0]}{few}",
            ["metric", "mean", *(["95 %"] if has_interval else []), "less", "equal", "more"],
            [
                (
                    _with_unit(entry),
                    _short(entry.scaled(gap.mean)),
                    *([interval(gap, entry)] if has_interval else []),
                    gap.less,
                    gap.equal,
                    gap.more,
                )
                for entry, gap in gaps
            ],
        )


def _short(value: float) -> str:
    """In four digits, or up to six where the whole number has them."""
    from .console import number

    return number(value, min(max(len(f"{abs(value):.0f}"), 4), 6))


def _with_unit(entry: Metric[Any]) -> str:
    return f"{entry.label} ({entry.unit})" if entry.unit else entry.label


def _show(run: Run) -> None:
    from ..mission.metrics import METRICS
    from ..mission.run_metrics import RUN_METRICS
    from .console import say, table

    told = [event for event in run.events if event.what != "served"]
    decided = iter(run.decisions)
    words = [str(next(decided, event) if event.what == "decided" else event) for event in told]
    if told:
        table("Events", ["time", "what"], list(zip((e.time for e in told), words, strict=True)))
    planned: dict[int, float] = {}
    for route in run.plan.routes:
        for visit in route.visits:
            if visit.served:
                planned[visit.victim] = max(planned.get(visit.victim, 0.0), visit.departure)
    done = run.metrics.completion
    needs = {victim.id: len(victim.requirements) for victim in run.victims}
    served = Counter(service.victim for service in run.services if service.done)
    table(
        "Victims: when the last of what was served was done",
        ["victim", "planned", "done", "served", "of"],
        [(v, planned.get(v), done.get(v), served[v], needs[v]) for v in needs],
    )
    table(
        f"Metrics (policy {run.policy}, seed {run.seed})",
        ["metric", "planned", "done", "unit"],
        [
            (
                entry.label,
                entry.scaled(METRICS[name].of(run.plan.metrics)) if name in METRICS else None,
                entry.scaled(entry.of(run.metrics)),
                entry.unit,
            )
            for name, entry in RUN_METRICS.items()
        ],
    )
    say(f"Deciding took {run.deciding_seconds:.3f} s.")
