"""Algorithm 1, line by line: its stages as functions, and what they hand to one another.

A short way to all of them, for those who take the method apart; `planners.msmrta` puts it together.
"""

from .cluster_assignment import ClusterAssignment, cluster_assignment, cluster_data
from .clustering import Clustering, clustering
from .options import StagedOptions
from .path_planning import path_planning
from .performance_analysis import performance_analysis
from .requirement_analysis import missing_capabilities, requirement_analysis
from .robot_assignment import robot_assignment
from .scouting import scout_mission
from .situation import Situation, Stop, without
from .victim_assignment import VictimAssignment, victim_assignment

__all__ = [
    "ClusterAssignment",
    "Clustering",
    "Situation",
    "StagedOptions",
    "Stop",
    "VictimAssignment",
    "cluster_assignment",
    "cluster_data",
    "clustering",
    "missing_capabilities",
    "path_planning",
    "performance_analysis",
    "requirement_analysis",
    "robot_assignment",
    "scout_mission",
    "victim_assignment",
    "without",
]
