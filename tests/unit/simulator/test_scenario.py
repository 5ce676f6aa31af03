"""Scenario files: what they may say, and that all of the shipped ones can be driven."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from wayline.errors import InputError
from wayline_cli.__main__ import app
from wayline_simulator.course import repeated
from wayline_simulator.presets import PRESETS
from wayline_simulator.road import make_course
from wayline_simulator.scenario import Scenario, overlaid
from wayline_simulator.scenario_file import SHIPPED, load_scenario, shipped_scenarios
from wayline_simulator.simulation import simulate_run

SHORT = {"kind": "main", "length_m": 3000.0}


def written(folder: Path, text: str) -> str:
    path = folder / "mine.toml"
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize("name", sorted(path.stem for path in SHIPPED.glob("*.toml")))
def test_every_shipped_scenario_has_a_road_and_says_what_it_is(name: str) -> None:
    """Its stretches and halts fit the road that its seed makes."""
    scenario = load_scenario(name)
    lap = make_course(scenario.road, scenario.seed)
    assert repeated(lap, scenario.road.laps).length_m > 1000.0
    assert scenario.description


def test_a_sensors_table_holds_only_what_differs_from_the_preset(tmp_path: Path) -> None:
    """The rest stays the preset's."""
    path = written(tmp_path, 'preset = "mems"\n[gyro]\nbias_degps = 2.0\n')
    model, preset = load_scenario(path).sensor_models().gyro, PRESETS["mems"].gyro
    assert model is not None
    assert preset is not None
    assert (model.bias_degps, model.scale_std) == (2.0, preset.scale_std)


def test_a_vehicle_without_a_sensor_has_none() -> None:
    """`sensors` names those that it has."""
    models = Scenario(preset="mems", sensors=("gps", "odometer")).sensor_models()
    assert models.gps is not None
    assert models.odometer is not None
    assert models.gyro is None
    assert models.barometer is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("sead = 3", "unknown key sead"),
        ('preset = "mens"', "preset 'mens' is not known; give consumer"),
        ('vehicle = "tram"', "vehicle 'tram' is not known; give car"),
        ("[gyro]\nbias = 1.0", r"scenario \[gyro\]: unknown key bias"),
        ("start = 2026-05-04T08:00:00", "start: "),
        ("start = 2026-05-04T08:00:00.5Z", "start is not a whole second"),
        ("[road]\nlaps = 0", r"road\.laps"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, text: str, said: str) -> None:
    """One line with the key and the mend."""
    with pytest.raises(InputError, match=said):
        load_scenario(written(tmp_path, text))


def test_an_unknown_name_lists_the_known_ones() -> None:
    """Those of --list."""
    with pytest.raises(InputError, match=r"gargage is not known; give a file or canyon, .*garage"):
        load_scenario("gargage")


def test_the_command_line_goes_before_the_file() -> None:
    """Of the road only what is given."""
    wanted = overlaid(load_scenario("hills"), {"seed": 9, "road": {"laps": 2}})
    assert (wanted.seed, wanted.road.laps) == (9, 2)
    assert (wanted.road.kind, wanted.vehicle, wanted.runs) == ("hills", "truck", 6)


def test_runs_share_the_vehicle_and_differ_in_driver_day_and_noise() -> None:
    """The gyro's scale is the device's; pace, weather and start are the run's."""
    scenario = overlaid(
        Scenario(preset="mems"), {"road": SHORT, "gyro": {"scale_std": 0.1, "bias_std_degps": 0.0}}
    )
    course = make_course(scenario.road, scenario.seed)
    first, second = (simulate_run(scenario, course, number) for number in (1, 2))
    assert first.facts.weather != second.facts.weather
    assert first.journey.duration_s != second.journey.duration_s
    assert second.start_s - first.start_s == round(scenario.run_every_h * 3600.0)
    assert first.assumed == second.assumed


def test_another_seed_draws_other_noise_on_the_same_road() -> None:
    """The seed is not the road's alone."""
    scenario = overlaid(Scenario(preset="mems"), {"road": SHORT})
    course = make_course(scenario.road, scenario.seed)
    first, second = (simulate_run(overlaid(scenario, {"seed": seed}), course, 1) for seed in (1, 2))
    assert first.facts.weather != second.facts.weather
    assert first.assumed != second.assumed


def test_one_sensor_more_or_less_leaves_the_others_as_they_were() -> None:
    """Every part draws from random numbers of its own."""
    whole = overlaid(Scenario(preset="mems"), {"road": SHORT})
    less = overlaid(whole, {"sensors": ["gps", "gyro"], "gps": {"rate_hz": 5.0}})
    course = make_course(whole.road, whole.seed)
    first, second = (simulate_run(scenario, course, 1) for scenario in (whole, less))
    assert first.samples.gyro is not None
    assert second.samples.gyro is not None
    assert (first.samples.gyro.yaw_rates_degps == second.samples.gyro.yaw_rates_degps).all()
    assert second.samples.odometer is None


def test_the_list_names_every_scenario() -> None:
    """`wayline simulate --list`."""
    said = CliRunner().invoke(app, ["simulate", "--list"]).output
    assert all(name in said for name in shipped_scenarios())


def test_a_drive_needs_a_folder() -> None:
    """It is not written where the user happens to stand."""
    result = CliRunner().invoke(app, ["simulate", "--scenario", "garage"])
    assert isinstance(result.exception, InputError)
    assert "--out" in str(result.exception)
