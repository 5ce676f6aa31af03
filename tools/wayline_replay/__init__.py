"""Runs drives through the cores of all services in one process."""
