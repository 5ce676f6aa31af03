"""The configuration file of the services, and what the environment says over it."""

from pathlib import Path

import pytest

from wayline.errors import InputError
from wayline.settings import EVERY_VEHICLE, Settings, load_settings, overridden

ALL = """
vehicle_id = "bus-1"
database_url = "sqlite:///from-file.db"
routes = ["routes/1.geojson"]
[bus]
connect = ["tcp/10.0.0.1:7447"]
password = "in-the-file"
[http]
tokens = ["one"]
[ports]
fusion = 9003
[[can]]
interface = "virtual"
channel = "a"
dbc = ["vehicle.dbc"]
[tuning]
gps_range_std_m = 2.5
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "wayline.toml"
    path.write_text(text)
    return path


def test_a_file_is_read_and_its_paths_are_relative_to_it(tmp_path: Path) -> None:
    settings = load_settings(written(tmp_path, ALL), {})
    assert settings.own_vehicle() == "bus-1"
    assert settings.served() == ("bus-1",)
    assert settings.routes == (str(tmp_path / "routes/1.geojson"),)
    assert settings.can[0].dbc == (str(tmp_path / "vehicle.dbc"),)
    assert settings.tuning.gps_range_std_m == 2.5


def test_the_environment_overrides_identity_endpoints_and_secrets(tmp_path: Path) -> None:
    environment = {
        "WAYLINE_VEHICLE_ID": "bus-2",
        "WAYLINE_ZENOH_CONNECT": "tcp/a:1,tcp/b:2",
        "WAYLINE_ZENOH_PASSWORD": "secret",
        "WAYLINE_DATABASE_URL": "sqlite:///other.db",
        "WAYLINE_HTTP_TOKEN": "two",
    }
    settings = load_settings(written(tmp_path, ALL), environment)
    assert settings.own_vehicle() == "bus-2"
    assert settings.bus.connect == ("tcp/a:1", "tcp/b:2")
    assert settings.bus.password == "secret"
    assert settings.database_url == "sqlite:///other.db"
    assert settings.http.tokens == ("one", "two")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("vehicel_id = 'bus-1'", "vehicel_id"),
        ("[tuning]\ngps_range_m = 1.0", "gps_range_m"),
        ("[ports]\nfusoin = 8003", "fusoin"),
        ("services = ['fusoin']", "fusoin"),
        ("vehicle_id = 'Bus 1'", "vehicle_id"),
        ("[[nmea]]\nurl = 'ttyUSB0'", "url"),
        ("vehicle_id = ", "is not TOML"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(tmp_path: Path, text: str, named: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        load_settings(path, {})
    assert str(path) in str(caught.value)
    assert named in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml"):
        load_settings(tmp_path / "none.toml", {})


def test_an_unfit_variable_is_refused_as_the_file_would_be() -> None:
    with pytest.raises(InputError, match="environment") as caught:
        overridden(Settings(), {"WAYLINE_VEHICLE_ID": "Bus 1"})
    assert "vehicle_id" in str(caught.value)


def test_a_star_serves_every_vehicle_and_a_list_those_named() -> None:
    assert Settings(vehicles=("bus-1", "bus-2"), vehicle_id="bus-3").served() == ("bus-1", "bus-2")
    assert Settings(vehicles=("bus-1", "*")).served() == (EVERY_VEHICLE,)


def test_a_file_without_a_vehicle_says_how_to_name_one() -> None:
    for ask in (Settings().served, Settings(vehicles=("*",)).own_vehicle):
        with pytest.raises(InputError, match="WAYLINE_VEHICLE_ID"):
            ask()


def test_each_service_has_its_port_unless_the_file_gives_another(tmp_path: Path) -> None:
    settings = load_settings(written(tmp_path, ALL), {})
    assert settings.http_of("fusion").port == 9003
    assert settings.http_of("eta").port == 8001
    assert settings.http_of("eta").tokens == ("one",)
