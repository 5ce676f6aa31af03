"""What of each vehicle's drives was left out of the map, and why."""

import sqlalchemy as sa
from alembic import op

revision = "slope_0003"
down_revision = "slope_0002"


def upgrade() -> None:
    """Make the table; of drives of before nothing is known."""
    op.create_table(
        "slope_left_out",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("start_ns", sa.BigInteger, primary_key=True),
        sa.Column("sensor", sa.Text, primary_key=True),
        sa.Column("reason", sa.Text, primary_key=True),
        sa.Column("end_ns", sa.BigInteger, nullable=False),
        sa.Column("length_m", sa.Float, nullable=False),
        sa.Column("start_lat_deg", sa.Float),
        sa.Column("start_lon_deg", sa.Float),
        sa.Column("end_lat_deg", sa.Float),
        sa.Column("end_lon_deg", sa.Float),
    )


def downgrade() -> None:
    """Remove the table."""
    op.drop_table("slope_left_out")
