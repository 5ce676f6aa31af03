"""Pure: what a bus is, by profiles and databases, and a mapping for it.

Databases and profiles are given as they were loaded.
"""

from collections.abc import Mapping as AnyMapping
from collections.abc import Sequence
from pathlib import PurePath
from typing import NamedTuple

from cantools.database.can import Database

from wayline.drive import CanMapping, Vehicle
from wayline.errors import InputError
from wayline.inputs import Frame
from wayline_can_ingest.diagnosis.findings import Fit, duration_s, share_of, with_quantities
from wayline_can_ingest.diagnosis.proposal import messages_by_name, propose
from wayline_can_ingest.diagnosis.seen import is_matched_by_pgn, seen_in
from wayline_can_ingest.diagnosis.table import can_table, profile_table, signals_of
from wayline_can_ingest.mapping import Mapping, compile_mapping

WORTH_PCT = 10.0
"""A profile of which fewer frames come is another vehicle's."""
J1939 = "j1939-truck"
"""The profile that tells such a bus."""
PROPOSED = "proposed"


class Diagnosis(NamedTuple):
    """What was found."""

    frames: int
    identifiers: int
    extended: int
    """How many of the identifiers have 29 bits."""
    lasted_s: float
    profiles: tuple[Fit, ...]
    """The profiles that fit, the best first."""
    proposed: Fit | None
    profile_table: str | None
    can_table: str | None

    @property
    def fits(self) -> tuple[Fit, ...]:
        """The profiles, and what is proposed."""
        return (*self.profiles, self.proposed) if self.proposed else self.profiles


def diagnose(
    frames: Sequence[Frame],
    profiles: AnyMapping[str, Mapping],
    databases: Sequence[Database] = (),
    dbc: Sequence[PurePath] = (),
    source: Sequence[str] = (),
) -> Diagnosis:
    """Judge frames by every profile; propose from databases. `source` is the `[[can]]`'s keys.

    Raises InputError where databases were given that say nothing of this bus.
    """
    identifiers = {(each.arbitration_id, each.extended) for each in frames}
    fits = [_fit(name, mapping, frames) for name, mapping in profiles.items()]
    fits = sorted((fit for fit in fits if fit.arriving), key=lambda fit: -fit.share_pct)
    is_truck = any(fit.name == J1939 for fit in fits)
    names = [fit.name for fit in fits]
    table = _proposed(frames, databases, dbc, source, is_truck=is_truck) if databases else None
    return Diagnosis(
        frames=len(frames),
        identifiers=len(identifiers),
        extended=sum(extended for _, extended in identifiers),
        lasted_s=duration_s(frames),
        profiles=tuple(fits),
        proposed=_checked(table, frames, databases) if table and frames else None,
        profile_table=f"{can_table(source)}\n\n{profile_table(names)}" if names else None,
        can_table=table,
    )


def _fit(name: str, mapping: Mapping, frames: Sequence[Frame]) -> Fit:
    """How a profile fits; without quantities where it does not."""
    fit = share_of(name, mapping, frames)
    if fit.share_pct < WORTH_PCT:
        return fit
    return with_quantities(fit, mapping, frames)


def _proposed(
    frames: Sequence[Frame],
    databases: Sequence[Database],
    dbc: Sequence[PurePath],
    source: Sequence[str],
    *,
    is_truck: bool,
) -> str:
    """A mapping as text."""
    messages, where = messages_by_name(databases), ", ".join(map(str, dbc))
    by_pgn = is_matched_by_pgn(messages.values(), frames)
    all_extended = all(each.is_extended_frame for each in messages.values())
    j1939 = by_pgn or (is_truck and all_extended)
    seen = seen_in(messages.values(), frames, j1939=j1939) if frames else None
    if seen is not None and not seen.messages:
        raise InputError(where, "none of its messages was heard", "name this bus's own database")
    proposals = propose(messages, seen)
    if not proposals:
        mend = "map by hand: deploy/wayline.toml explains [can.signals]"
        raise InputError(where, "none of its signals looks like what Wayline reads", mend)
    return can_table(source, dbc, proposals, j1939=j1939)


def _checked(table: str, frames: Sequence[Frame], databases: Sequence[Database]) -> Fit:
    """What can-ingest makes of the very text."""
    j1939 = "\nj1939 = true\n" in table
    source = CanMapping(signals=signals_of(table), j1939=j1939)
    mapping = compile_mapping(source, databases, Vehicle(), PROPOSED)
    return with_quantities(share_of(PROPOSED, mapping, frames), mapping, frames)
