"""Filters fixes and vehicle sensors into a pose that survives tunnels."""
