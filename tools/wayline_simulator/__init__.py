"""Drives with known truth: roads, drivers, vehicles and their sensors, made up from a seed."""
