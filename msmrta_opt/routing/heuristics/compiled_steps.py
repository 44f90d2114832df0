"""The steps of ruin and recreate, compiled: the same moves as `ruin_and_recreate`, on arrays.

Routes are rows of an array; a step notes what it changes, so that it can be taken back. What serving a
victim costs a robot is worked out again only once the robot's route has changed. Only robots that are
at work near a victim are asked to serve it, so that a step takes the same time on large missions. All
chance comes from a generator of its own, and nothing but basic arithmetic is used: the same seed and
number of steps give the same routes on every machine.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from ...compiled import inlined_in_place, kernel
from .compiled_state import COMPLETION, FINISH, PROBLEM, SETTINGS, STATE, Problem, Settings, State

ROUNDING = 1e-9


@inlined_in_place
def _draw(s: State) -> float:
    """A number from 0 to below 1: splitmix64 (Steele, Lea and Flood, 2014)."""
    s.random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = s.random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return np.float64(z >> np.uint64(11)) * 2.0**-53


@inlined_in_place
def _below(s: State, n: int) -> int:
    return int(_draw(s) * n)


@inlined_in_place
def _minus_log(u: float) -> float:
    """The natural logarithm of 1 / u, by a series: libraries differ in the last digits of theirs."""
    mantissa, exponent = math.frexp(u)
    t = (mantissa - 1.0) / (mantissa + 1.0)
    power, total = t, 0.0
    for k in range(1, 31, 2):
        total += power / k
        power *= t * t
    return -(2.0 * total + exponent * 0.6931471805599453)


@inlined_in_place
def _go(p: Problem, r: int, v: int, w: int) -> float:
    return float(p.length[r if len(p.length) > 1 else 0, v, w] / p.speed[r])


@inlined_in_place
def _added(p: Problem, s: State, r: int, v: int, i: int) -> float:
    """The travel that visiting `v` at place `i` adds to the route of `r`."""
    n = s.length[r]
    if n == 0:
        return float(p.leave[r, v] + p.back[r, v])
    if i == 0:
        first = s.route[r, 0]
        return float(p.leave[r, v] + _go(p, r, v, first) - p.leave[r, first])
    before = s.route[r, i - 1]
    if i == n:
        return float(_go(p, r, before, v) + p.back[r, v] - p.back[r, before])
    after = s.route[r, i]
    return _go(p, r, before, v) + _go(p, r, v, after) - _go(p, r, before, after)


@inlined_in_place
def _done(p: Problem, s: State, r: int) -> None:
    """When each visit of `r` is done, into ``s.done``."""
    clock = 0.0
    for i in range(s.length[r]):
        v = s.route[r, i]
        clock += _go(p, r, s.route[r, i - 1], v) if i else p.leave[r, v]
        for g in range(p.first[v], p.first[v + 1]):
            if s.who[g] == r:
                clock += p.service[g]
        s.done[i] = clock


@inlined_in_place
def _time(p: Problem, s: State, r: int) -> None:
    """Work out ``busy`` and ``travel`` of `r`."""
    travel, service, n = 0.0, 0.0, s.length[r]
    for i in range(n):
        v = s.route[r, i]
        travel += _go(p, r, s.route[r, i - 1], v) if i else p.leave[r, v]
        for g in range(p.first[v], p.first[v + 1]):
            if s.who[g] == r:
                service += p.service[g]
    if n:
        travel += p.back[r, s.route[r, n - 1]]
    s.busy[r], s.travel[r] = travel + service, travel


@inlined_in_place
def _cost(p: Problem, s: State, c: Settings) -> float:
    total, last = 0.0, 0.0
    for r in range(len(s.length)):
        total += s.busy[r]
        last = max(last, s.busy[r])
    if c.of_victims:
        for v in range(len(s.completion)):
            s.completion[v] = 0.0
        for r in range(len(s.length)):
            _done(p, s, r)
            for i in range(s.length[r]):
                v = s.route[r, i]
                s.completion[v] = max(s.completion[v], s.done[i])
        weighted = 0.0
        for v in range(len(s.completion)):
            weighted += p.priority[v] * s.completion[v]
        return weighted
    # Among equal makespans the smallest total leads on: a flat objective has no slope.
    return last + 1e-4 * total if c.only_last else total


@inlined_in_place
def _touch(s: State, r: int) -> None:
    """Note how `r` is, unless that was done in this step; and give its route another version."""
    if s.saved[r, 1] < 0:
        s.touched[s.counts[1]] = r
        s.counts[1] += 1
        s.saved[r, 0], s.saved[r, 1] = s.length[r], s.version[r]
        s.saved_times[r, 0], s.saved_times[r, 1] = s.busy[r], s.travel[r]
        for i in range(s.length[r]):
            s.saved_route[r, i] = s.route[r, i]
    s.counts[0] += 1
    s.version[r] = s.counts[0]


@inlined_in_place
def _take_back(s: State, is_kept: bool) -> None:
    """End a step: forget what was noted, and unless it is kept, put all back as it was."""
    for t in range(s.counts[1]):
        r = s.touched[t]
        if not is_kept:
            for i in range(s.length[r]):
                s.at[r, s.route[r, i]] = -1
            s.length[r], s.version[r] = s.saved[r, 0], s.saved[r, 1]
            s.busy[r], s.travel[r] = s.saved_times[r, 0], s.saved_times[r, 1]
            for i in range(s.length[r]):
                s.route[r, i] = s.saved_route[r, i]
                s.at[r, s.route[r, i]] = i
        s.saved[r, 1] = -1
    if not is_kept:
        for i in range(s.counts[2]):
            s.who[s.moved[i]] = s.moved_from[i]
    s.counts[1] = s.counts[2] = 0


@inlined_in_place
def _remove(p: Problem, s: State, r: int, start: int, length: int) -> None:
    """Take visits out of a route, and their requirements."""
    _touch(s, r)
    for i in range(start, start + length):
        v = s.route[r, i]
        s.at[r, v] = -1
        for g in range(p.first[v], p.first[v + 1]):
            if s.who[g] == r:
                s.moved[s.counts[2]], s.moved_from[s.counts[2]] = g, r
                s.counts[2] += 1
                s.who[g] = -1
    s.length[r] -= length
    for i in range(start, s.length[r]):
        s.route[r, i] = s.route[r, i + length]
        s.at[r, s.route[r, i]] = i
    _time(p, s, r)


@inlined_in_place
def _ruin(p: Problem, s: State, c: Settings) -> None:
    """Take strings of visits out of routes around a victim at random."""
    used, visits = 0, 0
    for r in range(len(s.length)):
        used += s.length[r] > 0
        visits += s.length[r]
    longest = max(1.0, min(float(c.longest_string), visits / used))
    n_strings = int(_draw(s) * (4 * c.average_removed / (1 + longest))) + 1
    centre = p.needed[_below(s, len(p.needed))]
    n_ruined = 0
    for i in range(p.near.shape[1]):
        if n_ruined >= n_strings:
            break
        v = p.near[centre, i]
        for g in range(p.first[v], p.first[v + 1]):
            r = s.who[g]
            # A robot that was ruined already is noted as touched.
            if r < 0 or s.saved[r, 1] >= 0:
                continue
            n = s.length[r]
            length = int(_draw(s) * min(longest, float(n))) + 1
            at = s.at[r, v]
            low, high = max(0, at - length + 1), min(at, n - length)
            _remove(p, s, r, low + _below(s, high - low + 1), length)
            n_ruined += 1


@inlined_in_place
def _nearest(p: Problem, s: State, c: Settings, r: int, v: int) -> None:
    """Find out where `v` adds the smallest travel to the route of `r`, unless that is known."""
    if s.stamp[r, v] == s.version[r]:
        return
    n = s.length[r]
    best, place = _added(p, s, r, v, 0), 0
    for i in range(1, n):
        added = _added(p, s, r, v, i)
        if added < best and _draw(s) > c.blink:
            best, place = added, i
    if n:
        added = _added(p, s, r, v, n)
        if added < best:
            best, place = added, n
    s.added[r, v], s.place[r, v], s.stamp[r, v] = best, place, s.version[r]


@inlined_in_place
def _soonest(p: Problem, s: State, c: Settings, r: int, g: int) -> tuple[float, float, int]:
    """The growth of weighted completion times, the travel added, and the place; see `_insertion`."""
    v, n, weight, elsewhere = p.victim[g], s.length[r], 0.0, 0.0
    for i in range(max(s.at[r, v], 0), n):
        weight += p.priority[s.route[r, i]]
    if s.at[r, v] >= 0:
        return p.service[g] * weight, 0.0, -1
    for other in range(p.first[v], p.first[v + 1]):
        q = s.who[other]
        if q >= 0:
            _done(p, s, q)
            elsewhere = max(elsewhere, s.done[s.at[q, v]])
    _done(p, s, r)
    best, place, travel = np.inf, n, 0.0
    for i in range(n + 1):
        added = _added(p, s, r, v, i)
        there = s.done[i - 1] + _go(p, r, s.route[r, i - 1], v) if i else p.leave[r, v]
        late = max(there + p.service[g] - elsewhere, 0.0)
        cost = p.priority[v] * late + (added + p.service[g]) * weight
        if cost < best and (i == n or _draw(s) > c.blink):
            best, place, travel = cost, i, added
        if i < n:
            weight -= p.priority[s.route[r, i]]
    return best, travel, place


@inlined_in_place
def _ask_all(p: Problem, s: State, g: int) -> int:
    """The robots that can serve `g`, into ``s.candidates``; how many."""
    n = 0
    for r in range(len(s.length)):
        if p.able[g, r]:
            s.candidates[n] = r
            n += 1
    return n


@inlined_in_place
def _ask(p: Problem, s: State, c: Settings, g: int) -> int:
    """The robots that may serve `g`, into ``s.candidates``; how many.

    All that can, where they are few; else those at work nearest to it, and the next ones at home.
    """
    if p.n_able[g] <= c.max_candidates:
        return _ask_all(p, s, g)
    n = 0
    s.counts[3] += 1
    for i in range(p.near.shape[1]):
        v = p.near[p.victim[g], i]
        for other in range(p.first[v], p.first[v + 1]):
            r = s.who[other]
            if r >= 0 and p.able[g, r] and s.asked[r] != s.counts[3]:
                s.asked[r] = s.counts[3]
                s.candidates[n] = r
                n += 1
        if n >= c.max_candidates:
            break
    closest, minimum = -1, np.inf
    for r in range(len(s.length)):
        if s.length[r] == 0 and p.able[g, r] and p.leave[r, p.victim[g]] < minimum:
            closest, minimum = r, p.leave[r, p.victim[g]]
    if closest >= 0 and s.asked[closest] != s.counts[3]:
        s.candidates[n] = closest
        n += 1
    return n


@inlined_in_place
def _choose(
    p: Problem, s: State, c: Settings, g: int, n: int, is_perturbed: bool
) -> tuple[int, int, float]:
    """The robot of the first `n` candidates that serves `g` at the lowest cost, where, and how far."""
    v, best, robot, where, far = p.victim[g], np.inf, -1, -1, 0.0
    for i in range(n):
        r = s.candidates[i]
        if c.insertion == COMPLETION:
            cost, added, place = _soonest(p, s, c, r, g)
        elif s.at[r, v] >= 0:
            cost, added, place = 0.0, 0.0, -1
        else:
            _nearest(p, s, c, r, v)
            cost, added, place = s.added[r, v], s.added[r, v], s.place[r, v]
        total, walk = s.busy[r] + added + p.service[g], s.travel[r] + added
        if total > p.endurance[r] + ROUNDING or walk > p.longest_walk[r] + ROUNDING:
            continue
        if c.insertion == FINISH:
            cost = total + added
        if is_perturbed and _draw(s) < c.perturbed:
            cost *= _draw(s)
        if cost < best:
            best, robot, where, far = cost, r, place, added
    return robot, where, far


@inlined_in_place
def _sort(p: Problem, s: State) -> None:
    """Bring what was taken out into an order: at random, the choosiest first, or the longest first."""
    n, order = s.counts[2], _draw(s)
    for i in range(1, n):
        g, old = s.moved[i], s.moved_from[i]
        if order < 0.5:
            j = _below(s, i + 1)
            s.moved[i], s.moved_from[i] = s.moved[j], s.moved_from[j]
            s.moved[j], s.moved_from[j] = g, old
            continue
        j = i
        while j > 0 and (
            p.n_able[s.moved[j - 1]] > p.n_able[g]
            if order < 0.8
            else p.service[s.moved[j - 1]] < p.service[g]
        ):
            s.moved[j], s.moved_from[j] = s.moved[j - 1], s.moved_from[j - 1]
            j -= 1
        s.moved[j], s.moved_from[j] = g, old


@inlined_in_place
def _recreate(p: Problem, s: State, c: Settings) -> bool:
    """Put requirements back, each where it costs least; whether all of them could be."""
    _sort(p, s)
    is_perturbed = _draw(s) < c.perturbed
    for i in range(s.counts[2]):
        g = s.moved[i]
        v = p.victim[g]
        n = _ask(p, s, c, g)
        r, place, added = _choose(p, s, c, g, n, is_perturbed)
        if r < 0 and n < p.n_able[g]:
            n = _ask_all(p, s, g)
            r, place, added = _choose(p, s, c, g, n, is_perturbed)
        if r < 0:
            return False
        if place >= 0 or s.saved[r, 1] < 0:
            _touch(s, r)
        if place >= 0:
            for j in range(s.length[r], place, -1):
                s.route[r, j] = s.route[r, j - 1]
                s.at[r, s.route[r, j]] = j
            s.route[r, place], s.at[r, v] = v, place
            s.length[r] += 1
        s.busy[r] += added + p.service[g]
        s.travel[r] += added
        s.who[g] = r
    return True


@kernel(types.void(PROBLEM, STATE, SETTINGS), allocates=False)
def begin(p: Problem, s: State, c: Settings) -> None:
    """Work out the times and the cost of the routes to begin with, which are the best so far."""
    for r in range(len(s.length)):
        _time(p, s, r)
    s.cost[0] = s.cost[1] = _cost(p, s, c)


@kernel(types.void(PROBLEM, STATE, SETTINGS, types.float64, types.int64), allocates=False)
def steps(p: Problem, s: State, c: Settings, temperature: float, n: int) -> None:
    """Make `n` steps of ruin and recreate at one temperature of simulated annealing."""
    for _ in range(n):
        _ruin(p, s, c)
        is_whole = _recreate(p, s, c)
        cost = _cost(p, s, c) if is_whole else np.inf
        is_kept = cost < s.cost[0] + temperature * _minus_log(_draw(s) + 2.0**-54)
        _take_back(s, is_kept)
        if not is_kept:
            continue
        s.cost[0] = cost
        if cost < s.cost[1] - ROUNDING:
            s.cost[1] = cost
            for g in range(len(s.who)):
                s.best_who[g] = s.who[g]
            for r in range(len(s.length)):
                s.best_length[r] = s.length[r]
                for i in range(s.length[r]):
                    s.best_route[r, i] = s.route[r, i]
