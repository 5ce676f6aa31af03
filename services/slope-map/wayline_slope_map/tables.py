"""Pure: the tables of the slope database.

A sum is a whole number (see `sums.py` for the scales), so that runs may be merged in any order
and give the same row to the last digit. The size grows with the metres of road, not with the runs;
only the ledger does, one row a run with the run itself (`kept_run.py`). Of what was left out the
newest is kept, so many parts a vehicle.
"""

import sqlalchemy as sa

METADATA = sa.MetaData()

ROADS = sa.Table(
    "slope_road",
    METADATA,
    sa.Column("road_id", sa.Text, primary_key=True),
    sa.Column("bin_m", sa.Float, nullable=False),
    sa.Column("loop", sa.Boolean, nullable=False),
    sa.Column("is_route", sa.Boolean, nullable=False),
    # JSON list of [latitude, longitude] in degrees
    sa.Column("line", sa.Text, nullable=False),
)

SUMS = sa.Table(
    "slope_bin_sum",
    METADATA,
    sa.Column("road_id", sa.Text, sa.ForeignKey("slope_road.road_id"), primary_key=True),
    # 1 along the stored line, -1 against it
    sa.Column("direction", sa.SmallInteger, primary_key=True),
    # bin i holds the distances from i to i + 1 times `bin_m`
    sa.Column("bin_index", sa.Integer, primary_key=True),
    sa.Column("sensor", sa.Text, primary_key=True),
    sa.Column("runs", sa.BigInteger, nullable=False),
    sa.Column("grade_weight", sa.BigInteger, nullable=False),
    sa.Column("grade_sum", sa.BigInteger, nullable=False),
    sa.Column("grade_square_sum", sa.BigInteger, nullable=False),
    sa.Column("alt_weight", sa.BigInteger, nullable=False),
    sa.Column("alt_sum", sa.BigInteger, nullable=False),
    sa.Column("updated_ns", sa.BigInteger, nullable=False),
)

LEDGER = sa.Table(
    "slope_ledger",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    sa.Column("road_id", sa.Text, sa.ForeignKey("slope_road.road_id"), primary_key=True),
    sa.Column("direction", sa.SmallInteger, primary_key=True),
    sa.Column("start_ns", sa.BigInteger, primary_key=True),
    sa.Column("end_ns", sa.BigInteger, nullable=False),
    # the run's bins (`kept_run.py`); null of runs that were merged before runs were kept
    sa.Column("kept", sa.LargeBinary),
    sa.Column("withdrawn", sa.Boolean, nullable=False, server_default=sa.false()),
)

LEFT_OUT = sa.Table(
    "slope_left_out",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    sa.Column("start_ns", sa.BigInteger, primary_key=True),
    # empty where the whole part is left out
    sa.Column("sensor", sa.Text, primary_key=True),
    sa.Column("reason", sa.Text, primary_key=True),
    sa.Column("end_ns", sa.BigInteger, nullable=False),
    sa.Column("length_m", sa.Float, nullable=False),
    # null where no place was known near by
    sa.Column("start_lat_deg", sa.Float),
    sa.Column("start_lon_deg", sa.Float),
    sa.Column("end_lat_deg", sa.Float),
    sa.Column("end_lon_deg", sa.Float),
)
