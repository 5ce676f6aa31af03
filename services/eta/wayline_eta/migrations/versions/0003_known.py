"""What all rows have taught so far; it is learned from them at the next start."""

import sqlalchemy as sa
from alembic import op

revision = "eta_0003"
down_revision = "eta_0002"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "eta_known",
        sa.Column("key", sa.Text, primary_key=True),
        sa.Column("weight", sa.Float, nullable=False),
        sa.Column("mean", sa.Float, nullable=False),
        sa.Column("square", sa.Float, nullable=False),
    )


def downgrade() -> None:
    """Remove it."""
    op.drop_table("eta_known")
