"""The mapping rules of SPEC section 3, each on frames of a small database written here."""

from pathlib import Path
from typing import Any

import cantools
import pytest
from cantools.database.can import Database

from builders import about, at, frame, only
from wayline.drive import CanSource, Clock, Condition, Drive, DriveInfo, SignalMapping, Vehicle
from wayline.errors import InputError
from wayline.inputs import Flush, Frame, Tick
from wayline.messages import Barometer, GpsFix, Gyro, Message, Odometer, Torque
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_database
from wayline_can_ingest.j1939 import not_available, pgn_of
from wayline_can_ingest.mapping import compile_mapping
from wayline_can_ingest.recorded import recordings

DBC = """
VERSION ""
BU_: ECU
BO_ 256 Wheels: 4 ECU
 SG_ Left : 0|16@1+ (0.01,0) [0|655] "km/h" ECU
 SG_ Right : 16|16@1+ (0.01,0) [0|655] "km/h" ECU
BO_ 257 Imu: 3 ECU
 SG_ Rate : 0|16@1- (0.01,0) [-300|300] "deg/s" ECU
 SG_ Valid : 16|1@1+ (1,0) [0|1] "" ECU
BO_ 258 Counter: 2 ECU
 SG_ Metres : 0|16@1+ (0.1,0) [0|6553.5] "m" ECU
BO_ 259 Obd: 4 ECU
 SG_ Pid M : 0|8@1+ (1,0) [0|255] "" ECU
 SG_ Speed m13 : 8|8@1+ (1,0) [0|255] "km/h" ECU
 SG_ Pressure m51 : 8|8@1+ (1,0) [0|255] "kPa" ECU
BO_ 260 Lat: 5 ECU
 SG_ Latitude : 0|32@1- (1e-07,0) [-90|90] "deg" ECU
 SG_ FixOk : 32|1@1+ (1,0) [0|1] "" ECU
BO_ 261 Lon: 5 ECU
 SG_ Longitude : 0|32@1- (1e-07,0) [-180|180] "deg" ECU
 SG_ Kind : 32|3@1+ (1,0) [0|7] "" ECU
BO_ 262 Engine: 4 ECU
 SG_ TorquePct : 0|8@1+ (1,-125) [-125|130] "%" ECU
 SG_ Reference : 8|16@1+ (1,0) [0|65535] "Nm" ECU
 SG_ Brake : 24|2@1+ (1,0) [0|3] "" ECU
BO_ 263 Clock: 8 ECU
 SG_ Utc : 0|64@1+ (0.001,0) [0|1e12] "s" ECU
BO_ 2566844926 Ccvs: 8 ECU
 SG_ WheelSpeed : 8|16@1+ (0.00390625,0) [0|251] "km/h" ECU
"""
KMH = 1.0 / 3.6


@pytest.fixture(scope="module")
def database() -> Database:
    loaded = cantools.database.load_string(DBC, strict=False)
    assert isinstance(loaded, Database)
    return loaded


def ingest(
    database: Database, *inputs: Any, vehicle: Vehicle | None = None, **signals: Any
) -> list[Message]:
    """Messages of a core that maps `topic__field=...`."""
    named = {name.replace("__", "."): mapping for name, mapping in signals.items()}
    return feed(core_of(database, CanSource(path="x.log", signals=named), vehicle), *inputs)


def core_of(database: Database, source: CanSource, vehicle: Vehicle | None = None) -> CanIngestCore:
    vehicle = vehicle or Vehicle()
    mapping = compile_mapping(source, [database], vehicle, "drive.toml")
    return CanIngestCore(source, mapping, vehicle)


def feed(core: CanIngestCore, *inputs: Any) -> list[Message]:
    return [message for each in inputs for message in core.handle(each, "can-ingest")]


def test_scale_and_offset_apply_after_the_databases_own(database: Database) -> None:
    mapping = SignalMapping(message="Wheels", signal="Left", scale=KMH, offset=1.0)
    (message,) = ingest(database, frame(0, 256, "1027 0000"), odometer__speed_mps=mapping)
    assert message == Odometer(t_ns=at(0), speed_mps=about(100.0 * KMH + 1.0))


def test_several_signals_are_their_mean(database: Database) -> None:
    mapping = SignalMapping(message="Wheels", signal=("Left", "Right"), scale=KMH)
    (message,) = ingest(database, frame(0, 256, "1027 204E"), odometer__speed_mps=mapping)
    assert message == Odometer(t_ns=at(0), speed_mps=about(150.0 * KMH))


def test_an_invalid_sample_is_null(database: Database) -> None:
    mapping = SignalMapping(message="Imu", signal="Rate", valid=Condition(signal="Valid", equals=1))
    good, bad = frame(0, 257, "640001"), frame(0.1, 257, "640000")
    messages = ingest(database, good, bad, gyro__yaw_rate_degps=mapping)
    assert messages == [Gyro(t_ns=at(0), yaw_rate_degps=1.0), Gyro(t_ns=at(0.1))]


def test_every_condition_must_hold_also_one_in_another_frame(database: Database) -> None:
    mapping = SignalMapping(
        message="Imu",
        signal="Rate",
        valid=(
            Condition(signal="Valid", equals=1),
            Condition(message="Wheels", signal="Left", min=1.0, max=50.0),
        ),
    )
    rates = ingest(
        database,
        frame(0.0, 257, "640001"),  # no wheel speed seen yet
        frame(0.1, 256, "E803 0000"),  # 10 km/h
        frame(0.2, 257, "640001"),
        frame(0.3, 256, "1027 0000"),  # 100 km/h is above the maximum
        frame(0.4, 257, "640001"),
        gyro__yaw_rate_degps=mapping,
    )
    assert [gyro.yaw_rate_degps for gyro in only(rates, Gyro)] == [None, 1.0, None]


def test_a_frame_yields_only_the_signals_it_holds(database: Database) -> None:
    signals: dict[str, Any] = {
        "odometer__speed_mps": SignalMapping(message="Obd", signal="Speed", scale=KMH),
        "barometer__pressure_pa": SignalMapping(message="Obd", signal="Pressure", scale=1000.0),
    }
    named = {name.replace("__", "."): mapping for name, mapping in signals.items()}
    core = core_of(database, CanSource(path="x.log", signals=named))
    messages = feed(
        core,
        frame(0.0, 259, "0D240000"),  # speed
        frame(0.1, 259, "33640000"),  # pressure
        frame(0.2, 259, "7F010000"),  # a multiplexer value that is not listed
        frame(0.3, 259, "0D"),  # too short
        frame(0.4, 0x7E9, "0D240000"),  # not mapped
    )
    assert core.bad_input == 0
    assert messages == [
        Odometer(t_ns=at(0.0), speed_mps=about(10.0)),
        Barometer(t_ns=at(0.1), pressure_pa=100_000.0),
    ]


def test_signals_of_one_frame_for_one_topic_make_one_message(database: Database) -> None:
    messages = ingest(
        database,
        frame(0, 262, "C8 2C01 01"),
        vehicle=Vehicle(),
        torque__engine_torque_pct=SignalMapping(message="Engine", signal="TorquePct"),
        vehicle__engine_reference_torque_nm=SignalMapping(message="Engine", signal="Reference"),
        torque__brake=SignalMapping(message="Engine", signal="Brake", equals=1),
    )
    assert messages == [Torque(t_ns=at(0), engine_torque_nm=about(225.0), brake=True)]


def test_percent_torque_is_of_the_reference(database: Database) -> None:
    (message,) = ingest(
        database,
        frame(0, 262, "A5 0000 00"),
        vehicle=Vehicle(engine_reference_torque_nm=250.0),
        torque__engine_torque_pct=SignalMapping(message="Engine", signal="TorquePct"),
    )
    assert message == Torque(t_ns=at(0), engine_torque_nm=about(100.0))


def test_torque_that_is_in_newton_metres_is_not_multiplied_again(database: Database) -> None:
    """The mapping's own scale has reached our unit, whatever reference the vehicle has."""
    (message,) = ingest(
        database,
        frame(0, 262, "A5 0000 00"),
        vehicle=Vehicle(engine_reference_torque_nm=250.0),
        torque__engine_torque_nm=SignalMapping(message="Engine", signal="TorquePct", scale=2.5),
    )
    assert message == Torque(t_ns=at(0), engine_torque_nm=about(100.0))


def test_percent_torque_without_a_reference_is_refused(database: Database) -> None:
    with pytest.raises(InputError, match=r"engine_reference_torque_nm"):
        ingest(
            database,
            torque__engine_torque_pct=SignalMapping(message="Engine", signal="TorquePct"),
        )


def test_a_counter_is_unwrapped(database: Database) -> None:
    mapping = SignalMapping(message="Counter", signal="Metres")
    messages = ingest(
        database,
        frame(0, 258, "F0FF"),
        frame(1, 258, "0A00"),
        frame(2, 258, "6400"),
        odometer__distance_m=mapping,
    )
    distances = [message.distance_m for message in only(messages, Odometer)]
    assert distances == pytest.approx([6552.0, 6554.6, 6563.6])


def test_a_negative_wheel_speed_is_reverse(database: Database) -> None:
    mapping = SignalMapping(message="Imu", signal="Rate")
    (message,) = ingest(database, frame(0, 257, "9CFF00"), odometer__speed_mps=mapping)
    assert message == Odometer(t_ns=at(0), speed_mps=1.0, reverse=True)


@pytest.mark.parametrize(
    ("equals", "told"), [(None, [False, True, True]), (2.0, [False] * 2 + [True])]
)
def test_a_boolean_is_true_when_nonzero_or_what_it_shall_equal(
    database: Database, equals: float | None, told: list[bool]
) -> None:
    """The raw value decides."""
    mapping = SignalMapping(message="Engine", signal="Brake", equals=equals)
    frames = [frame(raw, 262, f"000000{raw:02X}") for raw in (0, 1, 2)]
    messages = ingest(database, *frames, torque__brake=mapping)
    assert [message.brake for message in only(messages, Torque)] == told


def test_words_are_given_for_raw_values(database: Database) -> None:
    """Before the database's scale and offset; a value without a word is null."""
    mapping = SignalMapping(
        message="Engine", signal="TorquePct", values={"0": "manual", "125": "gps"}
    )
    frames = [frame(n, 262, f"{raw:02X}000000") for n, raw in enumerate((0, 125, 126))]
    messages = ingest(database, *frames, Flush(at(9)), gps_fix__fix=mapping)
    assert [fix.fix for fix in only(messages, GpsFix)] == ["manual", "gps", "none"]


def test_latency_moves_a_quantity_back(database: Database) -> None:
    mapping = SignalMapping(message="Imu", signal="Rate", latency_s=0.25)
    (message,) = ingest(database, frame(1, 257, "640001"), gyro__yaw_rate_degps=mapping)
    assert message.t_ns == at(0.75)


FIX: dict[str, Any] = {
    "gps_fix__lat_deg": SignalMapping(
        message="Lat", signal="Latitude", valid=Condition(signal="FixOk", equals=1)
    ),
    "gps_fix__lon_deg": SignalMapping(message="Lon", signal="Longitude"),
    "gps_fix__fix": SignalMapping(
        message="Lon", signal="Kind", values={"0": "none", "1": "gps", "4": "rtk_fixed"}
    ),
}
LAT, LON = "00A3E111 01", "00A3E111 04"  # 30 degrees


def test_a_fix_spread_over_frames_is_one_message_stamped_with_the_first(database: Database) -> None:
    messages = ingest(
        database,
        frame(1.000, 260, LAT),
        frame(1.002, 261, LON),
        vehicle=Vehicle(gps_latency_s=0.5),
        **FIX,
    )
    assert messages == [
        GpsFix(t_ns=at(0.5), valid=True, lat_deg=30.0, lon_deg=30.0, mode=2, fix="rtk_fixed")
    ]


def test_a_fix_is_valid_only_with_a_valid_place(database: Database) -> None:
    """One of latitude and longitude being invalid, neither is told."""
    not_ok = LAT.replace(" 01", " 00")
    messages = ingest(database, frame(1.0, 260, not_ok), frame(1.01, 261, LON), **FIX)
    assert messages == [GpsFix(t_ns=at(1.0), valid=False, mode=1, fix="rtk_fixed")]


def test_frames_further_apart_than_50_ms_are_two_fixes(database: Database) -> None:
    core = core_of(
        database,
        CanSource(path="x.log", signals={k.replace("__", "."): v for k, v in FIX.items()}),
    )
    messages = feed(core, frame(1.0, 260, LAT), frame(1.2, 261, LON), Flush(at(2)))
    assert [(fix.t_ns, fix.valid) for fix in only(messages, GpsFix)] == [
        (at(1.0), False),
        (at(1.2), False),
    ]


def test_an_incomplete_fix_is_given_out_when_time_has_passed(database: Database) -> None:
    core = core_of(
        database,
        CanSource(path="x.log", signals={k.replace("__", "."): v for k, v in FIX.items()}),
    )
    assert feed(core, frame(1.0, 260, LAT), Tick(at(1.04))) == []
    assert len(feed(core, Tick(at(1.1)))) == 1


def test_a_clock_signal_moves_the_whole_source(database: Database) -> None:
    source = CanSource(
        path="x.log",
        signals={"gyro.yaw_rate_degps": SignalMapping(message="Imu", signal="Rate")},
        clock=Clock(message="Clock", signal="Utc"),
    )
    utc_ms = (at(100.0) // 1_000_000).to_bytes(8, "little").hex()
    core = core_of(database, source)
    messages = feed(core, frame(1, 257, "640001"), frame(2, 263, utc_ms), frame(3, 257, "640001"))
    assert [message.t_ns for message in messages] == [at(99.0), at(101.0)]


def test_a_clock_offset_moves_the_whole_source(database: Database) -> None:
    """A logger whose clock is known to be off needs no clock signal."""
    source = CanSource(
        path="x.log",
        signals={"gyro.yaw_rate_degps": SignalMapping(message="Imu", signal="Rate")},
        clock_offset_s=-4.5,
    )
    (message,) = feed(core_of(database, source), frame(10, 257, "640001"))
    assert message.t_ns == at(5.5)


def test_the_buses_of_a_drive_have_one_clock(tmp_path: Path) -> None:
    """The clock signal of one moves the others too, also frames before it has come."""
    (tmp_path / "a.dbc").write_text(DBC, encoding="ascii")
    utc_ms = (at(100.0) // 1_000_000).to_bytes(8, "little").hex().upper()
    logs = {"a.log": f"(2.000000) can0 107#{utc_ms}\n", "b.log": "(1.000000) can1 101#640001\n"}
    for name, text in logs.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    dbc = (str(tmp_path / "a.dbc"),)
    rate = {"gyro.yaw_rate_degps": SignalMapping(message="Imu", signal="Rate")}
    speed = {"odometer.speed_mps": SignalMapping(message="Wheels", signal="Left")}
    drive = Drive(
        drive=DriveInfo(vehicle_id="car"),
        can=(
            CanSource(path=str(tmp_path / "b.log"), dbc=dbc, signals=rate),
            CanSource(
                path=str(tmp_path / "a.log"),
                dbc=dbc,
                signals=speed,
                clock=Clock(message="Clock", signal="Utc"),
            ),
        ),
    )
    heard = [
        (recording.source, message)
        for recording in recordings(drive, "drive.toml")
        for _, message in recording.messages
    ]
    assert heard == [("can-ingest", Gyro(t_ns=at(99.0), yaw_rate_degps=1.0))]


def test_a_clock_that_steps_back_goes_on_and_is_counted(database: Database) -> None:
    source = CanSource(
        path="x.log",
        signals={"gyro.yaw_rate_degps": SignalMapping(message="Imu", signal="Rate")},
    )
    core = core_of(database, source)
    times = [10.0, 11.0, 1.0, 2.0, 12.5]
    messages = feed(core, *(frame(seconds, 257, "640001") for seconds in times))
    assert [message.t_ns for message in messages] == [at(s) for s in (10, 11, 11, 12, 12.5)]
    assert core.bad_input == 1


def test_j1939_matches_by_pgn_and_nulls_what_is_not_available(database: Database) -> None:
    source = CanSource(
        path="x.log",
        j1939=True,
        signals={
            "odometer.speed_mps": SignalMapping(message="Ccvs", signal="WheelSpeed", scale=KMH)
        },
    )
    core = core_of(database, source)
    messages = feed(
        core,
        frame(0, 0x0CFEF100, "FF 0024 FFFFFFFFFF"),  # 36 km/h, other priority and address
        frame(1, 0x18FEF147, "FF FFFF FFFFFFFFFF"),  # not available
        frame(2, 0x18FEF147, "FF 00FE FFFFFFFFFF"),  # error
        frame(3, 0x18FEF247, "FF 0024 FFFFFFFFFF"),  # another group
    )
    assert [message.speed_mps for message in only(messages, Odometer)] == [
        pytest.approx(10.0),
        None,
        None,
    ]


@pytest.mark.parametrize(
    ("identifier", "pgn"),
    [(0x0CF00400, 0xF004), (0x18FEF1FE, 0xFEF1), (0x18EAFF00, 0xEA00), (0x1CECFF47, 0xEC00)],
)
def test_pgn_leaves_out_priority_source_and_destination(identifier: int, pgn: int) -> None:
    assert pgn_of(identifier) == pgn


@pytest.mark.parametrize(
    ("raw", "bits", "missing"),
    [(0xFF, 8, True), (0xFE, 8, True), (0xFA, 8, False), (0xFEFF, 16, True), (0xFDFF, 16, False),
     (3, 2, True), (2, 2, True), (1, 2, False), (1, 1, False)],
)  # fmt: skip
def test_j1939_ranges(raw: int, bits: int, missing: bool) -> None:
    assert not_available(raw, bits) is missing


@pytest.mark.parametrize(
    ("quantity", "mapping", "hint"),
    [
        ("odometer.speed_mps", SignalMapping(message="Wheel", signal="Left"), "Wheels"),
        ("odometer.speed_mps", SignalMapping(message="Wheels", signal="Lefft"), "Left"),
        ("odometer.sped_mps", SignalMapping(message="Wheels", signal="Left"), "speed_mps"),
        ("pose.lat_deg", SignalMapping(message="Wheels", signal="Left"), "lat_deg"),
        (
            "gyro.yaw_rate_degps",
            SignalMapping(message="Imu", signal="Rate", valid=Condition(signal="Vald")),
            "Valid",
        ),
    ],
)
def test_a_wrong_name_is_one_line_with_a_suggestion(
    database: Database, quantity: str, mapping: SignalMapping, hint: str
) -> None:
    with pytest.raises(InputError) as caught:
        core_of(database, CanSource(path="x.log", signals={quantity: mapping}))
    text = str(caught.value)
    assert text.startswith("drive.toml: ")
    assert f"did you mean {hint}" in text or hint in text.split("did you mean")[1]
    assert "\n" not in text


def test_a_broken_database_is_one_line_with_the_place(tmp_path: Path) -> None:
    path = tmp_path / "broken.dbc"
    path.write_text('BO_ 1 A: 8 X\n SG_ B : 0|8@1+ (1,0) [0|1] " X\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"^.*broken\.dbc: is no CAN database \(.*line \d.*$"):
        load_database(path)


@pytest.mark.parametrize(("scale", "speed_mps"), [(1.0, 100.0), (-1.0, 100.0), (2.1, None)])
def test_a_speed_that_no_vehicle_has_is_unknown_forwards_and_backwards(
    database: Database, scale: float, speed_mps: float | None
) -> None:
    mapping = SignalMapping(message="Wheels", signal="Left", scale=scale)
    frame = Frame(at(0), "1", 256, False, (10_000).to_bytes(2, "little") + bytes(2))
    found = ingest(database, frame, odometer__speed_mps=mapping)
    assert [each.speed_mps for each in found if isinstance(each, Odometer)] == [speed_mps]
