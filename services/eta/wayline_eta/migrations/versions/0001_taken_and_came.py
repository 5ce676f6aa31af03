"""What vehicles took for legs and at stops, and how forecasts came."""

import sqlalchemy as sa
from alembic import op

revision = "eta_0001"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "eta_taken",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("t_ns", sa.BigInteger, primary_key=True),
        sa.Column("leg", sa.Text),
        sa.Column("plan", sa.Text, nullable=False),
        sa.Column("planned_s", sa.Float, nullable=False),
        sa.Column("travel_s", sa.Float, nullable=False),
        sa.Column("stop", sa.Text, nullable=False),
        sa.Column("dwell_s", sa.Float, nullable=False),
    )
    op.create_index("eta_taken_t_ns", "eta_taken", ["t_ns"])
    op.create_table(
        "eta_came",
        sa.Column("vehicle_id", sa.Text, primary_key=True),
        sa.Column("made_ns", sa.BigInteger, primary_key=True),
        sa.Column("stop", sa.Text, primary_key=True),
        sa.Column("plan", sa.Text, nullable=False),
        sa.Column("span", sa.Integer, nullable=False),
        sa.Column("off", sa.Float, nullable=False),
    )
    op.create_index("eta_came_made_ns", "eta_came", ["made_ns"])


def downgrade() -> None:
    """Remove them."""
    op.drop_table("eta_came")
    op.drop_table("eta_taken")
