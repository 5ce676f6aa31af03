"""Altitude and slope along the road: one model, for fusion forward and for the map both ways."""
