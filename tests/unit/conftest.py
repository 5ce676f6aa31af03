"""Fixtures of every unit test: a service at work in a thread."""

from loops import run, session

__all__ = ["run", "session"]
