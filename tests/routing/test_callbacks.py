"""Callbacks: told of every improvement and every phase, in order."""

from __future__ import annotations

from support.joint_cases import any_routes, small_mission
from support.searches import closed_in

from msmrta_opt.routing.callbacks import Callbacks, SearchState


class Diary(Callbacks):
    def __init__(self) -> None:
        self.states: list[SearchState] = []
        self.proofs: list[str] = []
        self.phases: list[str] = []

    def incumbent_found(self, state: SearchState) -> None:
        self.states.append(state)

    def bound_raised(self, state: SearchState, proof: str) -> None:
        self.states.append(state)
        self.proofs.append(proof)

    def phase_began(self, state: SearchState, phase: str) -> None:
        self.phases.append(phase)


def test_a_diary_of_branch_and_cut_has_its_phases_and_ends_with_its_result() -> None:
    data = small_mission(7, 3, 6, map_number=2)
    diary = Diary()
    routes, bound = closed_in(data, "makespan", any_routes(data), callbacks=diary)
    assert diary.phases[0] == "root relaxation"
    assert set(diary.phases) <= {
        "root relaxation",
        "ruin and recreate",
        "restricted program",
        "branch and cut",
    }
    assert diary.proofs[0] == "combinatorial"
    assert (diary.states[-1].routes, diary.states[-1].bound) == (routes, bound.value)
    assert diary.states[-1].gap <= 1e-6


def test_without_callbacks_nothing_is_told() -> None:
    state = SearchState((), 1.0, 1.0)
    Callbacks().incumbent_found(state)
    Callbacks().bound_raised(state, "root LP")
    Callbacks().phase_began(state, "root relaxation")
    assert state.gap == 0
