"""What fusion keeps of each vehicle's mass."""

import sqlalchemy as sa
from alembic import op

revision = "fusion_0003"
down_revision = "fusion_0002"

COLUMNS = ("inverse_mass", "inverse_mass_std")


def upgrade() -> None:
    """Add the columns, null for what was kept before."""
    for name in COLUMNS:
        op.add_column("fusion_vehicle", sa.Column(name, sa.Float))


def downgrade() -> None:
    """Remove the columns."""
    for name in COLUMNS:
        op.drop_column("fusion_vehicle", name)
