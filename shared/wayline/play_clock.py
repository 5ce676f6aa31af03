"""Agrees with the other processes that play parts of the same drive when each instant is due."""

import time
from typing import Any

import msgspec
import zenoh

from wayline.keys import query_key
from wayline.strict import Strict

LEAD_S = 2.0
"""Players start this long after the first of them came, so that the others find it."""
ASK_S = 0.5


class PlayClock(Strict, frozen=True, kw_only=True):
    """Drive time `origin_ns` is played at wall time `start_ns`; a loop lasts `period_ns`."""

    origin_ns: int
    start_ns: int
    period_ns: int
    running: bool = False
    """Agreed and no longer open to change."""


def agree(session: zenoh.Session, vehicle_id: str, own: PlayClock) -> tuple[PlayClock, Any]:
    """The clock that all players of a vehicle share, and the queryable that tells later ones.

    A player that comes later takes the running clock; those that come together combine theirs
    (first origin, last start, longest period), which comes out the same for each.
    """
    state = [own]

    def reply(query: zenoh.Query) -> None:
        with query:
            query.reply(query.key_expr, msgspec.json.encode(state[0]))

    key = query_key(vehicle_id, "playback")
    queryable = session.declare_queryable(key, reply)
    deadline_s = time.monotonic() + LEAD_S / 2.0
    others: list[PlayClock] = []
    while time.monotonic() < deadline_s and not any(clock.running for clock in others):
        others += _ask(session, key)
        time.sleep(0.05)
    clock = next((clock for clock in others if clock.running), None) or combined([own, *others])
    state[0] = msgspec.structs.replace(clock, running=True)
    return clock, queryable


def combined(clocks: list[PlayClock]) -> PlayClock:
    """One clock out of those of players that came together."""
    return PlayClock(
        origin_ns=min(clock.origin_ns for clock in clocks),
        start_ns=max(clock.start_ns for clock in clocks),
        period_ns=max(clock.period_ns for clock in clocks),
    )


def _ask(session: zenoh.Session, key: str) -> list[PlayClock]:
    replies = session.get(
        key, timeout=ASK_S, consolidation=zenoh.ConsolidationMode.NONE, target=zenoh.QueryTarget.ALL
    )
    return [
        msgspec.json.decode(reply.ok.payload.to_bytes(), type=PlayClock)
        for reply in replies
        if reply.ok is not None
    ]
