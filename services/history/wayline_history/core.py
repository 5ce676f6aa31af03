"""Pure: one vehicle's history: which rows are kept, what happened, where a trip ends."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record, Sleep
from wayline.inputs import Flush, Tick
from wayline.messages import (
    FusionStatus,
    GpsFix,
    Message,
    Pose,
    Progress,
    StopEvent,
    Torque,
    Trip,
    Verdict,
)
from wayline_history.incidents import Incidents
from wayline_history.layouts import (
    ENGINE,
    FIXES,
    NULL,
    POSES,
    PROGRESSES,
    REFUSALS,
    SOURCE,
    US,
    Kind,
    Layout,
)
from wayline_history.records import Piece, Rows
from wayline_history.samples import Sample, fix_of, sample_of
from wayline_history.travelled import SourcedFix
from wayline_history.trip_cutter import TripCutter

SECOND_NS = 1_000_000_000
PIECE_NS = 10 * SECOND_NS
"""So much is lost of a process that is killed."""
PIECE_ROWS = 2_000
UNDER_WAY_PIECES = 30
"""The trip under way is kept with every so many pieces, ..."""
YOUNG_PIECES = frozenset({3, 6, 12})
"""... and after so many, for who looks at it soon."""


class HistoryCore:
    """Takes what a vehicle's services publish; gives pieces for the store, and trips.

    `piece_ns` is how much measurement time a piece spans. Of a trip that may still be under way, as
    it was kept before: `known` are the rows of its poses, `fixes` its fixes, `refused_ns` when
    measurements were refused.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset(
        {GpsFix, Pose, Progress, FusionStatus, StopEvent, Torque}
    )
    period_ns: ClassVar[int | None] = PIECE_NS

    def __init__(
        self,
        vehicle_id: str,
        *,
        piece_ns: int = PIECE_NS,
        known: Iterable[Sequence[int]] = (),
        fixes: Iterable[SourcedFix] = (),
        refused_ns: Iterable[int] = (),
    ) -> None:
        self._piece_ns = piece_ns
        self._cutter = TripCutter(vehicle_id)
        self._resume(known, fixes)
        for t_ns in refused_ns:
            self._cutter.refuse(t_ns)
        self._rows: dict[Kind, list[tuple[int, ...]]] = defaultdict(list)
        self._texts: dict[Kind, dict[str, int]] = defaultdict(dict)
        self._incidents = Incidents()
        self._trips: list[Trip] = []
        self._since_ns: int | None = None
        """Of what waits to be handed over."""
        self._second = 0
        """Of the pose kept last."""
        self._progress_second = 0
        self._engine = NULL
        self._pieces = 0
        """Handed over since the trip under way began."""

    def _resume(self, known: Iterable[Sequence[int]], fixes: Iterable[SourcedFix]) -> None:
        """Give the cutter what was kept, in order of time."""
        told: list[tuple[int, SourcedFix | Sample | None]] = [
            *((each.fix.t_ns, each) for each in fixes),
            *((row[0] * US, sample_of(row)) for row in known),
        ]
        for _, each in sorted(told, key=lambda pair: pair[0]):
            if isinstance(each, SourcedFix):
                self._cutter.fix(each)
            else:
                self._cutter.take(each)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take one input."""
        outputs: Sequence[Message | Record | Sleep] = ()
        match message:
            case Pose():
                outputs = self._take_pose(message)
            case GpsFix():
                outputs = self._take_fix(message, source)
            case Progress():
                outputs = self._take_progress(message)
            case FusionStatus():
                outputs = self._take_status(message)
            case StopEvent():
                outputs = self._take_stop(message)
            case Torque():
                self._take_engine(message)
            case Tick():
                outputs = self._pass_time(message.t_ns)
            case Flush():
                outputs = [*self._told(self._cutter.finish()), *self._hand_over(is_last=True)]
        return outputs

    def _take_pose(self, pose: Pose) -> Sequence[Message | Record]:
        second = pose.t_ns // SECOND_NS
        if second == self._second:
            return ()
        self._second = second
        self._incidents.pose(pose)
        row = self._keep(POSES, pose, **{ENGINE: self._engine})
        trips = self._told(self._cutter.take(sample_of(row)))
        return [*trips, *self._due(pose.t_ns)]

    def _take_fix(self, fix: GpsFix, source: str) -> Sequence[Record]:
        if fix.lat_deg is None or fix.lon_deg is None:
            return ()
        row = self._keep(FIXES, fix, **{SOURCE: source})
        self._cutter.fix(SourcedFix(source, fix_of(row)))
        return self._due(fix.t_ns)

    def _take_progress(self, progress: Progress) -> Sequence[Record]:
        self._incidents.progress(progress)
        second = progress.t_ns // SECOND_NS
        if second != self._progress_second:
            self._progress_second = second
            self._keep(PROGRESSES, progress)
        return self._due(progress.t_ns)

    def _take_status(self, status: FusionStatus) -> Sequence[Record]:
        for verdict in self._incidents.status(status):
            self._cutter.refuse(verdict.t_ns)
            self._keep(REFUSALS, verdict)
        return self._due(status.t_ns)

    def _take_stop(self, stop: StopEvent) -> Sequence[Record]:
        self._incidents.stop(stop)
        return self._due(stop.t_ns)

    def _take_engine(self, torque: Torque) -> None:
        if torque.engine_speed_rpm is not None:
            self._engine = int(torque.engine_speed_rpm > 0.0)

    def _pass_time(self, t_ns: int) -> Sequence[Message | Record | Sleep]:
        outputs: list[Message | Record | Sleep] = []
        outputs += self._told(self._cutter.pass_time(t_ns))
        if self._since_ns is not None:
            outputs += self._due(t_ns)
        if self._since_ns is None and not self._cutter.is_open:
            outputs.append(Sleep())
        return outputs

    def _told(self, trip: Trip | None) -> list[Message]:
        if trip is None:
            return []
        self._trips.append(trip)
        return [trip]

    def _is_due_under_way(self) -> bool:
        """Once in five minutes, sooner at first: what it takes is a bit of a whole trip's."""
        self._pieces = self._pieces + 1 if self._cutter.is_open else 0
        is_young = self._pieces in YOUNG_PIECES
        return is_young or (self._pieces > 0 and self._pieces % UNDER_WAY_PIECES == 0)

    def _keep(
        self, layout: Layout, message: Message | Verdict, **beside: int | str
    ) -> tuple[int, ...]:
        row = layout.row(message, self._texts[layout.kind], **beside)
        self._rows[layout.kind].append(row)
        return row

    def _due(self, t_ns: int) -> list[Record]:
        """The piece that is due at an instant; one is also due where time has gone back."""
        if self._since_ns is None:
            self._since_ns = t_ns
        is_due = abs(t_ns - self._since_ns) >= self._piece_ns
        is_full = sum(map(len, self._rows.values())) >= PIECE_ROWS
        return self._hand_over() if is_due or is_full else []

    def _hand_over(self, *, is_last: bool = False) -> list[Record]:
        rows = {
            kind: Rows(tuple(each), tuple(self._texts[kind])) for kind, each in self._rows.items()
        }
        under_way = self._cutter.under_way if self._is_due_under_way() else None
        piece = Piece(
            rows=rows,
            events=self._incidents.spans.take(),
            trips=tuple(self._trips),
            under_way=under_way,
            is_last=is_last,
        )
        self._rows.clear()
        self._texts.clear()
        self._trips.clear()
        self._since_ns = None
        is_empty = not (piece.rows or piece.events or piece.trips or is_last)
        return [] if is_empty else [piece]
