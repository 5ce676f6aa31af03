"""How noisy each vehicle's sensors of the height were found to be."""

import sqlalchemy as sa
from alembic import op

revision = "fusion_0004"
down_revision = "fusion_0003"

COLUMNS = ("pressure_noise_factor", "torque_noise_factor", "vehicle_slope_noise_factor")


def upgrade() -> None:
    """Add the columns; of what was kept before the noise is what was claimed."""
    for name in COLUMNS:
        column = sa.Column(name, sa.Float, nullable=False, server_default="1.0")
        op.add_column("fusion_vehicle", column)


def downgrade() -> None:
    """Remove the columns."""
    for name in COLUMNS:
        op.drop_column("fusion_vehicle", name)
