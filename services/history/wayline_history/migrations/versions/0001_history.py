"""Chunks by hour, vehicle and kind; events, trips, and how far the history was kept."""

import sqlalchemy as sa
from alembic import op

revision = "history_0001"
down_revision = None

PARTITIONED = """
CREATE TABLE history_chunk (
    chunk_no BIGINT GENERATED ALWAYS AS IDENTITY,
    hour INTEGER NOT NULL,
    vehicle_no INTEGER NOT NULL,
    kind SMALLINT NOT NULL,
    data BYTEA NOT NULL,
    PRIMARY KEY (hour, chunk_no)
) PARTITION BY RANGE (hour)
"""


def upgrade() -> None:
    """Make the tables; a day's partition is made with its first row."""
    op.create_table(
        "history_vehicle",
        sa.Column("vehicle_no", sa.Integer, primary_key=True),
        sa.Column("vehicle_id", sa.Text, nullable=False, unique=True),
    )
    if op.get_bind().dialect.name == "postgresql":
        op.execute(PARTITIONED)
    else:
        op.create_table(
            "history_chunk",
            sa.Column("chunk_no", sa.Integer, primary_key=True),
            sa.Column("hour", sa.Integer, nullable=False),
            sa.Column("vehicle_no", sa.Integer, nullable=False),
            sa.Column("kind", sa.SmallInteger, nullable=False),
            sa.Column("data", sa.LargeBinary, nullable=False),
        )
    op.create_index("history_chunk_place", "history_chunk", ["vehicle_no", "kind", "hour"])
    op.create_table(
        "history_hour",
        sa.Column("hour", sa.Integer, primary_key=True, autoincrement=False),
        sa.Column("bytes", sa.BigInteger, nullable=False),
        sa.Column("written_s", sa.BigInteger, nullable=False),
        sa.Column("state", sa.SmallInteger, nullable=False),
    )
    op.create_table(
        "history_event",
        sa.Column("vehicle_no", sa.Integer, primary_key=True),
        sa.Column("t_ns", sa.BigInteger, primary_key=True),
        sa.Column("kind", sa.Text, primary_key=True),
        sa.Column("name", sa.Text, primary_key=True),
        sa.Column("hour", sa.Integer, nullable=False),
        sa.Column("data", sa.LargeBinary, nullable=False),
    )
    op.create_index("history_event_hour", "history_event", ["hour"])
    op.create_table(
        "history_trip",
        sa.Column("trip_key", sa.Text, primary_key=True),
        sa.Column("vehicle_no", sa.Integer, nullable=False),
        sa.Column("started_ns", sa.BigInteger, nullable=False),
        sa.Column("ended_ns", sa.BigInteger, nullable=False),
        sa.Column("is_over", sa.Boolean, nullable=False),
        sa.Column("hour", sa.Integer, nullable=False),
        sa.Column("data", sa.LargeBinary, nullable=False),
    )
    op.create_index("history_trip_start", "history_trip", ["vehicle_no", "started_ns"])
    op.create_index("history_trip_hour", "history_trip", ["hour"])
    op.create_table(
        "history_alive",
        sa.Column("only", sa.Integer, primary_key=True, autoincrement=False),
        sa.Column("t_ns", sa.BigInteger, nullable=False),
        sa.Column("is_whole", sa.Boolean, nullable=False),
    )


def downgrade() -> None:
    """Remove the tables."""
    for table in ("alive", "trip", "event", "hour", "chunk", "vehicle"):
        op.drop_table(f"history_{table}")
