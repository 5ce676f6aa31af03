"""Turns what positioning receivers say into one gps_fix an epoch."""
