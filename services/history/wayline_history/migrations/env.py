"""Alembic's entry: everything is done by the shared database layer."""

from wayline.database import run_migrations

run_migrations()
