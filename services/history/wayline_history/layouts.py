"""Pure: what is kept of fixes, poses and progress, as whole numbers in columns.

A number is kept in steps far below its own error (a centimetre, a hundredth of a degree), so that
what is read back is the same wherever it was written, and neighbours differ by little.
"""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, get_args

from wayline.messages import FixKind, Message, PoseMode, Verdict

NULL = -(2**62)
"""Stands for unknown in a row."""
US = 1_000
"""Nanoseconds in the microseconds that times are kept in."""
ENGINE = "engine"
T_US = "t_us"
SOURCE = "source"

TrackKind = Literal["raw", "fused", "on_route"]
Kind = TrackKind | Literal["refused"]


class Column(NamedTuple):
    """One quantity of a row."""

    name: str
    """The message's field, with its unit."""
    per_unit: float = 1.0
    """Steps in one unit."""
    is_smooth: bool = False
    """Goes on as before, so that its differences differ by less than it does itself."""
    words: tuple[str, ...] = ()
    """Where it is one of a few words: these; the row holds which."""
    is_text: bool = False
    """Where it is free text: the row holds its number among the texts beside it."""
    is_flag: bool = False
    """0 or 1 for false or true."""
    is_apart: bool = False
    """Rows of one instant that differ in it are several."""


class Layout(NamedTuple):
    """The columns of one kind of row; the first is the time."""

    kind: Kind
    number: int
    """Stands for the kind in the database."""
    columns: tuple[Column, ...]

    def place(self, name: str) -> int:
        """Where in a row a quantity is."""
        return next(i for i, column in enumerate(self.columns) if column.name == name)

    def row(
        self, message: Message | Verdict, texts: dict[str, int], **beside: int | str
    ) -> tuple[int, ...]:
        """A message in steps, `beside` for columns that are not its fields.

        Texts that are new get the next number in `texts`.
        """
        return (
            message.t_ns // US,
            *(
                _steps(column, _value(message, column, beside), texts)
                for column in self.columns[1:]
            ),
        )


def _value(message: Message | Verdict, column: Column, beside: Mapping[str, int | str]) -> Any:
    return beside[column.name] if column.name in beside else getattr(message, column.name)


def _steps(column: Column, value: Any, texts: dict[str, int]) -> int:
    if value is None:
        return NULL
    if column.words:
        return column.words.index(value)
    if column.is_text:
        return texts.setdefault(value, len(texts))
    steps: int = round(value * column.per_unit)
    return steps


TIME = Column(T_US, 1.0, is_smooth=True)
PLACE = (Column("lat_deg", 1e7, is_smooth=True), Column("lon_deg", 1e7, is_smooth=True))
POSES = Layout(
    "fused",
    1,
    (
        TIME,
        *PLACE,
        Column("alt_m", 100.0),
        Column("heading_deg", 100.0),
        Column("speed_mps", 100.0),
        Column("yaw_rate_degps", 100.0),
        Column("grade_pct", 100.0),
        Column("distance_m", 100.0, is_smooth=True),
        Column("mode", words=get_args(PoseMode)),
        Column("east_std_m", 100.0),
        Column("north_std_m", 100.0),
        Column("east_north_cov_m2", 1000.0),
        Column("heading_std_deg", 100.0),
        Column("speed_std_mps", 100.0),
        Column("alt_std_m", 100.0),
        Column("grade_std_pct", 100.0),
        # 0 stands, 1 turns
        Column(ENGINE),
    ),
)
FIXES = Layout(
    "raw",
    2,
    (
        TIME,
        *PLACE,
        Column("alt_m", 100.0),
        Column("speed_mps", 100.0),
        Column("course_deg", 100.0),
        Column("fix", words=get_args(FixKind)),
        Column("mode"),
        Column("speed_derived", is_flag=True),
        Column("satellites"),
        Column("hdop", 100.0),
        Column("pdop", 100.0),
        Column("h_std_m", 100.0),
        Column("speed_std_mps", 100.0),
        Column("repeat", is_flag=True),
        Column(SOURCE, is_text=True, is_apart=True),
    ),
)
PROGRESSES = Layout(
    "on_route",
    3,
    (
        TIME,
        *PLACE,
        Column("route_id", is_text=True),
        Column("trip_id", is_text=True),
        Column("distance_m", 100.0, is_smooth=True),
        Column("lap"),
        Column("cross_track_m", 100.0),
        Column("distance_std_m", 100.0),
        Column("on_route", is_flag=True),
        Column("speed_mps", 100.0),
        Column("direction_id"),
        Column("delay_s", 10.0),
    ),
)
REFUSALS = Layout(
    "refused",
    4,
    (TIME, Column("sensor", is_text=True, is_apart=True), Column("reason", is_text=True)),
)
LAYOUTS: dict[Kind, Layout] = {each.kind: each for each in (FIXES, POSES, PROGRESSES, REFUSALS)}
BY_NUMBER = {each.number: each for each in LAYOUTS.values()}
