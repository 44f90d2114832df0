r"""The pricing problem: the cheapest paths of a robot's network, by dynamic programming over time.

Costs belong to what is served and when: ``cost[i, j, t]`` for serving option j (a set of tasks) at
victim i by time t, infinite where that is ruled out. Times move in blocks no longer than the shortest
leg, so that whole blocks are computed at once.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ...arrays import Floats, Ints
from .duals import Duals
from .ng_network import Network, Stops


def reduced_costs(network: Network, duals: Duals) -> Floats:
    """What serving each option at each time costs, ``(m, n_options, last + 1)``."""
    times = network.times
    cost = np.full(network.open.shape, np.inf)
    for i, options in enumerate(network.options):
        alone = {g: duals.reduced_cost(g, times) for g in {g for own in options for g in own}}
        for j, own in enumerate(options):
            cost[i, j] = np.sum([alone[g] for g in own], axis=0)
    cost[~network.open] = np.inf
    return cost


class CheapestPaths:
    """The cheapest way to every state of a network at every time.

    Parameters
    ----------
    network : Network
        Of one robot.
    cost : array, shape (m, n_options, last + 1)
        Of being done with an option at a time.

    Raises
    ------
    TimeoutError
        If no time is left.
    """

    def __init__(self, network: Network, cost: Floats) -> None:
        self.network, self.cost = network, cost
        block, last = network.block, network.last
        pad = max(int(network.leg.max()), int(network.extra.max()))
        width = pad + last + 1 + block
        # `done` is by when service ends, `short` by when the shortest option would end.
        done, short = np.full((2, network.n_states, width), np.inf)
        done[-1, pad] = 0.0
        done_from = sliding_window_view(done.ravel(), block)
        short_from = sliding_window_view(short.ravel(), block)
        base = network.tail * width + pad - network.steps
        heads, victim = network.heads, network.at[network.heads]
        rows = [heads * width + pad - network.extra[victim, j] for j in range(network.n_options)]
        ahead = np.pad(cost, ((0, 0), (0, 0), (0, block)), constant_values=np.inf)
        for t in range(1, last + 1, block):
            network.look_at_clock()
            way = np.minimum.reduceat(done_from[base + t], network.first_in, axis=0)
            short[heads, pad + t : pad + t + block] = way
            best = way + ahead[victim, 0, t : t + block]
            for j in range(1, network.n_options):
                # The shortest option's own row is written, so later ones may read it.
                np.minimum(
                    best, short_from[rows[j] + t] + ahead[victim, j, t : t + block], out=best
                )
            done[heads, pad + t : pad + t + block] = best
        self.pad, self.width = pad, width
        self.done, self.short = done, short

    @property
    def values(self) -> Floats:
        """Minimum cost of having served at each state by each time, ``(n_states, last + 1)``."""
        return self.done[:, self.pad : self.pad + self.network.last + 1]

    def before(self, extra: Ints) -> Floats:
        """The same before the service that takes ``extra[s]`` steps more than the shortest."""
        rows = np.arange(self.network.n_states - 1) * self.width + self.pad - extra
        before: Floats = sliding_window_view(self.short.ravel(), self.network.last + 1)[rows]
        return before

    def minimum(self) -> float:
        """Cost of the cheapest path; infinite if there is none."""
        return float(self.values[:-1].min(initial=np.inf))

    def paths(self, below: float, maximum: int) -> list[Stops]:
        """The cheapest paths that end at different victims, and cost less than `below`."""
        values = self.values[:-1]
        when = values.argmin(axis=1)
        cheapest = values[np.arange(len(values)), when]
        ends = []
        for i in np.unique(self.network.at[:-1]):
            states = np.flatnonzero(self.network.at[:-1] == i)
            state = int(states[cheapest[states].argmin()])
            if cheapest[state] < below:
                ends.append((float(cheapest[state]), state))
        return [self._trace(state, int(when[state])) for _, state in sorted(ends)[:maximum]]

    def _trace(self, state: int, t: int) -> Stops:
        network = self.network
        stops = []
        while state != network.n_states - 1:
            i = int(network.at[state])
            ways = [
                self.short[state, self.pad + t - network.extra[i, j]] + self.cost[i, j, t]
                for j in range(len(network.options[i]))
            ]
            j = int(np.argmin(ways))
            stops.append((int(network.victims[i]), network.options[i][j], t * network.step))
            t -= int(network.extra[i, j])
            low, high = np.searchsorted(network.head, [state, state + 1])
            legs = network.steps[low:high]
            arc = int(self.done[network.tail[low:high], self.pad + t - legs].argmin())
            state, t = int(network.tail[low + arc]), t - int(legs[arc])
        return tuple(reversed(stops))


def costs_to_go(network: Network, cost: Floats) -> tuple[Floats, Floats]:
    """What the cheapest way on costs, at ``cost (m, n_options, last + 1)``.

    Returns
    -------
    after : array, shape (n_states, last + 1)
        From a state whose service is done at that time; at most 0, for stopping there.
    into : array, shape (n_states, >= last + 1)
        From a state whose shortest option would be done at that time; infinite beyond `last`.

    Raises
    ------
    TimeoutError
        If no time is left.
    """
    block, last = network.block, network.last
    beyond = max(int(network.leg.max()), int(network.extra.max())) + block
    width = block + last + 1 + beyond
    after, into = np.full((2, network.n_states, width), np.inf)
    victim = network.at[:-1]
    around = ((0, 0), (0, 0), (block, beyond))
    ahead = np.pad(cost, around, constant_values=np.inf)
    into_from = sliding_window_view(into.ravel(), block)
    after_from = sliding_window_view(after.ravel(), block)
    base = (network.head * width + network.steps)[network.outward]
    rows = np.arange(network.n_states - 1) * width
    for t in range(last + 1, 0, -block):
        network.look_at_clock()
        # Columns t .. t + block - 1 stand for times that are `block` less.
        own = np.minimum.reduceat(into_from[base + t], network.first_out, axis=0)
        after[:, t : t + block] = 0.0
        after[network.tails, t : t + block] = np.minimum(own, 0.0)
        best = np.full((network.n_states - 1, block), np.inf)
        for j in range(network.n_options):
            extra = network.extra[victim, j]
            onward = after_from[rows + extra + t]
            when = t + extra[:, None] + np.arange(block)
            np.minimum(best, onward + ahead[victim[:, None], j, when], out=best)
        into[:-1, t : t + block] = best
    return after[:, block : block + last + 1], into[:, block:]
