"""Which signals of a database are proposed for which quantity."""

import cantools
import pytest
from cantools.database.can import Database

from wayline.inputs import Frame
from wayline_can_ingest.diagnosis.proposal import Proposal, messages_by_name, propose
from wayline_can_ingest.diagnosis.seen import is_matched_by_pgn, seen_in

HEAD = 'VERSION ""\nBU_: ECU\n'
WHEELS = """BO_ 170 WHEELS: 8 ECU
 SG_ SPEED_FL : 0|16@1+ (0.01,0) [0|250] "km/h" ECU
 SG_ SPEED_FR : 16|16@1+ (0.01,0) [0|250] "km/h" ECU
 SG_ SPEED_RL : 32|16@1+ (0.01,0) [0|250] "km/h" ECU
 SG_ SPEED_RR : 48|16@1+ (0.01,0) [0|250] "km/h" ECU
"""
ENGINE = """BO_ 256 ENGINE: 8 ECU
 SG_ EngineSpeed : 0|16@1+ (0.25,0) [0|8000] "rpm" ECU
 SG_ EngineSpeedTarget : 16|16@1+ (0.25,0) [0|8000] "rpm" ECU
 SG_ ActualEngineTorque : 32|8@1+ (1,-125) [-125|130] "%" ECU
"""
REFERENCE = """BO_ 257 SETUP: 8 ECU
 SG_ EngineRefTorque : 0|16@1+ (1,0) [0|8000] "Nm" ECU
"""
INERTIAL = """BO_ 300 IMU: 8 ECU
 SG_ ImuValid : 0|1@1+ (1,0) [0|1] "" ECU
 SG_ YawRate : 8|16@1- (0.01,0) [-320|320] "rad/s" ECU
"""


def proposed(dbc: str, frames: list[Frame] | None = None) -> dict[str, Proposal]:
    """Proposals by quantity; with frames of what they show."""
    database = cantools.database.load_string(HEAD + dbc, strict=False)
    assert isinstance(database, Database)
    messages = messages_by_name([database])
    j1939 = is_matched_by_pgn(messages.values(), frames or [])
    seen = None if frames is None else seen_in(messages.values(), frames, j1939=j1939)
    return {each.quantity: each for each in propose(messages, seen)}


def frame(identifier: int, data: bytes) -> Frame:
    return Frame(0, "can0", identifier, identifier > 0x7FF, data)


def test_units_give_the_scale() -> None:
    """Rates are proposed as turning right, with the bit that says when they hold."""
    yaw = proposed(INERTIAL)["gyro.yaw_rate_degps"]
    assert yaw.scale == pytest.approx(-57.29577951308232, abs=1e-12)
    assert yaw.valid == "ImuValid"
    assert "right turn" in yaw.comment


def test_a_unit_of_something_else_is_no_candidate() -> None:
    """A yaw rate in percent is none."""
    assert "gyro.yaw_rate_degps" not in proposed(INERTIAL.replace("rad/s", "%"))


def test_both_wheels_of_the_rear_axle_are_read() -> None:
    """Their mean is the vehicle's middle."""
    named = WHEELS.replace("SPEED_", "WHEEL_SPEED_")
    assert proposed(named)["odometer.speed_mps"].signals == ("WHEEL_SPEED_RL", "WHEEL_SPEED_RR")


def test_torque_in_percent_waits_for_its_reference() -> None:
    """The line is behind a # until a person says what 100 % is, or the bus does."""
    asleep = proposed(ENGINE)["torque.engine_torque_pct"]
    assert asleep.line.startswith('# "torque.engine_torque_pct"')
    awake = proposed(ENGINE + REFERENCE)
    assert not awake["torque.engine_torque_pct"].is_asleep
    assert awake["vehicle.engine_reference_torque_nm"].signals == ("EngineRefTorque",)


def test_a_target_is_not_what_is() -> None:
    """Only the engine's speed of now is proposed."""
    engine = proposed(ENGINE)["torque.engine_speed_rpm"]
    assert engine.signals == ("EngineSpeed",)
    assert engine.comment == ""


def test_only_what_is_heard_is_proposed() -> None:
    """A message that never comes is no place of anything."""
    found = proposed(ENGINE + INERTIAL, [frame(256, bytes(8))])
    assert {"torque.engine_speed_rpm"} == found.keys() - {"torque.engine_torque_pct"}


def test_values_that_no_vehicle_has_speak_against_a_signal() -> None:
    """A yaw rate of 320 rad/s is some other signal."""
    assert not proposed(INERTIAL, [frame(300, b"\x01\xff\x7f" + bytes(5))])


def test_values_that_are_said_to_be_invalid_do_not() -> None:
    """The same frame with the valid bit unset beside a good one."""
    invalid = frame(300, b"\x00\xff\x7f" + bytes(5))
    found = proposed(INERTIAL, [invalid, frame(300, b"\x01" + bytes(7))])
    assert "gyro.yaw_rate_degps" in found


def test_of_two_signals_the_one_that_changes_goes_first() -> None:
    """The other one is named beside it."""
    two = "".join(
        f'BO_ {number} {name}: 2 ECU\n SG_ VehicleSpeed : 0|16@1+ (0.01,0) [0|250] "km/h" ECU\n'
        for number, name in ((400, "DEAD"), (401, "ALIVE"))
    )
    frames = [frame(400, bytes(2)), frame(401, bytes(2)), frame(401, b"\x10\x10")]
    speed = proposed(two, frames)["odometer.speed_mps"]
    assert (speed.message, speed.comment) == ("ALIVE", "or DEAD.VehicleSpeed")


def test_the_speed_of_a_positioning_box_is_no_odometer() -> None:
    """It is the fix's, where the box tells a place as well."""
    gnss = """BO_ 3 gnss_speed: 4 ECU
 SG_ Speed : 0|20@1+ (0.001,0) [0|1000] "m/s" ECU
"""
    place = """BO_ 4 gnss_pos: 8 ECU
 SG_ Latitude : 0|32@1- (0.000001,0) [-90|90] "deg" ECU
 SG_ Longitude : 32|32@1- (0.000001,0) [-180|180] "deg" ECU
"""
    assert not proposed(gnss)
    assert proposed(gnss + place).keys() == {
        "gps_fix.speed_mps", "gps_fix.lat_deg", "gps_fix.lon_deg",
    }  # fmt: skip


def test_an_odometer_in_whole_kilometres_is_of_no_use() -> None:
    """Its steps are longer than what it is to measure."""
    odometer = 'BO_ 9 DASH: 4 ECU\n SG_ Odometer : 0|32@1+ ({},0) [0|1] "km" ECU\n'
    assert not proposed(odometer.format(1))
    assert proposed(odometer.format(0.005))["odometer.distance_m"].scale == 1000.0


def test_a_switch_of_two_bits_is_on_at_1() -> None:
    """2 is an error and 3 not available (J1939-71)."""
    brake = 'BO_ 9 EBC1: 4 ECU\n SG_ BrakePedalSwitch : 6|{}@1+ (1,0) [0|3] "" ECU\n'
    assert proposed(brake.format(2))["torque.brake"].equals == 1
    assert proposed(brake.format(1))["torque.brake"].equals is None
    assert not proposed(brake.format(8))


def test_a_gear_lever_tells_reverse() -> None:
    """By the database's word for its raw value."""
    lever = """BO_ 9 BOX: 1 ECU
 SG_ GEAR : 0|6@1+ (1,0) [0|63] "" ECU
VAL_ 9 GEAR 0 "D" 8 "N" 16 "R" 32 "P";
"""
    assert proposed(lever)["odometer.reverse"].equals == 16


def test_a_message_without_signals_says_nothing() -> None:
    """Databases of networks have such; that it comes does not make the database this bus's."""
    database = cantools.database.load_string(HEAD + "BO_ 9 EMPTY: 8 ECU\n")
    assert isinstance(database, Database)
    assert not seen_in(database.messages, [frame(9, bytes(8))], j1939=False).messages


def test_j1939_databases_are_known_by_their_groups() -> None:
    """The database's source address is nobody's; values that say "not available" are no range."""
    truck = """BO_ 2364540158 EEC1: 8 ECU
 SG_ EngineSpeed : 24|16@1+ (0.125,0) [0|8031.875] "rpm" ECU
"""
    running, absent = (
        frame(0x0CF00400, bytes(3) + each + bytes(3)) for each in (b"\0\1", b"\xff" * 2)
    )
    assert "torque.engine_speed_rpm" in proposed(truck, [running, absent])
    assert not proposed(truck, [absent])
