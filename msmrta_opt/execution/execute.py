"""A plan executed once: the world drawn, the simulation run, the run checked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..certify.plan import check_plan
from ..certify.run import check_run
from ..mission.errors import InputError, shown
from ..mission.plan import Plan
from ..mission.run import Run
from ..mission.scenario import Scenario
from .draw import draw_world
from .policies import policy_of
from .simulation import Simulation
from .state import Situated


def execute(
    plan: Plan,
    scenario: Scenario | Mapping[str, Any] | None = None,
    policy: str = "keep",
    seed: int = 0,
    **options: Any,
) -> Run:
    """Execute `plan`, and check the run.

    Parameters
    ----------
    plan : Plan
        Any planner's, one that holds.
    scenario : Scenario or mapping, optional
        What may happen; by default nothing does.
    policy : str
        What to do when something happens; one of `policies.policies`.
    seed : int
        Of all that is random. Policies on the same seed meet the same world.
    **options
        The policy's.

    Raises
    ------
    InputError
        If the scenario does not fit the mission, or the policy or an option is unknown or out of range.
    CheckError
        If the plan does not hold; or if the run fails its independent check, which would be a defect
        of the simulation.
    """
    if not isinstance(plan, Plan):
        raise InputError(f"{shown(plan)}; give a plan, as msmrta_opt.plan returns it", field="plan")
    check_plan(plan)
    return execute_checked(plan, scenario_of(scenario, plan), policy, seed, options)


def execute_checked(
    plan: Plan,
    scenario: Scenario,
    policy: str,
    seed: int,
    options: Mapping[str, Any],
    given_up: Callable[[], bool] = lambda: False,
) -> Run:
    """The same for a plan that has been checked; `simulation.GivenUpError` once it is given up."""
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"{seed!r}; give a whole number, 0 or more", field="seed")
    scenario.check_for(plan.instance)
    chosen, values = policy_of(policy, options)
    world = draw_world(plan, scenario, seed)
    if chosen.load is not None:
        chosen.load(values)
    decide = chosen.begin(Situated(plan, values, seed))
    simulation = Simulation(plan, scenario, world, decide, values["blocked"], given_up)
    simulation.run()
    run = Run(
        plan=plan,
        scenario=scenario,
        seed=seed,
        policy=policy,
        options=values,
        world=world,
        tracks=simulation.tracks(),
        services=simulation.ordered_services(),
        events=tuple(simulation.events),
        decisions=tuple(simulation.decisions),
        deciding_seconds=simulation.deciding_seconds,
    )
    return check_run(run.model_copy(update={"figures": run.metrics.as_dict()}))


def scenario_of(given: Scenario | Mapping[str, Any] | None, plan: Plan) -> Scenario:
    """A scenario from whatever may be given for one, to execute `plan`.

    Raises
    ------
    InputError
        If it is none.
    """
    if given is None:
        return Scenario()
    if isinstance(given, Scenario):
        return given
    if isinstance(given, Mapping):
        return Scenario.from_document(dict(given), plan.instance.map)
    raise InputError(
        f"{shown(given)}; give a scenario, as Scenario.read(FILE) returns it", field="scenario"
    )
