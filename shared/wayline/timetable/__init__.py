"""Timetables as agencies publish them: GTFS feeds, read whole, mended, and kept."""
