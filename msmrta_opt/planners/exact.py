"""The exact planner: the joint problem, improved from above and bounded from below, at any time.

It starts from the best plan of the quick planners, improved by local search; total time and makespan
are then closed in on by branch and cut (`routing.branch_and_cut.search`), latency by branch and price
(`routing.branch_and_price.search`). It stops at the time limit, at the gap, or at Ctrl-C, always with
the best plan and what is proven about it.
"""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from typing import Any

from ..certify.certificates import STAGE as STAGE_OF_BOUNDS
from ..interruption import interrupted, interruptible
from ..mission.errors import InputError
from ..mission.instance import Instance
from ..mission.plan import LIMITS, Certificate, Plan, Route, Unserved
from ..mission.proof import LatencyProof, RootProof
from ..routing.bound import Bound
from ..routing.callbacks import Callbacks
from ..routing.heuristics.ruin_and_recreate import ruin_and_recreate
from ..routing.incumbent import Progress
from ..routing.methods import METHODS, close_in
from ..routing.objectives import DEFAULT, objective_of
from ..routing.parameters import Parameters
from ..routing.problem import RoutingData, faults
from ..routing.stop import (
    Interruption,
    MaximumRuntime,
    RelativeGap,
)
from ..stages.joint_routing import beyond_limits, limits_of, routing_data
from ..stages.options import RoutingOptions
from ..stages.path_planning import path_planning
from ..stages.requirement_analysis import missing_capabilities, requirement_analysis
from ..stages.scouting import scout_mission
from ..stages.situation import Situation
from .support.first_routes import MODEL, first_routes
from .support.improvement import stops_of
from .support.planner import IMPROVING, SOLVING, Planner, Stopwatch
from .support.record import assemble
from .support.recorder import Recorder

STAGE = "exact"


def run(
    instance: Instance,
    *,
    objective: str = DEFAULT,
    time_limit: float = 60.0,
    gap: float = 0.0,
    seed: int = 0,
    endurance: float | None = None,
    longest_walk: float | None = None,
    return_to_start: bool = False,
    parameters: Parameters | Mapping[str, Any] | None = None,
    callbacks: Callbacks | None = None,
) -> Plan:
    """Plan `instance` as well as the time allows, with a proven bound.

    Parameters
    ----------
    objective : str
        What to minimise; one of `routing.objectives.OBJECTIVES`.
    time_limit : float
        Seconds.
    gap : float
        Relative gap to stop at.
    seed : int
        Of scouting and of the search.
    endurance : float, optional
        Maximum time that a robot may be busy.
    longest_walk : float, optional
        Maximum number of cells that a robot may walk.
    return_to_start : bool
        Whether robots walk back after their last visit.
    parameters : Parameters or mapping, optional
        Tuning parameters of the methods; see `routing.parameters`.
    callbacks : Callbacks, optional
        Told of what the search does.

    Raises
    ------
    InputError
        If an option is wrong.
    NoPlanError
        If no plan that keeps to the robots' limits exists, or none is found in time.
    """
    aim, tuned = objective_of(objective), Parameters.of(parameters)
    options = _checked(
        {
            "time_limit": time_limit,
            "gap": gap,
            "seed": seed,
            "endurance": endurance,
            "longest_walk": longest_walk,
            "return_to_start": return_to_start,
        }
    )
    watch = Stopwatch()
    stop = MaximumRuntime(time_limit) | RelativeGap(gap) | Interruption(interrupted)
    with watch("scouting"):
        known, scouting = scout_mission(instance, options)
    with watch("requirement analysis"):
        situation = Situation.of(known)
        analysis = requirement_analysis(known.P, known.Q)
        missing = missing_capabilities(known.Q, analysis.potential, situation.reach)
        data = routing_data(situation, **limits_of(options))
    with watch("joint problem"):
        first = first_routes(situation, data, aim, stop)
    # Until it is returned: a plan that is worked out is not lost to a late Ctrl-C.
    with interruptible():
        with watch("joint problem"):
            recorder = Recorder(aim, callbacks)
            progress = Progress(
                data,
                aim,
                first,
                stop=stop,
                callbacks=recorder,
            )
            bound = _solve(progress, seed, tuned)
            routes, search = progress.routes, recorder.ended(progress.state())
        with watch("path planning"):
            legs = path_planning(known, stops_of(situation, routes, STAGE))
            if return_to_start:
                legs = tuple(_with_way_back(known, route) for route in legs)
        plan = assemble(
            instance,
            known,
            planner=PLANNER,
            options={
                "objective": aim.name,
                "time_limit": time_limit,
                "gap": gap,
                "seed": seed,
                **limits_of(options),
                **({"parameters": changed} if (changed := tuned.changed()) else {}),
            },
            routes=legs,
            missing=missing,
            report=scouting,
            seconds=watch.seconds,
        )
        certificate = _certificate(known, progress, bound)
        return plan.model_copy(
            update={
                "unserved": (*plan.unserved, *_beyond_limits(situation, data)),
                "certificates": (certificate,),
                "search": search,
            }
        )


def _checked(given: Mapping[str, Any]) -> RoutingOptions:
    """The options of stages among those given to `run`; all are checked."""
    for name in ("time_limit", "gap"):
        number = given.get(name, 0.0)
        if not isinstance(number, Real) or isinstance(number, bool) or not float(number) >= 0:
            raise InputError(f"{number!r}; give a number, 0 or more", field=name)
    own = ("seed", "endurance", "longest_walk", "return_to_start")
    return RoutingOptions(**{name: given[name] for name in own if name in given})


def _solve(progress: Progress, seed: int, parameters: Parameters) -> Bound:
    """Improve the incumbent for a while, then close in from both sides."""
    tuning = parameters.heuristics

    def improve(seconds: float, seed: int) -> None:
        progress.begin("ruin and recreate")
        progress.offer(
            ruin_and_recreate(
                progress.data,
                progress.routes,
                progress.objective,
                stop=progress.until_done(seconds),
                seed=seed,
                parameters=tuning,
                improved=progress.offer,
            )
        )

    progress.bound_at_once()
    if not progress.done():
        # Small missions are proven sooner than a search of seconds is worth.
        longest = tuning.first_seconds * progress.data.n_victims
        improve(min(tuning.first_share * progress.left(), longest), seed)
    bound = close_in(progress, seed=seed, parameters=parameters)
    if bound.root is None and not progress.done():
        # Too large for the method: what time is left goes to better routes.
        improve(progress.left(), seed + 1)
    return bound


def _with_way_back(instance: Instance, route: Route) -> Route:
    if not route.visits:
        return route
    start = next(robot.start for robot in instance.robots if robot.id == route.robot)
    (back,) = instance.map.walks([route.visits[-1].cells[-1]], [start])
    return route.model_copy(update={"back": tuple(back)})


def _beyond_limits(situation: Situation, data: RoutingData) -> list[Unserved]:
    """Available requirements that every capable robot could serve only beyond its limits."""
    instance = situation.instance
    return [
        Unserved(victim=instance.victims[v].id, kind=instance.capabilities[k], reason=reason)
        for (v, k), reason in beyond_limits(situation, data).items()
    ]


def _certificate(known: Instance, progress: Progress, bound: Bound) -> Certificate:
    objective, worth = progress.objective, progress.value
    optimal = progress.closed()
    method = METHODS[objective.method]
    n_variables, n_rows = (0, 0) if bound.root is None else bound.root.size
    written = None if bound.root is None else bound.root.written(known, worth)
    return Certificate(
        stage=STAGE_OF_BOUNDS,
        model=objective.name,
        sense=objective.sense,
        solver=method.title,
        version=method.solvers(),
        status="optimal" if optimal else "feasible",
        objective=worth,
        bound=progress.bound,
        gap=0.0 if optimal else progress.open(),
        proof=progress.proof,
        check="".join(faults(progress.data, progress.routes)[:1]) or "passed",
        n_variables=n_variables,
        n_rows=n_rows,
        root=written if isinstance(written, RootProof) else None,
        pricing=written if isinstance(written, LatencyProof) else None,
    )


def _formulations(options: Mapping[str, Any]) -> tuple[str, ...]:
    """The quick planners do not know of limits; routes to begin with may then come of a model."""
    limited = any(options.get(name) is not None for name in ("endurance", "longest_walk"))
    return (MODEL,) if limited else ()


PLANNER = Planner(
    "exact",
    "the joint problem, with a proven bound",
    run,
    check=_checked,
    limits=LIMITS,
    improves_itself=True,
    formulations=_formulations,
    libraries=(
        *(*SOLVING, *IMPROVING, "pyscipopt", "msmrta_opt.routing.combinatorial_bounds"),
        "msmrta_opt.routing.branch_and_cut.compiled_cut",
    ),
)
