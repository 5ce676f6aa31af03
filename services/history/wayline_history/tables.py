"""Pure: the tables of the history.

Rows of fixes, poses and progress are kept by vehicle, kind and hour, many rows to a chunk
(`chunk.py`). On PostgreSQL the table of chunks is partitioned by day.
"""

import sqlalchemy as sa

METADATA = sa.MetaData()
HOUR_US = 3_600_000_000
DAY_HOURS = 24

VEHICLES = sa.Table(
    "history_vehicle",
    METADATA,
    sa.Column("vehicle_no", sa.Integer, primary_key=True),
    sa.Column("vehicle_id", sa.Text, nullable=False, unique=True),
)

CHUNKS = sa.Table(
    "history_chunk",
    METADATA,
    sa.Column("chunk_no", sa.BigInteger().with_variant(sa.Integer, "sqlite"), primary_key=True),
    # hours since 1970, UTC; no chunk goes over the end of one
    sa.Column("hour", sa.Integer, nullable=False),
    sa.Column("vehicle_no", sa.Integer, nullable=False),
    # see `wayline_history.layouts`
    sa.Column("kind", sa.SmallInteger, nullable=False),
    sa.Column("data", sa.LargeBinary, nullable=False),
)

HOURS = sa.Table(
    "history_hour",
    METADATA,
    sa.Column("hour", sa.Integer, primary_key=True),
    # of all its chunks and events, about
    sa.Column("bytes", sa.BigInteger, nullable=False),
    # by the host's clock, when something of the hour came last
    sa.Column("written_s", sa.BigInteger, nullable=False),
    # 0 as it came, 1 one chunk a vehicle and kind, 2 thinned
    sa.Column("state", sa.SmallInteger, nullable=False),
)

EVENTS = sa.Table(
    "history_event",
    METADATA,
    sa.Column("vehicle_no", sa.Integer, primary_key=True),
    sa.Column("t_ns", sa.BigInteger, primary_key=True),
    sa.Column("kind", sa.Text, primary_key=True),
    sa.Column("name", sa.Text, primary_key=True),
    sa.Column("hour", sa.Integer, nullable=False),
    # JSON of what else is known
    sa.Column("data", sa.LargeBinary, nullable=False),
)

TRIPS = sa.Table(
    "history_trip",
    METADATA,
    sa.Column("trip_key", sa.Text, primary_key=True),
    sa.Column("vehicle_no", sa.Integer, nullable=False),
    sa.Column("started_ns", sa.BigInteger, nullable=False),
    sa.Column("ended_ns", sa.BigInteger, nullable=False),
    # else it went as far as `ended_ns` when something of it was kept last
    sa.Column("is_over", sa.Boolean, nullable=False),
    sa.Column("hour", sa.Integer, nullable=False),
    # the message, JSON
    sa.Column("data", sa.LargeBinary, nullable=False),
)

ALIVE = sa.Table(
    "history_alive",
    METADATA,
    sa.Column("only", sa.Integer, primary_key=True),
    # by the host's clock, when the history was last known to be kept
    sa.Column("t_ns", sa.BigInteger, nullable=False),
    # whether the cores had ended, so that nothing was on its way to be kept
    sa.Column("is_whole", sa.Boolean, nullable=False),
)
