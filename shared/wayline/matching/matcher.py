"""Pure: where on a network a vehicle is, told from all the places where it might be.

A hidden Markov model (Newson and Krumm, Hidden Markov map matching through noise and sparseness,
2009, with costs of its own): the states are places on edges, the emission is offset and course of
a sight, the transition compares how far the place moved along the network with how far the vehicle
says it travelled. So a street that a route passes twice is told apart by motion, two streets side
by side by where the vehicle came from, and a wrong first guess is given up when it stops fitting.
"""

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.matching.emission import Emission, turn_deg
from wayline.matching.network import Candidate, Network, Sight
from wayline.matching.transition import JUMP_COST, Moves

FORGET_COST = 30.0
MANY_WAYS = 256
"""From so many on arrays are quicker than a loop."""

Advances = Callable[[Sequence[Candidate], Sequence[Candidate], float], NDArray[np.float64]]
"""`Network.advance_m` from each of some places to each of others, about as far, all at once:
shape (to, from)."""


class Matched(NamedTuple):
    """The likeliest place."""

    candidate: Candidate
    total_m: float
    """How far the vehicle has come along its edge; on a loop it goes on growing over the laps."""
    turn_deg: float
    """Between the vehicle's course and the edge's, 0 to 180; 0 where it is not known."""


class _State(NamedTuple):
    """A place where the vehicle may be, by the likeliest way there."""

    cost: float
    total_m: float
    candidate: Candidate


class Matcher:
    """Of one vehicle: Viterbi's algorithm, a step a sight."""

    def __init__(
        self, network: Network, jump_cost: float = JUMP_COST, advances: Advances | None = None
    ) -> None:
        """`jump_cost` is the most that a place can lose by moving unlike the vehicle.

        `advances` is of networks that can tell many ways at once, and lead from everywhere to
        everywhere.
        """
        self._network, self._jump_cost, self._advances = network, jump_cost, advances
        self._states: list[_State] = []
        """The likeliest first."""
        self._last: Sight | None = None

    def set_out(self, sight: Sight, candidate: Candidate) -> None:
        """Begin at a place, wherever else the sight might be."""
        self._states, self._last = [_State(0.0, candidate.along_m, candidate)], sight

    def forget(self) -> None:
        """Begin anew with the next sight."""
        self._states, self._last = [], None

    def observe(self, sight: Sight, moves: Moves) -> Matched | None:
        """Take the next sight and how far the vehicle has come since the last one.

        None where the network is not near: the next sight is then a first one. Of the first one
        the moves say nothing.
        """
        candidates = self._network.near(sight)
        if not candidates:
            self.forget()
            return None
        emission = Emission(self._last, sight)
        states = [
            state._replace(cost=state.cost + emission.cost(state.candidate))
            for state in self._reached(candidates, moves)
        ]
        states.sort(key=attrgetter("cost"))
        least, total_m, candidate = states[0]
        self._states = [
            state._replace(cost=state.cost - least)
            for state in states
            if state.cost <= least + FORGET_COST
        ]
        self._last = sight
        return Matched(candidate, total_m, turn_deg(sight, candidate))

    def _reached(self, candidates: Sequence[Candidate], moves: Moves) -> list[_State]:
        """Each candidate by the likeliest of the ways from where the vehicle was."""
        if not self._states:
            return self._anew(candidates)
        if self._advances and len(self._states) * len(candidates) >= MANY_WAYS:
            return self._by_many_ways(self._advances, candidates, moves)
        return [self._by_way(candidate, moves) for candidate in candidates]

    def _by_way(self, candidate: Candidate, moves: Moves) -> _State:
        about_m = moves.middle_m
        best: tuple[float, float | None] = (float("inf"), None)
        for earlier in self._states:
            if earlier.cost >= best[0]:
                break  # they are in order, and no way is cheaper than nothing
            advance_m = self._network.advance_m(earlier.candidate, candidate, about_m)
            cost = earlier.cost + moves.cost(advance_m, self._jump_cost)
            if cost < best[0]:
                best = cost, None if advance_m is None else earlier.total_m + advance_m
        cost, total_m = best
        if total_m is None:
            (state,) = self._anew([candidate])
            return state._replace(cost=cost)
        return _State(cost, total_m, candidate)

    def _by_many_ways(
        self, advances: Advances, candidates: Sequence[Candidate], moves: Moves
    ) -> list[_State]:
        """`_by_way` of all: where a line passes a place a hundred times they are ten thousand."""
        earlier = [state.candidate for state in self._states]
        before = np.array([state.cost for state in self._states])
        advances_m = advances(earlier, candidates, moves.middle_m)
        costs = before + moves.costs(advances_m, self._jump_cost)
        found = []
        for row, (at, candidate) in enumerate(
            zip(costs.argmin(axis=1).tolist(), candidates, strict=True)
        ):
            total_m = self._states[at].total_m + float(advances_m[row, at])
            found.append(_State(float(costs[row, at]), total_m, candidate))
        return found

    def _anew(self, candidates: Sequence[Candidate]) -> list[_State]:
        firsts = self._network.first(candidates)
        return [
            _State(first.cost, first.total_m, candidate)
            for first, candidate in zip(firsts, candidates, strict=True)
        ]
