"""What fusion keeps of each vehicle: its sensors' calibration and its last pose."""

import sqlalchemy as sa
from alembic import op

revision = "fusion_0001"
down_revision = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "fusion_vehicle",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("t_ns", sa.BigInteger, nullable=False),
        sa.Column("gyro_bias_degps", sa.Float, nullable=False),
        sa.Column("gyro_bias_std_degps", sa.Float, nullable=False),
        sa.Column("gyro_scale", sa.Float, nullable=False),
        sa.Column("gyro_scale_std", sa.Float, nullable=False),
        sa.Column("odometer_scale", sa.Float, nullable=False),
        sa.Column("odometer_scale_std", sa.Float, nullable=False),
        sa.Column("gps_latency_s", sa.Float, nullable=False),
        sa.Column("gps_latency_std_s", sa.Float, nullable=False),
        sa.Column("correlations", sa.Text, nullable=False),
        sa.Column("gyro_temperature_c", sa.Float),
        sa.Column("position_noise_factor", sa.Float, nullable=False),
        sa.Column("velocity_noise_factor", sa.Float, nullable=False),
        sa.Column("bias_wander_factor", sa.Float, nullable=False),
        sa.Column("lat_deg", sa.Float),
        sa.Column("lon_deg", sa.Float),
        sa.Column("east_std_m", sa.Float),
        sa.Column("north_std_m", sa.Float),
        sa.Column("heading_deg", sa.Float),
        sa.Column("heading_std_deg", sa.Float),
        sa.Column("speed_mps", sa.Float),
        sa.Column("fix_ns", sa.BigInteger),
    )


def downgrade() -> None:
    """Remove the table."""
    op.drop_table("fusion_vehicle")
