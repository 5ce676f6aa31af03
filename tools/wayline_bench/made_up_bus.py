"""A 500 kbit/s bus at full load, made up: one frame in ten is asked for, or every one."""

from collections.abc import Iterator

import can

RATE_HZ = 4000
"""Frames of 8 bytes and 11-bit identifiers that fill 500 kbit/s, stuff bits included."""
MAPPED_IDS = (0x100, 0x101, 0x102, 0x103)
OTHER_IDS = tuple(range(0x200, 0x224))
NUMBERED_ID = 0x103
"""The identifier whose signal counts the frames, so that a message tells which one it came of."""
DBC = """VERSION ""
BU_: ECU
BO_ 256 Wheels: 8 ECU
 SG_ FL : 7|16@0+ (0.01,0) [0|655] "km/h" ECU
 SG_ FR : 23|16@0+ (0.01,0) [0|655] "km/h" ECU
 SG_ RL : 39|16@0+ (0.01,0) [0|655] "km/h" ECU
 SG_ RR : 55|16@0+ (0.01,0) [0|655] "km/h" ECU
BO_ 257 Rates: 8 ECU
 SG_ Yaw : 0|16@1- (0.01,0) [-327|327] "deg/s" ECU
 SG_ Valid : 63|1@1+ (1,0) [0|1] "" ECU
BO_ 258 Engine: 8 ECU
 SG_ Speed : 24|16@1+ (0.125,0) [0|8031] "rpm" ECU
 SG_ Torque : 8|16@1- (0.1,0) [-3276|3276] "Nm" ECU
BO_ 259 Distance: 8 ECU
 SG_ Count : 0|32@1+ (1,0) [0|0] "m" ECU
"""
MAPPING = """
[can.signals]
"odometer.speed_mps" = { message = "Wheels", signal = ["RL", "RR"], scale = 0.2777777777777778 }
"odometer.distance_m" = { message = "Distance", signal = "Count" }
"gyro.yaw_rate_degps" = { message = "Rates", signal = "Yaw", valid = { signal = "Valid", min = 1 } }
"torque.engine_torque_nm" = { message = "Engine", signal = "Torque" }
"torque.engine_speed_rpm" = { message = "Engine", signal = "Speed" }
"""
DATA = bytes.fromhex("0fa00fa10fa20f80")


def identifiers(*, only_mapped: bool) -> Iterator[int]:
    """Whose frames follow each other, for ever: every one equally often."""
    cycle = MAPPED_IDS if only_mapped else (*MAPPED_IDS, *OTHER_IDS)
    while True:
        yield from cycle


def frame(identifier: int, number: int) -> can.Message:
    """A frame; the numbered one tells its number."""
    data = number.to_bytes(8, "little") if identifier == NUMBERED_ID else DATA
    return can.Message(arbitration_id=identifier, is_extended_id=False, data=data)
