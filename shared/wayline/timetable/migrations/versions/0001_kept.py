"""Timetables as they were read, by the hash of their feed."""

import sqlalchemy as sa
from alembic import op

revision = "timetable_0001"
down_revision = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "timetable_kept",
        sa.Column("fingerprint", sa.Text, primary_key=True),
        sa.Column("content", sa.LargeBinary, nullable=False),
    )


def downgrade() -> None:
    """Take it away."""
    op.drop_table("timetable_kept")
