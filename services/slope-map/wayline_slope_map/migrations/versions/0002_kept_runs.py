"""The runs themselves beside the sums, and which were withdrawn; runs of before have none."""

import sqlalchemy as sa
from alembic import op

revision = "slope_0002"
down_revision = "slope_0001"


def upgrade() -> None:
    """Add the columns."""
    op.add_column("slope_ledger", sa.Column("kept", sa.LargeBinary))
    op.add_column(
        "slope_ledger",
        sa.Column("withdrawn", sa.Boolean, nullable=False, server_default=sa.false()),
    )


def downgrade() -> None:
    """Remove the columns."""
    with op.batch_alter_table("slope_ledger") as table:
        table.drop_column("kept")
        table.drop_column("withdrawn")
