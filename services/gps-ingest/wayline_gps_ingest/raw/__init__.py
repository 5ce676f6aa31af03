"""Turns what receivers measured of each satellite into one gps_raw an epoch."""
