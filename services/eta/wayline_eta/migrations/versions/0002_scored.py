"""How good predictions were, by route and day, and which minutes of vehicles that holds."""

import sqlalchemy as sa
from alembic import op

revision = "eta_0002"
down_revision = "eta_0001"


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "eta_scored_days",
        sa.Column("route_id", sa.Text, primary_key=True),
        sa.Column("day", sa.Integer, primary_key=True),
        sa.Column("sums", sa.LargeBinary, nullable=False),
    )
    op.create_table(
        "eta_scored_minutes",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("t_ns", sa.BigInteger, primary_key=True),
        sa.Column("route_id", sa.Text, primary_key=True),
    )
    op.create_index("eta_scored_minutes_t_ns", "eta_scored_minutes", ["t_ns"])


def downgrade() -> None:
    """Remove them."""
    op.drop_table("eta_scored_minutes")
    op.drop_table("eta_scored_days")
