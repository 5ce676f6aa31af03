"""The doctor's check of agencies' realtime feeds: each is asked once."""

import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from urllib.parse import urlsplit

from wayline.errors import InputError
from wayline.live_sources import LiveAvl
from wayline_cli.check import Check, fine, wrong
from wayline_gps_ingest.agency_key import key_of
from wayline_gps_ingest.realtime_client import FeedError, RealtimeClient
from wayline_gps_ingest.vehicle_positions import NotRealtimeError, read_vehicle_positions

OLD_S = 300.0
"""A feed is to be refreshed within half a minute."""


def check_agencies(agencies: Sequence[LiveAvl], environment: Mapping[str, str]) -> list[Check]:
    """What each of the feeds answers now."""
    return [_checked(each, environment) for each in agencies]


def _checked(agency: LiveAvl, environment: Mapping[str, str]) -> Check:
    subject = f"agency {urlsplit(agency.url).hostname}"
    try:
        with closing(RealtimeClient(agency, key_of(agency, environment))) as client:
            snapshot = read_vehicle_positions(client.fetched() or b"")
    except InputError as error:
        return wrong(subject, error.what, error.mend)
    except FeedError as error:
        return wrong(subject, str(error), "check [[avl]] url and the key")
    except NotRealtimeError as error:
        mend = "set [[avl]] url to the agency's vehicle positions in GTFS-Realtime"
        return wrong(subject, f"answers with {error}", mend)
    told = f"{len(snapshot.vehicles):,} vehicles"
    if snapshot.told_ns is None:
        return fine(subject, told)
    age_s = time.time() - snapshot.told_ns * 1e-9
    if age_s > OLD_S:
        return wrong(
            subject, f"{told}, {age_s:,.0f} s old", "ask the agency; its feed stands still"
        )
    return fine(subject, f"{told}, {max(age_s, 0.0):.0f} s old")
