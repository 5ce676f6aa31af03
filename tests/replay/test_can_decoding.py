"""Recorded buses through can-ingest, beside their bits taken apart by hand in this file."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import pytest

from builders import about, only
from wayline.can_log import CanLog
from wayline.drive import CanSource, Drive, SignalMapping, Vehicle
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.inputs import Frame
from wayline.messages import Barometer, GpsFix, Gyro, Message, Odometer, Torque
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_database

Recorded = Callable[[str], Path]
Heard = list[tuple[Frame, list[Message]]]
Value = float | bool | None
KMH_MPS = 1.0 / 3.6
KMH_256 = KMH_MPS / 256.0


def decoded(source: CanSource, vehicle: Vehicle) -> Heard:
    """Every frame of a recorded bus and the messages that can-ingest makes of it."""
    core = CanIngestCore(source, load_mapping(source, vehicle, "test"), vehicle)
    log = CanLog([Path(path) for path in source.paths])
    return [(frame, list(core.handle(frame, "can-ingest"))) for frame in log]


def bits(data: bytes, start: int, length: int) -> int:
    """Little endian, unsigned."""
    return int.from_bytes(data, "little") >> start & ((1 << length) - 1)


def big(data: bytes, first_byte: int, count: int) -> int:
    """Whole bytes, big endian, unsigned."""
    return int.from_bytes(data[first_byte : first_byte + count], "big")


def assert_same(seen: list[Value], wanted: list[Value], what: str) -> None:
    """Number by number, null where null."""
    assert len(seen) == len(wanted), what
    for one, other in zip(seen, wanted, strict=True):
        same = one is other if None in (one, other) else one == pytest.approx(other, abs=1e-9)
        assert same, f"{what}: {one} in place of {other}"


# css-164: GNSS and IMU frames by their identifier, OBD-II by service and PID


@pytest.fixture(scope="module")
def css() -> Callable[[Path], tuple[Drive, Heard]]:
    """The drive decoded once."""
    done: list[tuple[Drive, Heard]] = []

    def run(folder: Path) -> tuple[Drive, Heard]:
        if not done:
            drive = load_drive(folder)
            done.append((drive, decoded(drive.can[0], drive.vehicle)))
        return done[0]

    return run


def css_gyro(data: bytes) -> Value:
    return -(bits(data, 31, 11) * 0.25 - 256.0) if bits(data, 0, 1) else None


OBD: dict[int, tuple[type[Message], str, Callable[[bytes], float]]] = {
    0x0D: (Odometer, "speed_mps", lambda data: data[3] * KMH_MPS),
    0x0C: (Torque, "engine_speed_rpm", lambda data: big(data, 3, 2) / 4.0),
    0x62: (Torque, "engine_torque_nm", lambda data: (data[3] - 125.0) * 2.7),
    0x33: (Barometer, "pressure_pa", lambda data: data[3] * 1000.0),
}
"""By PID: what it becomes."""


def test_css_164_rates_and_replies_are_what_their_bits_say(
    recorded: Recorded, css: Callable[[Path], tuple[Drive, Heard]]
) -> None:
    """Every IMU frame and every OBD-II reply, the invalid ones null, stamped with the frame."""
    counts = dict.fromkeys((*OBD, "gyro"), 0)
    _, heard = css(recorded("css-164"))
    for frame, messages in heard:
        rest = [message for message in messages if not isinstance(message, GpsFix)]
        wanted: list[tuple[type[Message], str, Value]] = []
        if frame.arbitration_id == 9:
            wanted = [(Gyro, "yaw_rate_degps", css_gyro(frame.data))]
        elif frame.arbitration_id == 0x7E8 and frame.data[1] == 0x41 and frame.data[2] in OBD:
            topic, field, read = OBD[frame.data[2]]
            wanted = [(topic, field, read(frame.data))]
        assert [(type(each), each.t_ns) for each in rest] == [(w[0], frame.t_ns) for w in wanted]
        for message, (_, field, value) in zip(rest, wanted, strict=True):
            assert_same([getattr(message, field)], [value], field)
            counts["gyro" if field == "yaw_rate_degps" else frame.data[2]] += value is not None
    assert counts == {0x0D: 4785, 0x0C: 4790, 0x62: 4778, 0x33: 797, "gyro": 240_208}


class GnssBurst(NamedTuple):
    """The seven frames of one epoch, by identifier."""

    t_ns: int
    data: dict[int, bytes]

    def wanted(self) -> dict[str, Value]:
        """Fields of its fix."""
        satellites, place, height, attitude, speed = (self.data[n] for n in (1, 3, 4, 5, 7))
        is_placed, is_high = bits(place, 0, 1), bits(height, 0, 1)
        return {
            "valid": bool(is_placed),
            "lat_deg": bits(place, 1, 28) * 1e-6 - 90.0 if is_placed else None,
            "lon_deg": bits(place, 29, 29) * 1e-6 - 180.0 if is_placed else None,
            "h_std_m": float(bits(place, 58, 6)) or None if is_placed else None,
            "alt_m": bits(height, 1, 18) * 0.1 - 6000.0 if is_high else None,
            "v_std_m": float(bits(height, 19, 13)) or None if is_high else None,
            "course_deg": bits(attitude, 43, 12) * 0.1 % 360.0 if bits(attitude, 0, 1) else None,
            "speed_mps": bits(speed, 1, 20) * 0.001 if bits(speed, 0, 1) else None,
            "satellites": float(bits(satellites, 3, 5)),
        }


def bursts(heard: Heard) -> Iterator[GnssBurst]:
    """The receiver sends identifiers 1 to 8 in their order."""
    burst: dict[int, bytes] = {}
    t_ns = 0
    for frame, _ in heard:
        if frame.arbitration_id == 1:
            burst, t_ns = {}, frame.t_ns
        if frame.arbitration_id <= 8:
            burst[frame.arbitration_id] = frame.data
        if frame.arbitration_id == 8:
            yield GnssBurst(t_ns, burst)


def test_css_164_fixes_are_what_their_bits_say(
    recorded: Recorded, css: Callable[[Path], tuple[Drive, Heard]]
) -> None:
    """Five mapped frames an epoch, stamped with the first less the receiver's latency."""
    _, heard = css(recorded("css-164"))
    fixes = only((message for _, messages in heard for message in messages), GpsFix)
    wanted = list(bursts(heard))
    assert [fix.t_ns for fix in fixes] == [burst.t_ns - 350_000_000 for burst in wanted]
    assert len(fixes) == 2272
    assert sum(fix.valid for fix in fixes) == 2161
    for fix, burst in zip(fixes, wanted, strict=True):
        for field, value in burst.wanted().items():
            assert_same([getattr(fix, field)], [value], field)


# comma-seg40-can: big-endian frames of 11-bit identifiers, two buses


WHEELS = {"FR": 0, "FL": 2, "RR": 4, "RL": 6}
"""First byte of each wheel's 15 bits."""


def toyota_wheel_kmh(data: bytes, wheel: str) -> float:
    return (big(data, WHEELS[wheel], 2) & 0x7FFF) * 0.01 - 67.67


def test_comma_seg40_wheel_speeds_are_the_known_ones(recorded: Recorded) -> None:
    """Their number, range and distance, each wheel alone and the mean of all four."""
    drive = load_drive(recorded("comma-seg40-can"))
    for signals in [[wheel] for wheel in WHEELS] + [list(WHEELS)]:
        names = tuple(f"WHEEL_SPEED_{wheel}" for wheel in signals)
        mapped = SignalMapping(message="WHEEL_SPEEDS", signal=names, scale=KMH_MPS)
        source = msgspec.structs.replace(drive.can[0], signals={"odometer.speed_mps": mapped})
        heard = [(frame, each) for frame, each in decoded(source, drive.vehicle) if each]
        assert {frame.arbitration_id for frame, _ in heard} == {0xAA}
        wheels = [[toyota_wheel_kmh(f.data, wheel) for wheel in signals] for f, _ in heard]
        means = [sum(each) / len(each) * KMH_MPS for each in wheels]
        odometers = only((message for _, messages in heard for message in messages), Odometer)
        assert_same([each.speed_mps for each in odometers], [*means], " and ".join(signals))
    all_kmh = [kmh for each in wheels for kmh in each]
    assert len(heard) == 4974
    assert (min(all_kmh), max(all_kmh)) == pytest.approx((28.46, 71.77))
    times_s = [(each.t_ns - odometers[0].t_ns) * 1e-9 for each in odometers]
    steps = zip(times_s[1:], times_s, means, means[1:], strict=False)
    assert sum((b - a) * (v + w) / 2 for b, a, v, w in steps) == pytest.approx(1003.8, abs=0.1)


def test_comma_seg40_as_its_drive_maps_it_is_what_its_bits_say(recorded: Recorded) -> None:
    """Speed, yaw rate and engine speed of every frame that is mapped, and nothing else."""
    drive = load_drive(recorded("comma-seg40-can"))
    for frame, messages in decoded(drive.can[0], drive.vehicle):
        data, wanted = frame.data, list[Message]()
        if frame.arbitration_id == 0xB4:
            speed_mps = big(data, 5, 2) * 0.01 * KMH_MPS
            wanted = [Odometer(t_ns=frame.t_ns, speed_mps=about(speed_mps, 1e-9))]
        elif frame.arbitration_id == 0x24:
            rate_degps = -((big(data, 0, 2) & 0x3FF) * 0.244 - 125.0)
            wanted = [Gyro(t_ns=frame.t_ns, yaw_rate_degps=about(rate_degps, 1e-9))]
        elif frame.arbitration_id == 0x1C4:
            raw = int.from_bytes(data[:2], "big", signed=True)
            rpm = raw * 0.78125
            wanted = [Torque(t_ns=frame.t_ns, engine_speed_rpm=about(rpm, 1e-9))]
        assert messages == wanted


# j1939-stationary through the profile: every mapped group by its number


def unless_missing(data: bytes, start: int, length: int, scale: float, offset: float) -> Value:
    """A field of J1939-71: its top byte FEh or FFh, or two bits 10 or 11, say "no value"."""
    if len(data) * 8 < start + length:
        return None
    raw = bits(data, start, length)
    is_missing = raw >= 2 if length == 2 else raw >> (length - 8) >= 0xFE
    return None if is_missing else raw * scale + offset


def switch(data: bytes, start: int, true_when: int) -> Value:
    raw = unless_missing(data, start, 2, 1.0, 0.0)
    return None if raw is None else raw == true_when


def axle_mps(data: bytes, start: int) -> Value:
    left, right = (word(KMH_256, 0.0, at)(data) for at in (start, start + 16))
    return None if None in (left, right) else (left + right) / 2  # type: ignore[operator]


def wheels_mps(data: bytes) -> Value:
    """The rear axle's, else the front axle's."""
    rear_mps = axle_mps(data, 32)
    return axle_mps(data, 0) if rear_mps is None else rear_mps


def word(scale: float, offset: float, start: int, length: int = 16) -> Callable[[bytes], Value]:
    return lambda data: unless_missing(data, start, length, scale, offset)


GROUPS: dict[int, dict[str, Callable[[bytes], Value]]] = {
    0xF004: {"engine_speed_rpm": word(0.125, 0.0, 24)},
    0xFEF1: {
        "speed_mps": word(KMH_256, 0.0, 8),
        "brake": lambda data: switch(data, 28, 1),
        "clutch": lambda data: switch(data, 30, 1),
    },
    0xFE6E: {"speed_mps": wheels_mps},
    0xFEBF: {"speed_mps": word(KMH_256, 0.0, 0)},
    0xF001: {"brake": lambda data: switch(data, 6, 1)},
    0xF005: {"gear_ratio": word(0.001, 0.0, 8), "gear": word(1.0, -125.0, 24, 8)},
    0xFEF5: {
        # no air at all, as one of the vehicles says, is no pressure
        "pressure_pa": lambda data: word(500.0, 0.0, 0, 8)(data) or None,
        "temperature_c": word(0.03125, -273.0, 24),
    },
    0xFEC1: {"distance_m": word(5.0, 0.0, 0, 32)},
}
"""By group: what its bits say for each field, in our units."""
CHOSEN = {"speed_mps", "brake", "clutch", "distance_m"}
"""Several groups or units tell these; which one is read is another test's matter."""


class Percent:
    """Net torque, from percentages of what a long message says."""

    def __init__(self) -> None:
        self._friction_pct = 0.0
        self._reference_nm: float | None = None
        self._long: list[bytes] = []
        self._packets = 0
        """Of the EC1 that is being sent; 0 while another group is."""

    def torque_nm(self, pgn: int, data: bytes) -> Value:
        """Of an EEC1; the other groups are remembered."""
        if pgn == 0xECFF:
            is_ec1 = data[0] == 32 and data[5:] == (0xFEE3).to_bytes(3, "little")
            self._long, self._packets = [], data[3] if is_ec1 else 0
        elif pgn == 0xEBFF and self._packets:
            self._long.append(data[1:])
            if len(self._long) == self._packets:
                self._reference_nm = float(bits(b"".join(self._long), 152, 16))
        elif pgn == 0xFEDF:
            self._friction_pct = unless_missing(data, 0, 8, 1.0, -125.0) or self._friction_pct
        percent = unless_missing(data, 16, 8, 1.0, -125.0)
        if pgn != 0xF004 or percent is None or self._reference_nm is None:
            return None
        return (percent - self._friction_pct) / 100.0 * self._reference_nm


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        (
            "idling-iowa",
            {"engine_speed_rpm": 12_719, "engine_torque_nm": 12_444, "speed_mps": 1272}
            | {"brake": 1272, "clutch": 1272, "pressure_pa": 127, "temperature_c": 127},
        ),
        (
            "parked-uk",
            {"engine_speed_rpm": 3993, "speed_mps": 4103, "gear": 3993, "brake": 3994}
            | {"clutch": 3993, "temperature_c": 396, "distance_m": 406},
        ),
        ("transport", {"engine_speed_rpm": 577, "engine_torque_nm": 558, "speed_mps": 187}),
    ],
)
def test_heavy_vehicles_through_the_profile_are_what_their_bits_say(
    recorded: Recorded, name: str, counts: dict[str, int]
) -> None:
    """Whatever the addresses; "not available" is null, and so is a field that no group holds."""
    source = CanSource(path=str(recorded("j1939-stationary") / f"{name}.mf4"))
    percent, seen, farthest_m = Percent(), dict[str, int](), 0.0
    for frame, messages in decoded(source, Vehicle(profile="j1939-truck")):
        pgn = frame.arbitration_id >> 8 & 0x3FFFF if frame.extended else 0
        torque_nm = percent.torque_nm(pgn, frame.data)
        wanted = {field: read(frame.data) for field, read in GROUPS.get(pgn, {}).items()}
        if "distance_m" in wanted:
            # a unit that restarts counts from 0 for a moment, which nobody has driven
            wanted["distance_m"] = farthest_m = max(farthest_m, wanted["distance_m"] or 0.0)
        told = {
            field: value
            for message in messages
            for field, value in msgspec.structs.asdict(message).items()
            if field != "t_ns" and value is not None
        }
        assert_same([told.pop("engine_torque_nm", None)], [torque_nm], "engine_torque_nm")
        for field in told.keys() | wanted.keys():
            if field in told or field not in CHOSEN:
                assert_same([told.get(field)], [wanted.get(field)], field)
        for field in [*told, *(["engine_torque_nm"] if torque_nm is not None else [])]:
            seen[field] = seen.get(field, 0) + 1
    assert seen == counts


# databases as people have them


@pytest.mark.parametrize(
    ("name", "messages"),
    [
        ("toyota_prius_2010_pt", 26),
        ("toyota_nodsu_pt", 5),
        ("toyota_new_mc_pt", 3),
        ("honda_civic_touring_2016_can", 2),
        ("_nidec_common", 5),
        ("_gearbox_common", 2),
    ],
)
def test_a_good_database_loads(recorded: Recorded, name: str, messages: int) -> None:
    """Fragments of others too."""
    assert len(load_database(recorded("dbc") / f"{name}.dbc").messages) == messages


@pytest.mark.parametrize(
    ("name", "place"),
    [("_honda_common", "line 207"), ("toyota_2017_ref_pt", "message BDB1F01_14")],
)
def test_a_broken_database_is_one_line(recorded: Recorded, name: str, place: str) -> None:
    """Where: file and place; what; and the mend."""
    path = recorded("dbc") / f"{name}.dbc"
    with pytest.raises(InputError) as caught:
        load_database(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: is no CAN database (")
    assert place in text
    assert text.endswith("correct the file or name another")
    assert "\n" not in text


def test_a_message_that_a_fragment_lacks_is_named(recorded: Recorded) -> None:
    """With what the fragment has in its place."""
    source = CanSource(
        path="x.log",
        dbc=(str(recorded("dbc") / "honda_civic_touring_2016_can.dbc"),),
        signals={"odometer.speed_mps": SignalMapping(message="ENGINE_DATA", signal="XMISSION")},
    )
    with pytest.raises(InputError, match=r"names message ENGINE_DATA, which no dbc .* has"):
        load_mapping(source, Vehicle(), "drive.toml")
