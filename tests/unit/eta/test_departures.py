"""What is told of a vehicle between two trips, and of one that turns round before the end."""

from pathlib import Path

import pytest

from unit.eta.rides import Ride, trips
from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, STEP_DEG, good_feed, write_folder
from wayline.messages import Message, Progress
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs

END_M = 4_002.9
"""Of the line of five stops, where its trips turn."""
TRIP_S = 480


def there_and_back(folder: Path, departures: tuple[str, ...] = ("08:12", "08:20")) -> Runs:
    """T to the north at eight; without blocks, back to the south at these times."""
    tables = good_feed()
    tables["trips.txt"] = "route_id,service_id,trip_id,direction_id,shape_id\nR,S,T,0,SH\n"
    tables["stop_times.txt"] = "".join(
        line + "\n" for line in tables["stop_times.txt"].splitlines() if not line.startswith("U")
    )
    for number, time in enumerate(departures):
        hour, minute = (int(part) for part in time.split(":"))
        tables["trips.txt"] += f"R,S,back-{number},1,\n"
        for at in range(5):
            clock = f"{hour:02d}:{minute + 2 * at:02d}:00"
            tables["stop_times.txt"] += f"back-{number},{clock},{clock},S{4 - at},{at + 1}\n"
    return Runs([read_timetable(write_folder(tables, folder))])


def to_the_end(ride: Ride, seconds: int = TRIP_S) -> None:
    """North from the first stop, so many seconds long."""
    for second in range(seconds):
        ride.at(min(8.34 * second, END_M))


def stand(ride: Ride, north_m: float, seconds: int) -> list[Message]:
    """Stand somewhere; the last that was told."""
    told: list[Message] = []
    for _ in range(seconds):
        told = ride.at(north_m, speed_mps=0.0)
    return told


def back_from(ride: Ride, start_m: float, metres: float) -> list[Message]:
    """South from a place; the last that was told."""
    told: list[Message] = []
    for second in range(round(metres / 8.34)):
        told = ride.at(start_m - 8.34 * second, heading_deg=180.0)
    return told


def directions(told: list[Message]) -> list[int | None]:
    return [each.direction_id for each in told if isinstance(each, Progress)]


def test_without_blocks_the_next_departure_is_told_at_the_terminal(tmp_path: Path) -> None:
    """From the last stop on, before the vehicle has turned."""
    ride = Ride(there_and_back(tmp_path))
    to_the_end(ride)
    assert trips(stand(ride, END_M, 10)) == ["back-0"]


def test_a_vehicle_that_lets_a_departure_go_waits_for_the_one_after(tmp_path: Path) -> None:
    """It stands there until 08:19, and leaves at 08:20."""
    ride = Ride(there_and_back(tmp_path))
    to_the_end(ride)
    assert trips(stand(ride, END_M, 4 * 60)) == ["back-0"]
    assert trips(stand(ride, END_M, 7 * 60)) == ["back-1"]
    stand(ride, END_M, 60)
    assert trips(back_from(ride, END_M, 600.0)) == ["back-1"]


def test_a_late_vehicle_runs_the_departure_that_it_missed(tmp_path: Path) -> None:
    """It comes at 08:17 for 08:12 and leaves at once: nobody leaves two minutes early."""
    ride = Ride(there_and_back(tmp_path), start="08:09")
    to_the_end(ride)
    stand(ride, END_M, 30)
    assert trips(back_from(ride, END_M, 1_500.0)) == ["back-0"]


def test_no_departure_from_before_the_arrival_is_told(tmp_path: Path) -> None:
    """The bus that left at 08:06 was another: this one was to arrive at 08:08."""
    ride = Ride(there_and_back(tmp_path, ("08:06", "08:20")))
    to_the_end(ride)
    assert trips(stand(ride, END_M, 10)) == ["back-1"]


def test_a_vehicle_that_leaves_the_terminal_for_elsewhere_runs_no_trip(tmp_path: Path) -> None:
    """It goes to its yard, east of there."""
    ride = Ride(there_and_back(tmp_path))
    to_the_end(ride)
    stand(ride, END_M, 10)
    told: list[Message] = []
    for second in range(60):
        told = ride.at(END_M, east_m=8.34 * second, heading_deg=90.0)
    assert told == []


def test_a_vehicle_that_turns_round_before_the_end_is_told_on_its_way_back(tmp_path: Path) -> None:
    """A short turn at S3: two reports every 30 s later, and before it has driven 400 m."""
    ride = Ride(there_and_back(tmp_path, ("08:04",)), every_s=30)
    to_the_end(ride, 360)
    told = back_from(ride, 3_002.0, 8.34 * 60.0)
    assert (directions(told), trips(told)) == ([1], ["back-0"])


@pytest.mark.parametrize("reported_m", [3_900.0, 3_700.0])
def test_an_arrival_between_two_reports_is_an_arrival(tmp_path: Path, reported_m: float) -> None:
    """Once a minute: one before the end, one on the way back, a second one, and it is told."""
    ride = Ride(there_and_back(tmp_path, ("08:09", "08:30")), every_s=60)
    to_the_end(ride, 481)
    told = back_from(ride, reported_m, 8.34 * 121.0)
    assert trips(told) == ["back-0"]


def lines_from_one_terminal(folder: Path) -> Runs:
    """T ends at S4, where R goes back to the south at 08:12 and Q to the east at 08:14."""
    tables = good_feed()
    tables["routes.txt"] += "Q,A,2,3\n"
    tables["trips.txt"] = (
        "route_id,service_id,trip_id,direction_id,shape_id\nR,S,T,0,SH\nR,S,back,1,\nQ,S,V,0,\n"
    )
    tables["stop_times.txt"] = "".join(
        line + "\n" for line in tables["stop_times.txt"].splitlines() if not line.startswith("U")
    )
    for at in range(5):
        tables["stop_times.txt"] += f"back,08:{12 + 2 * at}:00,08:{12 + 2 * at}:00,S{4 - at},{at}\n"
    east = f"E1,East,{LAT_DEG + 4 * STEP_DEG},{LON_DEG + 0.0134}\n"
    tables["stops.txt"] += east
    tables["stop_times.txt"] += "V,08:14:00,08:14:00,S4,0\nV,08:16:00,08:16:00,E1,1\n"
    return Runs([read_timetable(write_folder(tables, folder))])


def test_two_lines_from_one_terminal_are_not_told_apart_in_the_layover(tmp_path: Path) -> None:
    """And their trip and direction are not told before the vehicle is on its way."""
    ride = Ride(lines_from_one_terminal(tmp_path))
    to_the_end(ride)
    told = stand(ride, END_M, 10)
    assert (trips(told), directions(told)) == ([None], [None])
    stand(ride, END_M, 4 * 60)
    assert trips(back_from(ride, END_M, 700.0)) == ["back"]
