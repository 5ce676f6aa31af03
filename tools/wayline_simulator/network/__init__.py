"""A small network: two lines that share a trunk, their timetable, and buses that run it."""
