"""Pure: who may do what on a server's bus, as the router's access control (SPEC section 2).

Zenoh checks every message twice, as it enters the router (ingress) and as it leaves (egress), and
no wildcard matches a chunk that begins with `@`. So a rule names, beside the messages' keys, those
of publishers' caches and heartbeats (`<key>/@adv/...`), of liveliness (`@alive`) and of queries
(`@query`); with one of them forgotten, recovery or liveliness ends without a word.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from wayline.errors import InputError
from wayline.keys import FLEET, ROOT, alive_key, is_vehicle_id, message_key, query_key
from wayline.messages import (
    Aiding,
    Arrivals,
    Barometer,
    FusionStatus,
    GpsFix,
    GpsRaw,
    GpsSky,
    Gyro,
    Health,
    Horizon,
    Message,
    Odometer,
    Pose,
    Progress,
    StopEvent,
    Torque,
    Trip,
)

SERVICES_USER = "_services"
"""User of the server's services; no vehicle's id begins with an underscore."""
DASHBOARD_USER = "_dashboard"
"""User of the dashboard: it reads everything and publishes its own health."""

ASK = ("declare_subscriber", "query", "liveliness_query", "declare_liveliness_subscriber")
"""What a reader sends and a publisher gets."""
SAY = ("put", "reply", "declare_queryable", "liveliness_token")
"""What a publisher sends and a reader gets. Nothing of Wayline deletes, so `delete` is denied."""
VEHICLE_SOURCES: dict[str, tuple[type[Message], ...]] = {
    "gps-ingest": (GpsFix, GpsSky, GpsRaw),
    "can-ingest": (GpsFix, Odometer, Gyro, Torque, Barometer),
    "fusion": (Pose, FusionStatus, Aiding),
}
"""What a vehicle's services publish below its id."""
SERVER_SOURCES: dict[str, tuple[type[Message], ...]] = {
    "eta": (Progress, Arrivals, StopEvent),
    "slope-map": (Horizon,),
    "history": (Trip,),
}
"""What a server's services publish for a vehicle; whoever the vehicle is, it is not believed."""

FLEET_RULES = ("vehicles ask the fleet", "vehicles hear of answers", "vehicles hear the fleet")
"""Ids of what a vehicle may beyond its own keys."""

Table = dict[str, Any]


def access_control(vehicle_ids: Sequence[str], *, certificates: bool = False) -> Table:
    """The router's `access_control` table; what no rule allows is denied.

    A vehicle's user is its id: it publishes what its own services measure, reads its own keys, and
    may query what lies ahead. With `certificates` it has these rights only over a connection whose
    certificate has the id as its common name. Raises InputError for what is no vehicle's id and
    for one that is there twice.
    """
    _check(vehicle_ids)
    roles = _server_roles() | {vehicle_id: _vehicle_role(vehicle_id) for vehicle_id in vehicle_ids}
    bound = vehicle_ids if certificates else ()
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [*_server_rules(), *(rule for id_ in vehicle_ids for rule in _vehicle_rules(id_))],
        "subjects": [_subject(user, user in bound) for user in roles],
        "policies": [{"subjects": [user], "rules": rules} for user, rules in roles.items()],
    }


def _subject(user: str, has_certificate: bool) -> Table:
    # a connection has to fit both names
    proven = {"cert_common_names": [user]} if has_certificate else {}
    return {"id": user, "usernames": [user], **proven}


def _check(vehicle_ids: Sequence[str]) -> None:
    for vehicle_id, times in Counter(vehicle_ids).items():
        where = f"vehicle {vehicle_id!r}"
        if not is_vehicle_id(vehicle_id):
            mend = "use up to 64 of a-z, 0-9, _ and -, beginning with a letter or digit"
            raise InputError(where, "is no vehicle id", mend)
        if times > 1:
            raise InputError(where, f"is there {times} times", "name each vehicle once")


def _server_roles() -> dict[str, list[str]]:
    reads = ["all are asked", "readers ask", "readers hear", "readers are seen"]
    return {
        SERVICES_USER: [*reads, "services publish"],
        DASHBOARD_USER: [*reads, "dashboard publishes"],
    }


def _vehicle_role(vehicle_id: str) -> list[str]:
    shared = ["all are asked", *FLEET_RULES]
    return [*shared, *(f"{vehicle_id} {what}" for what in ("says", "asks", "is seen", "hears"))]


def _server_rules() -> list[Table]:
    lookahead, queries = query_key(FLEET, "*"), query_key("*", "*")
    outputs = _source_keys("*", SERVER_SOURCES)
    health = [*_topic_keys(FLEET, Health.topic, "*"), alive_key(FLEET, "*")]
    own = [*_topic_keys(FLEET, Health.topic, "dashboard"), alive_key(FLEET, "dashboard")]
    return [
        # a reader's question names every vehicle (`*`), so it lies within no vehicle's own keys
        _rule("all are asked", "egress", ASK, _vehicle_keys("*")),
        _rule("readers ask", "ingress", ASK, _vehicle_keys("*")),
        _rule("readers hear", "egress", SAY, _vehicle_keys("*")),
        _rule("readers are seen", "ingress", ("liveliness_token",), [f"{ROOT}/**/@adv/sub/**"]),
        _rule("services publish", "ingress", SAY, [*outputs, *health, queries]),
        _rule("dashboard publishes", "ingress", SAY, own),
        _rule("vehicles ask the fleet", "ingress", ("query",), [lookahead]),
        # `*` again: a vehicle's own router asks only where it knows of somebody who answers
        _rule("vehicles hear of answers", "egress", ("declare_queryable",), [queries]),
        _rule("vehicles hear the fleet", "egress", ("reply",), [lookahead]),
    ]


def _vehicle_rules(vehicle_id: str) -> list[Table]:
    keys = _vehicle_keys(vehicle_id)
    health = [
        key
        for source in VEHICLE_SOURCES
        for key in (
            *_topic_keys(vehicle_id, Health.topic, _any_of(source)),
            alive_key(vehicle_id, _any_of(source)),
        )
    ]
    seen = f"{ROOT}/{vehicle_id}/*/*/@adv/sub/**"
    return [
        _rule(
            f"{vehicle_id} says", "ingress", SAY, _source_keys(vehicle_id, VEHICLE_SOURCES) + health
        ),
        _rule(f"{vehicle_id} asks", "ingress", ASK, keys),
        _rule(f"{vehicle_id} is seen", "ingress", ("liveliness_token",), [seen]),
        _rule(f"{vehicle_id} hears", "egress", SAY, keys),
    ]


def _source_keys(vehicle_id: str, sources: Mapping[str, tuple[type[Message], ...]]) -> list[str]:
    return [
        key
        for source, messages in sources.items()
        for message in messages
        for key in _topic_keys(vehicle_id, message.topic, _any_of(source))
    ]


def _any_of(source: str) -> str:
    """A service and its further instances: `gps-ingest-2` for a second receiver."""
    return f"{source}$*"


def _rule(
    name: str, flow: Literal["ingress", "egress"], messages: Sequence[str], keys: Sequence[str]
) -> Table:
    return {
        "id": name,
        "permission": "allow",
        "flows": [flow],
        "messages": list(messages),
        "key_exprs": list(keys),
    }


def _vehicle_keys(vehicle_id: str) -> list[str]:
    """Everything under a vehicle, its `@` keys by name."""
    return [
        f"{ROOT}/{vehicle_id}/**",
        f"{ROOT}/{vehicle_id}/*/*/@adv/**",
        alive_key(vehicle_id, "*"),
        query_key(vehicle_id, "*"),
    ]


def _topic_keys(vehicle_id: str, topic: str, source: str) -> list[str]:
    key = message_key(vehicle_id, topic, source)
    return [key, f"{key}/@adv/**"]
