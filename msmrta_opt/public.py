"""The public names, and where each is at home; loaded on first use.

The package serves its attributes from here. Whatever stands below what it offers asks here, too: a plan
draws itself, though `mission` may not know of `plots`. It then depends on a public name, as any user
does, and not on the module behind it; nothing is imported until it is called.
"""

from __future__ import annotations

import importlib
from types import MappingProxyType
from typing import Any

HOME = MappingProxyType(
    {
        "Instance": "mission.instance",
        "Robot": "mission.instance",
        "Victim": "mission.instance",
        "Scout": "mission.instance",
        "json_schema": "mission.instance",
        "GridMap": "mission.grid",
        "DistanceTable": "mission.grid",
        "read_map": "mission.maps",
        "examples": "mission.examples",
        "example": "mission.examples",
        "read_floor": "mission.map_files",
        "read_floor_map": "mission.map_files",
        "coarsen": "mission.coarsening",
        "Occupancy": "mission.occupancy",
        "draft_mission": "mission.draft",
        "Plan": "mission.plan",
        "PlanDifference": "mission.plan_difference",
        "Convergence": "mission.convergence",
        "Metrics": "mission.metrics",
        "check_plan": "certify.plan",
        "random_mission": "mission.generate",
        "generate_mission": "mission.generate",
        "rooms": "mission.layouts",
        "rubble": "mission.layouts",
        "maze": "mission.layouts",
        "with_pocket": "mission.layouts",
        "MsmrtaError": "mission.errors",
        "InputError": "mission.errors",
        "ModelError": "mission.errors",
        "SolverError": "mission.errors",
        "CheckError": "mission.errors",
        "Spec": "optimise.formulation",
        "Parameter": "optimise.formulation",
        "ClusterData": "optimise.data",
        "ClusteringData": "optimise.data",
        "JointAssignmentData": "optimise.data",
        "VictimData": "optimise.data",
        "Solution": "optimise.solution",
        "solve": "optimise.solve",
        "model": "optimise.registry:get",
        "models": "optimise.registry",
        "add_models": "optimise.registry",
        "remove_models": "optimise.registry",
        "copy_model": "optimise.new_models",
        "blank_model": "optimise.new_models",
        "Surroundings": "optimise.mission_data",
        "program": "optimise.compile.compiled",
        "structure": "optimise.compile.compiled",
        "export": "optimise.export",
        "read_program": "optimise.export",
        "write_program": "optimise.export",
        "explain": "diagnosis.explain",
        "prove": "proofs.prove",
        "prove_plan": "planners.support.plan_proof",
        "with_proof": "planners.support.plan_proof",
        "Proof": "proofs.prove",
        "check_proof": "proofs.stated",
        "Explanation": "diagnosis.explain",
        "diff": "diagnosis.difference",
        "Difference": "diagnosis.difference",
        "compare": "studies.comparison:comparison",
        "study": "studies.study",
        "compare_solvers": "studies.solver_comparison",
        "against_baseline": "studies.baselines",
        "disagreements": "studies.analysis.agreement",
        "performance_profile": "studies.analysis.profile",
        "score": "studies.analysis.score",
        "price_of_staging": "studies.analysis.staging",
        "plot_matrix": "studies.analysis.matrix_picture",
        "plot_solution": "studies.analysis.solution_picture",
        "staging_losses": "studies.analysis.staging_picture",
        "tradeoff": "studies.analysis.tradeoff",
        "tradeoff_regions": "studies.analysis.tradeoff",
        "explore": "studies.analysis.explore",
        "stage_data": "stages.data",
        "StagedOptions": "stages.options",
        "reload_models": "optimise.registry",
        "Scenario": "mission.scenario",
        "Run": "mission.run",
        "execute": "execution.execute",
        "hindsight": "execution.hindsight",
        "policies": "execution.policies",
        "plan": "planners",
        "list_planners": "planners:planners",
        "list_models": "optimise.registry:models",
        "list_solvers": "optimise.solvers:solvers",
        "mip_start": "planners.support.mip_start",
        "scouting": "stages.scouting",
    }
)
"""By public name the module it is in, after a colon its name there if that is another."""
MODULES = MappingProxyType(
    {"algorithm": "stages.algorithm", "planners": "planners", "plots": "plots"}
)
"""Modules that are public as a whole. A name of HOME is that of no module of ours: importing one
sets it in the package, in place of what was there."""


def load(name: str) -> Any:
    """What the public `name` stands for.

    Raises
    ------
    AttributeError
        If there is no such name.
    """
    package = __name__.rpartition(".")[0]
    if name in MODULES:
        return importlib.import_module(f".{MODULES[name]}", package)
    if name not in HOME:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    module, _, attribute = HOME[name].partition(":")
    return getattr(importlib.import_module(f".{module}", package), attribute or name)
