"""Pure: the tables of the eta database: what vehicles took, how forecasts came and were."""

import sqlalchemy as sa

METADATA = sa.MetaData()

TAKEN = sa.Table(
    "eta_taken",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    # Unix time of the arrival at the stop
    sa.Column("t_ns", sa.BigInteger, primary_key=True),
    # key of the leg to the stop; null where only the dwell was seen
    sa.Column("leg", sa.Text),
    sa.Column("plan", sa.Text, nullable=False),
    sa.Column("planned_s", sa.Float, nullable=False),
    sa.Column("travel_s", sa.Float, nullable=False),
    sa.Column("stop", sa.Text, nullable=False),
    sa.Column("dwell_s", sa.Float, nullable=False),
    # a breakdown, which teaches nothing; null at most
    sa.Column("disruption", sa.Text),
    sa.Index("eta_taken_t_ns", "t_ns"),
)

KNOWN = sa.Table(
    "eta_known",
    METADATA,
    # of a quantity that is learned, see `experience.teachings`
    sa.Column("key", sa.Text, primary_key=True),
    # of its `Forgetful`
    sa.Column("weight", sa.Float, nullable=False),
    sa.Column("mean", sa.Float, nullable=False),
    sa.Column("square", sa.Float, nullable=False),
)

CAME = sa.Table(
    "eta_came",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    # Unix time at which it was forecast
    sa.Column("made_ns", sa.BigInteger, primary_key=True),
    sa.Column("stop", sa.Text, primary_key=True),
    sa.Column("plan", sa.Text, nullable=False),
    # which span of minutes ahead, and by how many half widths of its range it was late
    sa.Column("span", sa.Integer, nullable=False),
    sa.Column("off", sa.Float, nullable=False),
    sa.Index("eta_came_made_ns", "made_ns"),
)

SCORED_DAYS = sa.Table(
    "eta_scored_days",
    METADATA,
    sa.Column("route_id", sa.Text, primary_key=True),
    # since 1970, UTC
    sa.Column("day", sa.Integer, primary_key=True),
    # `scores.Sums` as JSON
    sa.Column("sums", sa.LargeBinary, nullable=False),
)

SCORED_MINUTES = sa.Table(
    "eta_scored_minutes",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    sa.Column("t_ns", sa.BigInteger, primary_key=True),
    sa.Column("route_id", sa.Text, primary_key=True),
    sa.Index("eta_scored_minutes_t_ns", "t_ns"),
)
"""What the days' sums hold already, so that a drive that is replayed twice counts once."""
