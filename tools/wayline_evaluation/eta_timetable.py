"""Pure: what was told of arrivals beside what the timetable says of the same, once a minute."""

from collections.abc import Sequence

import msgspec

from wayline.messages import Arrivals, StopArrival
from wayline_evaluation.eta import EVERY_NS, Beside


def promised(told: Sequence[Arrivals]) -> Beside | None:
    """Of stops with a scheduled time; None where there are none."""
    kept, planned = [], []
    for each in told:
        if each.stale or each.t_ns % EVERY_NS:
            continue
        pairs = [(stop, by) for stop in each.stops if (by := _as_planned(stop)) is not None]
        if pairs:
            stops, scheduled = zip(*pairs, strict=True)
            kept.append(msgspec.structs.replace(each, stops=stops))
            planned.append(msgspec.structs.replace(each, stops=scheduled))
    return Beside(kept, planned) if kept else None


def _as_planned(stop: StopArrival) -> StopArrival | None:
    at_ns = stop.scheduled_ns
    if at_ns is None:
        return None
    return msgspec.structs.replace(stop, arrival_ns=at_ns, early_ns=at_ns, late_ns=at_ns)
