"""Reads CAN recordings one after the other: their frames, and what was left out and why."""

import contextlib
import datetime as dt
import zoneinfo
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path

import can

from wayline.can_recordings.formats import READABLE, begins, open_recording
from wayline.can_recordings.reading import Reading
from wayline.drive import CanSource
from wayline.errors import InputError, UnreadableError
from wayline.inputs import Frame
from wayline.log_file import encoding_of, head_of

OWN, ERRORS, REMOTE = "sent by the logger itself", "error frames", "remote frames"
OTHER_CHANNEL = "on another channel"
DATED_FROM_S = 315_532_800.0
"""1980: earlier times are a recording's own, which has no date."""
LATEST_S = 4_102_444_800.0
"""2100."""
MOST_ID, MOST_BYTES = 0x1FFF_FFFF, 64


class CanLog:
    """Frames of one or more recordings in order; error, remote and self-sent frames left out.

    `channel` is the one that is read, by the name or number that the file itself uses. `timezone`
    is an IANA name, of dates that a file has by the clock on the wall; `date` the day on which the
    times of a recording without a date begin, at midnight there. `own_frames` takes the frames
    that the logger sent itself. Times without any date count from `undated_from_s` (Unix).

    A recording that cannot be read is one of `problems`, and the others are read; where nothing
    is left of any of them the first of these is raised (UnreadableError).
    """

    def __init__(
        self,
        paths: Sequence[Path],
        *,
        channel: str | int | None = None,
        own_frames: bool = False,
        timezone: str = "UTC",
        date: dt.date | None = None,
        undated_from_s: int = 0,
    ) -> None:
        self.paths = tuple(paths)
        self._channel = None if channel is None else str(channel)
        self._own_frames = own_frames
        self._zone = _zone(timezone, self.paths)
        self._date = date
        self._undated_from_s = undated_from_s
        self.frames = 0
        """Read and not left out."""
        self.own = 0
        """Sent by the logger itself and taken."""
        self.bad_input = 0
        """Damaged lines, records and endings, and frames that cannot be one."""
        self.left_out: Counter[str] = Counter()
        self.channels: Counter[str] = Counter()
        """Frames by channel, where one of them is read."""
        self.problems: list[UnreadableError] = []
        self.undated: list[Path] = []
        """Recordings whose times have no date, neither of their own nor given."""

    @classmethod
    def of(cls, source: CanSource, *, undated_from_s: int = 0) -> "CanLog":
        """As a `[[can]]` says."""
        return cls(
            [Path(path) for path in source.paths],
            channel=source.channel,
            own_frames=source.own_frames,
            timezone=source.timezone,
            date=source.date,
            undated_from_s=undated_from_s,
        )

    def __iter__(self) -> Generator[Frame]:
        for path in self.paths:
            try:
                yield from self._recording(path)
            except UnreadableError as error:
                self.problems.append(error)
        if self.problems and not self.frames:
            raise self.problems[0]

    @property
    def leaves_out(self) -> list[str]:
        """What was left out so far, as people read it."""
        return [f"{count:,} {reason}" for reason, count in self.left_out.items()]

    def find_undated(self) -> list[Path]:
        """Recordings without a date of their own or a given one; reads their first frames."""
        for path in self.paths:
            probe = CanLog([path], own_frames=True, date=self._date)
            with contextlib.suppress(UnreadableError):  # said when it is its turn to be read
                reading = open_recording(path)
                reading.close()
                if reading.is_dated:
                    continue
                frames = iter(probe)
                next(frames, None)
                frames.close()
            self.undated += [each for each in probe.undated if each not in self.undated]
        return self.undated

    def _recording(self, path: Path) -> Iterator[Frame]:
        reading = open_recording(path)
        is_empty = True
        try:
            for frame in self._frames(path, reading):
                is_empty = False
                if frame is not None:
                    yield frame
        except OSError as error:
            raise UnreadableError(
                str(path), f"cannot be read ({error})", "check the file and its disk"
            ) from None
        finally:
            self.bad_input += reading.damaged
            reading.close()
        if is_empty:
            raise _no_frames(path, reading.damaged)

    def _frames(self, path: Path, reading: Reading) -> Iterator[Frame | None]:
        """A frame for each message of a recording, None for what is left out."""
        first_channel = reading.first_channel
        labels: dict[object, str] = {}
        shift_us: int | None = None
        for message in reading:
            if not is_possible(message):
                self.bad_input += 1
                yield None
                continue
            label = labels.get(message.channel)
            if label is None:
                label = labels[message.channel] = channel_label(message.channel, first_channel)
            if not self._takes(message, label):
                yield None
                continue
            if shift_us is None:
                shift_us = self._shift_us(path, message.timestamp, is_local=reading.is_local)
            self.frames += 1
            yield Frame(
                (round(message.timestamp * 1e6) + shift_us) * 1000,
                label,
                message.arbitration_id,
                message.is_extended_id,
                bytes(message.data),
            )

    def _takes(self, message: can.Message, label: str) -> bool:
        """Whether a message is read; counts why it is not."""
        if message.is_error_frame:
            self.left_out[ERRORS] += 1
            return False
        if message.is_remote_frame:
            self.left_out[REMOTE] += 1
            return False
        if self._channel is not None:
            self.channels[label] += 1
            if label != self._channel:
                self.left_out[OTHER_CHANNEL] += 1
                return False
        if not message.is_rx:
            if not self._own_frames:
                self.left_out[OWN] += 1
                return False
            self.own += 1
        return True

    def _shift_us(self, path: Path, first_s: float, *, is_local: bool) -> int:
        """From a recording's times to Unix time."""
        if first_s < DATED_FROM_S:
            if self._date is None:
                self.undated += [] if path in self.undated else [path]
                return self._undated_from_s * 1_000_000
            midnight = dt.datetime.combine(self._date, dt.time(), self._zone)
            return round(midnight.timestamp()) * 1_000_000
        if not is_local:
            return 0
        wall = dt.datetime.fromtimestamp(first_s, dt.UTC).replace(tzinfo=self._zone)
        offset = wall.utcoffset() or dt.timedelta()
        return -round(offset.total_seconds()) * 1_000_000


def channel_label(channel: object, first_channel: int) -> str:
    """What the file itself calls a channel; empty where it names none."""
    if channel is None:
        return ""
    return str(channel + first_channel if isinstance(channel, int) else channel)


def is_possible(message: can.Message) -> bool:
    """Whether a message is one that a bus can carry, at a time between 1970 and 2100."""
    return (
        0.0 <= message.timestamp < LATEST_S
        and 0 <= message.arbitration_id <= MOST_ID
        and len(message.data) <= MOST_BYTES
    )


def _no_frames(path: Path, damaged: int) -> UnreadableError:
    head = head_of(path)
    if not damaged:
        return UnreadableError(str(path), "holds no CAN frames", "record while the bus is awake")
    began = begins(head.decode(encoding_of(head), errors="replace"))
    what = f"not one of its {damaged:,} lines or records is understood ({began})"
    return UnreadableError(str(path), what, READABLE)


def _zone(timezone: str, paths: Sequence[Path]) -> zoneinfo.ZoneInfo:
    try:
        return zoneinfo.ZoneInfo(timezone)
    except (zoneinfo.ZoneInfoNotFoundError, ValueError, OSError):
        raise InputError(
            f"[[can]] {', '.join(map(str, paths))}",
            f"unknown timezone {timezone!r}",
            'give an IANA name such as "Europe/Berlin"',
        ) from None
