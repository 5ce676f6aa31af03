"""Builds a road-grade database from runs and looks ahead."""
