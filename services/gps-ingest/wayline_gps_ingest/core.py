"""Pure: sentences and position reports of one receiver in, `gps_fix` and `gps_sky` out."""

import datetime as dt
from collections import Counter
from typing import ClassVar

import msgspec

from wayline.inputs import Flush, PositionReport, Sentence, Tick
from wayline.messages import EARLIEST_NS, LATEST_NS, GpsFix, Message
from wayline.times_ahead import TimesAhead
from wayline_gps_ingest.cycle import EpochAssembler
from wayline_gps_ingest.dates import Dates, nearest_ns
from wayline_gps_ingest.decode import decode
from wayline_gps_ingest.derived_speed import DerivedSpeed
from wayline_gps_ingest.epoch import Epoch
from wayline_gps_ingest.fields import SECOND_NS, BadFieldError
from wayline_gps_ingest.onward_clock import OnwardClock
from wayline_gps_ingest.parsing import parse
from wayline_gps_ingest.reports import fix_of_report
from wayline_gps_ingest.waiting import WaitingRoom

WAIT_NS = SECOND_NS
"""An epoch is complete when nothing more of it came for this long."""


class GpsIngestCore:
    """One receiver of one vehicle; its sources are not mixed, so each receiver has its own core.

    `gps_latency_s`: a fix describes the vehicle this long before its own timestamp.
    `date`: UTC day of the first sentence, for a log whose sentences carry no date.

    An epoch whose date is not known yet is held until a fix with a date comes, for 10 s of the
    receiver's time; older ones are dropped and counted (`undated`). The date of an epoch without a
    fix is not believed before a fix has confirmed it, or input has ended. An epoch far ahead of the
    others and of its receipt waits for others that agree (`wayline.times_ahead`); receipts before
    `clock_from_ns` are of a clock that was never set. In a recording the beginning waits as well
    (`recorded`).
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(
        self,
        gps_latency_s: float = 0.0,
        date: dt.date | None = None,
        *,
        recorded: bool = False,
        clock_from_ns: int = EARLIEST_NS,
    ) -> None:
        self._latency_ns = round(gps_latency_s * SECOND_NS)
        self._assembler = EpochAssembler()
        self._dates = Dates(date)
        self._ahead = TimesAhead[Epoch | GpsFix](doubts_start=recorded)
        self._clock_from_ns = clock_from_ns
        self._clock = OnwardClock()
        self._derived_speed = DerivedSpeed()
        self._faults: Counter[str] = Counter()
        self._waiting = WaitingRoom()
        self._checked = False
        self._day_known = date is not None
        self._received_ns: int | None = None
        self._sky_second: int | None = None

    @property
    def faults(self) -> dict[str, int]:
        """Bad input so far, by reason.

        `checksum` wrong; `torn`: cut short, or without the checksum that this receiver sends;
        `malformed`; `field`: a time, date or position that cannot be one; `undated`: an epoch
        dropped for want of a date; `clock`: an epoch dropped or moved because the receiver's clock
        stepped; `late`: an epoch, a sentence of one or a position report that came again or after
        a later one was published; `report`: a position report outside the world.
        """
        counted = {
            **self._faults,
            "undated": self._waiting.dropped,
            "clock": self._clock.faults + self._ahead.dropped,
            "late": self._assembler.late + self._clock.late,
        }
        return {reason: times for reason, times in counted.items() if times}

    @property
    def bad_input(self) -> int:
        """Inputs that were counted and dropped or mended."""
        return sum(self.faults.values())

    @property
    def told_ns(self) -> int:
        """The instant that was told last, 0 before the first."""
        return self._clock.last_ns or 0

    @property
    def undated(self) -> bool:
        """Whether fixes were lost because no sentence ever carried a date and none was given."""
        return not self._day_known and bool(self._waiting.dropped or len(self._waiting))

    def handle(self, message: msgspec.Struct, source: str) -> list[Message]:  # noqa: ARG002 -- one receiver
        """Take a Sentence, PositionReport, Tick or Flush; return what it completes."""
        if isinstance(message, Sentence):
            return self._sentence(message)
        if isinstance(message, PositionReport):
            return self._report(message)
        if isinstance(message, Tick):
            return self._tick(message.t_ns)
        if isinstance(message, Flush):
            return self._flush()
        return []

    def _sentence(self, sentence: Sentence) -> list[Message]:
        parsed = parse(sentence.text)
        if parsed is None:
            return []
        if isinstance(parsed, str):
            self._faults[parsed] += 1
            return []
        if self._checked and not parsed.checked:
            self._faults["torn"] += 1
            return []
        self._checked = parsed.checked
        try:
            observation = decode(parsed)
        except BadFieldError:
            self._faults["field"] += 1
            return []
        if not self._day_known:
            self._day_known = "dated_ns" in observation.facts
        complete = self._assembler.add(observation)
        self._received_ns = sentence.received_ns
        return self._publish(complete) if complete else []

    def _tick(self, t_ns: int) -> list[Message]:
        time_ns = self._assembler.open_time_ns
        if time_ns is None:
            return []
        received_ns = nearest_ns(time_ns, t_ns) if self._received_ns is None else self._received_ns
        return self._publish(self._assembler.finish()) if t_ns - received_ns >= WAIT_NS else []

    def _publish(self, complete: list[Epoch]) -> list[Message]:
        messages: list[Message] = []
        for epoch in complete:
            messages += self._dated(epoch)
        return messages

    def _dated(self, epoch: Epoch) -> list[Message]:
        """An epoch and those that waited for its date."""
        if epoch.time_ns is None:
            return []
        # without a fix a receiver's date is its own clock's, which may be decades off
        dated_ns = epoch.facts.get("dated_ns") if epoch.is_valid else None
        raw_ns = self._dates.instant_ns(
            epoch.time_ns, dated_ns, self._received_ns, self._ahead.known_ns
        )
        if raw_ns is None:
            self._waiting.hold(epoch)
            return []
        messages: list[Message] = []
        if len(self._waiting):
            for waiting, waiting_ns in self._waiting.release(raw_ns):
                messages += self._at(waiting, waiting_ns)
        return messages + self._at(epoch, raw_ns)

    def _flush(self) -> list[Message]:
        messages = self._publish(self._assembler.finish())
        for waiting, waiting_ns in self._waiting.release_unconfirmed():
            messages += self._at(waiting, waiting_ns)
        for raw_ns, told in self._ahead.finish():
            messages += self._told(told, raw_ns)
        return messages

    def _at(self, told: Epoch | GpsFix, raw_ns: int) -> list[Message]:
        """What is told of an instant of the receiver's clock, once that is believed."""
        received_ns = self._received_ns
        if received_ns is not None and received_ns < self._clock_from_ns:
            received_ns = None
        messages: list[Message] = []
        for believed_ns, each in self._ahead.take(raw_ns, told, received_ns):
            messages += self._told(each, believed_ns)
        return messages

    def _told(self, told: Epoch | GpsFix, raw_ns: int) -> list[Message]:
        raw_ns -= self._latency_ns
        if isinstance(told, GpsFix):
            is_late = self._clock.is_late_report(raw_ns)
            t_ns = None if is_late else self._onward_ns(raw_ns, valid=True)
            return [] if t_ns is None else [msgspec.structs.replace(told, t_ns=t_ns)]
        return self._epoch_told(told, raw_ns)

    def _epoch_told(self, epoch: Epoch, raw_ns: int) -> list[Message]:
        if epoch.repeat:
            t_ns = self._clock.repeat_ns(raw_ns)
        else:
            t_ns = self._onward_ns(raw_ns, valid=epoch.is_valid)
        if t_ns is None or t_ns > LATEST_NS:
            # a clock that stepped back from the last instant of all goes on beyond it
            return []
        fix = epoch.fix(t_ns)
        messages: list[Message] = [self._derived_speed.filled(fix) if fix.valid else fix]
        if epoch.in_view and t_ns // SECOND_NS != self._sky_second:
            # once in a whole second, whatever the receiver's rate
            self._sky_second = t_ns // SECOND_NS
            messages.append(epoch.sky.message(t_ns))
        return messages

    def _onward_ns(self, raw_ns: int, *, valid: bool) -> int | None:
        """When a fix is said to be of; None where it is not told."""
        if raw_ns < 0 or self._clock.is_overtaken(raw_ns):
            return None
        return self._clock.fixed_ns(raw_ns) if valid else self._clock.unfixed_ns(raw_ns)

    def _report(self, report: PositionReport) -> list[Message]:
        fix = fix_of_report(report)
        if fix is None:
            self._faults["report"] += 1
            return []
        self._received_ns = report.received_ns
        return self._at(fix, report.t_ns)
