"""Turns CAN frames into odometer, gyro, torque, barometer and gps_fix messages."""
