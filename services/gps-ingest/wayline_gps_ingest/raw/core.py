"""Pure: epochs of one receiver's raw measurements in, `gps_raw` out."""

from collections.abc import Collection
from typing import ClassVar

import msgspec

from wayline.drive import Correction
from wayline.inputs import Flush
from wayline.messages import EARLIEST_NS, LATEST_NS, GpsRaw, Message, RawSatellite
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS, turned
from wayline.satellites.motion import Motions
from wayline.times_ahead import TimesAhead
from wayline_gps_ingest.onward_clock import OnwardClock
from wayline_gps_ingest.raw.air import Air
from wayline_gps_ingest.raw.clock_jumps import ClockJumps
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.measured import place_of
from wayline_gps_ingest.raw.sky import Sky

MOTION = ("vx_mps", "vy_mps", "vz_mps")


class RawIngestCore:
    """One receiver's raw measurements, made of one kind (`wayline.messages.RawSatellite`).

    `corrected`: what the numbers have behind them already. Where that is the earth's turn, places
    are turned back to the frame of the transmission; where it is the satellites' clocks, a clock
    that is told beside them is left out. Motions that are not told are differenced from places;
    directions that are not told follow from a rough place of the receiver, as does what `air` adds.
    Times far ahead wait for others that agree, as `GpsIngestCore`'s do.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(
        self,
        corrected: Collection[Correction] = (),
        *,
        air: Air | None = None,
        recorded: bool = False,
        clock_from_ns: int = EARLIEST_NS,
    ) -> None:
        self._corrected = frozenset(corrected)
        self._sky = Sky(None if "atmosphere" in self._corrected else air)
        self._ahead = TimesAhead[RawEpoch](doubts_start=recorded)
        self._clock_from_ns = clock_from_ns
        self._clock = OnwardClock()
        self._motions = Motions()
        self._jumps = ClockJumps()
        self._resets = 0

    @property
    def faults(self) -> dict[str, int]:
        """Bad input so far, by reason.

        `clock`: an epoch dropped or moved because its time stepped; `late`: one that came after
        later ones; `clock reset`: the receiver set its clock, the epoch stands and is flagged.
        """
        counted = {
            "clock": self._clock.faults + self._ahead.dropped,
            "late": self._clock.late,
            "clock reset": self._resets,
        }
        return {reason: times for reason, times in counted.items() if times}

    @property
    def bad_input(self) -> int:
        """Epochs that were counted and dropped, moved or flagged."""
        return sum(self.faults.values())

    def handle(self, message: msgspec.Struct, source: str) -> list[Message]:  # noqa: ARG002 -- one receiver
        """Take a RawEpoch or Flush; return what it completes."""
        if isinstance(message, Flush):
            return self._told(self._ahead.finish())
        if not isinstance(message, RawEpoch):
            return []
        received_ns = message.received_ns
        if received_ns is not None and received_ns < self._clock_from_ns:
            received_ns = None
        return self._told(self._ahead.take(message.t_ns, message, received_ns))

    def _told(self, believed: list[tuple[int, RawEpoch]]) -> list[Message]:
        messages: list[Message] = []
        for raw_ns, epoch in believed:
            t_ns = None if self._clock.is_overtaken(raw_ns) else self._clock.fixed_ns(raw_ns)
            if t_ns is not None and t_ns <= LATEST_NS:
                messages.append(self._message(t_ns, epoch))
        return messages

    def _message(self, t_ns: int, epoch: RawEpoch) -> GpsRaw:
        leapt = self._jumps.leapt_ms(epoch.t_ns, epoch.satellites) != 0
        is_reset = epoch.clock_reset or leapt
        self._resets += is_reset
        alike = [self._of_one_kind(t_ns, each) for each in epoch.satellites]
        seen = self._sky.seen(t_ns, alike)
        return GpsRaw(t_ns=t_ns, satellites=seen, clock_reset=is_reset)

    def _of_one_kind(self, t_ns: int, satellite: RawSatellite) -> RawSatellite:
        place_m = place_of(satellite)
        changed: dict[str, float | None] = {}
        if "satellite_clock" in self._corrected:
            changed["clock_bias_m"] = None
        if place_m is not None:
            if "earth_rotation" in self._corrected and satellite.pseudorange_m is not None:
                place_m = turned(place_m, -satellite.pseudorange_m / SPEED_OF_LIGHT_MPS)
                changed |= {"x_m": place_m.x, "y_m": place_m.y}
            if satellite.vx_mps is None:
                named = satellite.system, satellite.prn
                motion_mps = self._motions.motion_mps(named, t_ns, place_m)
                changed |= dict(zip(MOTION, motion_mps or (), strict=False))
        return msgspec.structs.replace(satellite, **changed) if changed else satellite
