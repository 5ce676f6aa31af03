"""Roads, the sums of their bins, and the ledger of runs."""

import sqlalchemy as sa
from alembic import op

revision = "slope_0001"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "slope_road",
        sa.Column("road_id", sa.Text, primary_key=True),
        sa.Column("bin_m", sa.Float, nullable=False),
        sa.Column("loop", sa.Boolean, nullable=False),
        sa.Column("is_route", sa.Boolean, nullable=False),
        sa.Column("line", sa.Text, nullable=False),
    )
    op.create_table(
        "slope_bin_sum",
        sa.Column("road_id", sa.Text, sa.ForeignKey("slope_road.road_id"), primary_key=True),
        sa.Column("direction", sa.SmallInteger, primary_key=True),
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
    op.create_table(
        "slope_ledger",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("road_id", sa.Text, sa.ForeignKey("slope_road.road_id"), primary_key=True),
        sa.Column("direction", sa.SmallInteger, primary_key=True),
        sa.Column("start_ns", sa.BigInteger, primary_key=True),
        sa.Column("end_ns", sa.BigInteger, nullable=False),
    )
    op.create_index("slope_ledger_time", "slope_ledger", ["vehicle_id", "start_ns"])


def downgrade() -> None:
    """Remove the tables."""
    for table in ("slope_ledger", "slope_bin_sum", "slope_road"):
        op.drop_table(table)
