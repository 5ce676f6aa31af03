"""`wayline doctor can` on recordings and virtual buses, and its proposals put into a drive."""

import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import can
import pytest
from typer.testing import CliRunner, Result

from buses import message
from ecu import Ecu
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import Message, Odometer
from wayline_can_ingest.diagnosis.findings import arrivals
from wayline_can_ingest.recorded import recordings
from wayline_cli.__main__ import app

Recorded = Callable[[str], Path]
SECONDS = "2"
POLLED_SECONDS = "4"
"""A machine that is busy elsewhere makes a poll miss replies."""
SPEED_DBC = """VERSION ""
BU_: ECU
BO_ 256 Wheels: 2 ECU
 SG_ VehicleSpeed : 0|16@1+ (0.01,0) [0|655] "km/h" ECU
"""


def asked(*arguments: str | Path) -> Result:
    """The command's answer; what is no InputError is a bug."""
    result = CliRunner().invoke(app, ["doctor", "can", *map(str, arguments)])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def pasted(result: Result, folder: Path, heading: str = "# the mapping proposed") -> list[Message]:
    """What can-ingest publishes of a drive that holds the text behind a heading."""
    assert result.exit_code == 0
    table = result.output.partition(heading)[2].partition("\n")[2]
    (folder / "drive.toml").write_text(f'[drive]\nvehicle_id = "a"\n{table}')
    drive = load_drive(folder)
    return [each for one in recordings(drive, "drive.toml") for _, each in one.messages]


def rates(messages: list[Message], lasted_s: float) -> dict[str, float]:
    """How often each quantity comes, in Hz."""
    return {each.quantity: each.rate_hz for each in arrivals(messages, lasted_s)}


def test_the_proposal_for_css_164_replays(recorded: Recorded, tmp_path: Path) -> None:
    """Pasted as it is, its first 545 s give fixes and what the vehicle says."""
    css = recorded("css-164")
    databases = ("--dbc", css / "canmod-gps.dbc", "--dbc", css / "obd2.dbc")
    result = asked("--log", css / "1.mf4", *databases)
    assert "profile canmod-gps fits: 6 of its 6 messages come" in result.output
    assert "profile obd2 fits" in result.output
    seen = rates(pasted(result, tmp_path), 545.0)
    assert seen["gyro.yaw_rate_degps"] == pytest.approx(100.0, abs=3.0)
    assert seen["odometer.speed_mps"] == pytest.approx(2.0, abs=0.1)
    assert seen["gps_fix.lat_deg"] == pytest.approx(0.73, abs=0.1)
    assert {"gps_fix.alt_m", "torque.engine_speed_rpm", "barometer.pressure_pa"} <= seen.keys()


def test_the_profiles_for_css_164_replay(recorded: Recorded, tmp_path: Path) -> None:
    """So does the table without any database."""
    result = asked("--log", recorded("css-164") / "5.mf4")
    seen = rates(pasted(result, tmp_path, "# the profile"), 1.0)
    assert {"gps_fix.lat_deg", "gyro.yaw_rate_degps", "odometer.speed_mps"} <= seen.keys()


@pytest.mark.parametrize(
    ("dbc", "signals"),
    [
        ("comma-seg40-can/toyota.dbc", '["WHEEL_SPEED_RL", "WHEEL_SPEED_RR"]'),
        ("dbc/toyota_prius_2010_pt.dbc", '"SPEED"'),
    ],
)
def test_proposals_for_a_toyota_replay(
    recorded: Recorded, tmp_path: Path, dbc: str, signals: str
) -> None:
    """With its own database, and with that of a related car."""
    folder, _, name = dbc.partition("/")
    log = recorded("comma-seg40-can") / "can.log.gz"
    result = asked("--log", log, "--dbc", recorded(folder) / name)
    assert f"signal = {signals}, scale = " in result.output
    odometers = [each for each in pasted(result, tmp_path) if isinstance(each, Odometer)]
    known = [each.speed_mps for each in odometers if each.speed_mps is not None]
    assert 7.5 < min(known) < 8.5
    assert 19.5 < max(known) < 20.5


def test_a_truck_is_told_by_its_profile_and_its_database_by_groups(recorded: Recorded) -> None:
    """The database's source address is another one than the bus's."""
    folder = recorded("j1939-stationary")
    result = asked("--log", folder / "transport.mf4", "--dbc", folder / "j1939-demo.dbc")
    assert "profile j1939-truck fits: 4 of its" in result.output
    assert "j1939 = true" in result.output
    assert 'profile = "j1939-truck"' in result.output
    assert "missing: odometer.distance_m, gyro.yaw_rate_degps" in result.output


@pytest.mark.parametrize(
    ("name", "place"),
    [("_honda_common.dbc", "line 207"), ("toyota_2017_ref_pt.dbc", "message BDB1F01_14")],
)
def test_a_broken_database_is_one_line(recorded: Recorded, name: str, place: str) -> None:
    """It names the file and the place, before anything is listened to."""
    path = recorded("dbc") / name
    with pytest.raises(InputError) as refused:
        asked("--dbc", path, "--channel", "none")
    said = str(refused.value)
    assert said.startswith(str(path))
    assert place in said
    assert "\n" not in said


def test_a_database_of_another_bus_is_refused(recorded: Recorded) -> None:
    """Nothing of it comes."""
    log = recorded("j1939-stationary") / "transport.mf4"
    with pytest.raises(InputError, match="none of its messages was heard"):
        asked("--log", log, "--dbc", recorded("dbc") / "toyota_prius_2010_pt.dbc")


def test_a_database_alone_is_enough_for_a_proposal(tmp_path: Path) -> None:
    """Then names and units have to do."""
    dbc = tmp_path / "wheels.dbc"
    dbc.write_text(SPEED_DBC)
    assert '"odometer.speed_mps" = { message = "Wheels"' in asked("--dbc", dbc).output
    dbc.write_text(SPEED_DBC.replace("VehicleSpeed", "Oil"))
    with pytest.raises(InputError, match="none of its signals looks like"):
        asked("--dbc", dbc)


@contextlib.contextmanager
def speaking(channel: str) -> Iterator[None]:
    """Frames of a wheel on a virtual bus."""
    stop = threading.Event()

    def speak() -> None:
        with can.Bus(interface="virtual", channel=channel) as bus:
            while not stop.wait(0.02):
                bus.send(message(256, b"\x10\x27"))

    thread = threading.Thread(target=speak, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def test_a_live_bus_is_listened_to(tmp_path: Path) -> None:
    """The proposal is for that very interface."""
    dbc = tmp_path / "wheels.dbc"
    dbc.write_text(SPEED_DBC)
    bus = ("--interface", "virtual", "--channel", "doctor-live", "--seconds", SECONDS)
    with speaking("doctor-live"):
        result = asked(*bus, "--option", "receive_own_messages=false", "--dbc", dbc)
    assert result.exit_code == 0
    assert "1 identifiers, 0 of them with 29 bits" in result.output
    assert "no profile fits" in result.output
    assert 'interface = "virtual"\nchannel = "doctor-live"\n' in result.output
    assert "options = { receive_own_messages = false }" in result.output
    assert "27.77778" in result.output


def test_a_car_is_asked_for_its_values() -> None:
    """With --obd2 only."""
    ecu = Ecu("doctor-obd2")
    bus = ("--interface", "virtual", "--channel", "doctor-obd2", "--seconds")
    try:
        quiet = asked(*bus, "0.5")
        assert not ecu.asked
        ecu.speaks = False
        refused = asked(*bus, "1", "--obd2")
        ecu.speaks = True
        result = asked(*bus, POLLED_SECONDS, "--obd2")
    finally:
        ecu.close()
    assert quiet.exit_code == 1
    assert "--obd2" in quiet.output
    assert refused.exit_code == 1
    assert "the vehicle does not answer\nignition on?" in refused.output
    assert "polls 7E8 for 0C 0D 33 62 63" in result.output
    assert 'profile = "obd2"' in result.output
    assert "odometer.speed_mps" in result.output


def test_a_bus_that_does_not_open_is_refused_with_what_to_mend() -> None:
    """At once, not after the listening."""
    with pytest.raises(InputError, match="does not open") as refused:
        asked("--interface", "no-such", "--channel", "x", "--seconds", "60")
    assert refused.value.mend


def test_a_recording_and_a_bus_at_once_are_refused(tmp_path: Path) -> None:
    """So is an option without a value."""
    with pytest.raises(InputError, match="--log"):
        asked("--log", tmp_path / "a.log", "--channel", "can0")
    with pytest.raises(InputError, match="is no option"):
        asked("--option", "port")


def test_the_doctor_of_the_machine_stays_as_it_was(tmp_path: Path) -> None:
    """Without `can` it makes its checks, of a configuration too."""
    result = CliRunner().invoke(app, ["doctor", "--config", str(tmp_path / "none.toml")])
    assert result.exit_code == 1
    assert "configuration" in result.output
    assert "clock" in result.output
