"""What fusion keeps of each vehicle's altitude, slope and barometer."""

import sqlalchemy as sa
from alembic import op

revision = "fusion_0002"
down_revision = "fusion_0001"

COLUMNS = (
    "alt_m",
    "alt_std_m",
    "grade_pct",
    "grade_std_pct",
    "baro_bias_m",
    "baro_bias_std_m",
    "alt_bias_correlation",
)


def upgrade() -> None:
    """Add the columns, null for what was kept before."""
    for name in COLUMNS:
        op.add_column("fusion_vehicle", sa.Column(name, sa.Float))


def downgrade() -> None:
    """Remove the columns."""
    for name in COLUMNS:
        op.drop_column("fusion_vehicle", name)
