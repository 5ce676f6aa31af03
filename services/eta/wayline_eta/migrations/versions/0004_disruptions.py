"""Which rows of what was taken are of a disruption, so that they teach nothing."""

import sqlalchemy as sa
from alembic import op

revision = "eta_0004"
down_revision = "eta_0003"


def upgrade() -> None:
    """Add the column; of earlier rows none is marked."""
    with op.batch_alter_table("eta_taken") as table:
        table.add_column(sa.Column("disruption", sa.Text))


def downgrade() -> None:
    """Remove it."""
    with op.batch_alter_table("eta_taken") as table:
        table.drop_column("disruption")
