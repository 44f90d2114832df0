"""An operations researcher's workbench for multi-robot task assignment in search and rescue.

    >>> import msmrta_opt as mo
    >>> plan = mo.plan(mo.example("paper"), psi=0.95)
    >>> plan.metrics.served_share
    1.0

Public names are loaded on first use, so that importing the package costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._version import __version__ as __version__
from .public import HOME, MODULES, load

__all__ = ["__version__", "read", *HOME, *MODULES]

if TYPE_CHECKING:
    from . import plots as plots
    from .certify.plan import check_plan as check_plan
    from .diagnosis.difference import Difference as Difference
    from .diagnosis.difference import diff as diff
    from .diagnosis.explain import Explanation as Explanation
    from .diagnosis.explain import explain as explain
    from .execution.execute import execute as execute
    from .execution.hindsight import hindsight as hindsight
    from .execution.policies import policies as policies
    from .mission.coarsening import coarsen as coarsen
    from .mission.convergence import Convergence as Convergence
    from .mission.draft import draft_mission as draft_mission
    from .mission.errors import CheckError as CheckError
    from .mission.errors import InputError as InputError
    from .mission.errors import ModelError as ModelError
    from .mission.errors import MsmrtaError as MsmrtaError
    from .mission.errors import SolverError as SolverError
    from .mission.examples import example as example
    from .mission.examples import examples as examples
    from .mission.generate import generate_mission as generate_mission
    from .mission.generate import random_mission as random_mission
    from .mission.grid import DistanceTable as DistanceTable
    from .mission.grid import GridMap as GridMap
    from .mission.instance import Instance as Instance
    from .mission.instance import Robot as Robot
    from .mission.instance import Scout as Scout
    from .mission.instance import Victim as Victim
    from .mission.instance import json_schema as json_schema
    from .mission.layouts import maze as maze
    from .mission.layouts import rooms as rooms
    from .mission.layouts import rubble as rubble
    from .mission.layouts import with_pocket as with_pocket
    from .mission.map_files import read_floor as read_floor
    from .mission.map_files import read_floor_map as read_floor_map
    from .mission.maps import read_map as read_map
    from .mission.metrics import Metrics as Metrics
    from .mission.occupancy import Occupancy as Occupancy
    from .mission.plan import Plan as Plan
    from .mission.plan_difference import PlanDifference as PlanDifference
    from .mission.run import Run as Run
    from .mission.scenario import Scenario as Scenario
    from .optimise.compile.compiled import program as program
    from .optimise.compile.compiled import structure as structure
    from .optimise.data import ClusterData as ClusterData
    from .optimise.data import ClusteringData as ClusteringData
    from .optimise.data import JointAssignmentData as JointAssignmentData
    from .optimise.data import VictimData as VictimData
    from .optimise.export import export as export
    from .optimise.export import read_program as read_program
    from .optimise.export import write_program as write_program
    from .optimise.formulation import Parameter as Parameter
    from .optimise.formulation import Spec as Spec
    from .optimise.mission_data import Surroundings as Surroundings
    from .optimise.new_models import blank_model as blank_model
    from .optimise.new_models import copy_model as copy_model
    from .optimise.registry import add_models as add_models
    from .optimise.registry import get as model  # noqa: F401
    from .optimise.registry import models as list_models  # noqa: F401
    from .optimise.registry import models as models
    from .optimise.registry import reload_models as reload_models
    from .optimise.registry import remove_models as remove_models
    from .optimise.solution import Solution as Solution
    from .optimise.solve import solve as solve
    from .optimise.solvers import solvers as list_solvers  # noqa: F401
    from .planners import plan as plan
    from .planners import planners as list_planners  # noqa: F401
    from .planners import planners as planners
    from .planners.support.mip_start import mip_start as mip_start
    from .planners.support.plan_proof import prove_plan as prove_plan
    from .planners.support.plan_proof import with_proof as with_proof
    from .proofs.prove import Proof as Proof
    from .proofs.prove import prove as prove
    from .proofs.stated import check_proof as check_proof
    from .stages import algorithm as algorithm
    from .stages.data import stage_data as stage_data
    from .stages.options import StagedOptions as StagedOptions
    from .stages.scouting import scouting as scouting
    from .studies.analysis.agreement import disagreements as disagreements
    from .studies.analysis.explore import explore as explore
    from .studies.analysis.matrix_picture import plot_matrix as plot_matrix
    from .studies.analysis.profile import performance_profile as performance_profile
    from .studies.analysis.score import score as score
    from .studies.analysis.solution_picture import plot_solution as plot_solution
    from .studies.analysis.staging import price_of_staging as price_of_staging
    from .studies.analysis.staging_picture import staging_losses as staging_losses
    from .studies.analysis.tradeoff import tradeoff as tradeoff
    from .studies.analysis.tradeoff import tradeoff_regions as tradeoff_regions
    from .studies.baselines import against_baseline as against_baseline
    from .studies.comparison import comparison as compare  # noqa: F401
    from .studies.solver_comparison import compare_solvers as compare_solvers
    from .studies.study import study as study


def read(path: str) -> Instance:
    """Read an instance file, or a shipped instance by its name; see `Instance.read`."""
    from .mission.instance import Instance

    return Instance.read(path)


def __getattr__(name: str) -> Any:
    value = load(name)
    if name not in MODULES:
        globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
