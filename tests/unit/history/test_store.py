"""The history in a database: what was written is read, once, in order; it ages within bounds."""

from collections.abc import Iterator

import numpy as np
import pytest
import sqlalchemy as sa

from builders import at
from unit.history.driven import VEHICLE, kept_of, legs, pose
from unit.history.keeping import FOREVER, History
from wayline_history.housekeeping import Limits
from wayline_history.records import Event, Piece
from wayline_history.trip_cutter import PARK_NS

HOUR_S = 3600.0
DAY_S = 24 * HOUR_S


@pytest.fixture
def history(database_url: str) -> Iterator[History]:
    opened = History(database_url)
    yield opened
    opened.engine.dispose()


def test_what_was_kept_is_read_within_its_bounds(history: History) -> None:
    history.keep(legs((100, 10.0)))
    assert history.times_s() == pytest.approx(list(range(100)))
    assert history.times_s(from_s=10, to_s=12) == pytest.approx([10, 11])


def test_of_another_vehicle_or_time_there_is_nothing(history: History) -> None:
    history.keep(legs((100, 10.0)))
    assert history.times_s("bus-8") == []
    assert history.times_s(from_s=200, to_s=300) == []


def test_a_drive_over_hours_and_days_is_one_track(history: History) -> None:
    drive = [pose(600.0 * step, 10.0 * step, 10.0) for step in range(300)]
    history.keep(drive)
    assert history.times_s() == pytest.approx([600.0 * step for step in range(300)])


def test_a_drive_that_is_kept_twice_is_read_once(history: History) -> None:
    for _ in range(2):
        history.keep(legs((60, 0.0), (100, 10.0)))
    assert history.times_s() == pytest.approx(list(range(160)))
    assert len(history.reader.trips(VEHICLE, at(0), at(1000))) == 1
    assert len(history.reader.events(VEHICLE, at(0), at(1000), 100)) == 1


def test_what_comes_late_takes_its_place(history: History) -> None:
    drive = list(legs((100, 10.0)))
    history.keep([*drive[:30], *drive[60:]])
    history.keep(drive[30:60])
    assert history.times_s() == pytest.approx(list(range(100)))


def test_all_pieces_of_a_batch_are_kept_or_none(history: History) -> None:
    (good,) = kept_of(legs((5, 10.0))).pieces
    bad = ("bus-8", type(good)(rows=good.rows, trips=(object(),)))  # type: ignore[arg-type]
    with pytest.raises(AttributeError):
        history.store.save([(VEHICLE, good), bad])
    assert history.times_s() == []


def test_trips_cut_again_from_the_store_are_those_cut_live(history: History) -> None:
    park_s = PARK_NS * 1e-9 + 20
    drive = list(legs((60, 0.0), (200, 12.0), (park_s, 0.0), (300, 8.0), (30, 0.0), (100, 9.0)))
    history.keep(drive)
    live = kept_of(drive).trips
    rows = [
        row
        for chunk in history.reader.rows(VEHICLE, "fused", at(0), at(1e5))
        for row in chunk.values.tolist()
    ]
    again = kept_of([], known=rows).trips
    assert len(live) == 2
    assert [each.trip for each in history.reader.trips(VEHICLE, at(0), at(1e5))] == live
    # the cutter that was fed from the store ends only the last one by itself
    assert again == live[-1:]


def test_an_hour_that_is_over_becomes_one_chunk(history: History) -> None:
    history.keep(legs((1000, 10.0)))
    before = history.times_s()
    assert history.chunk_count() > 50
    history.now_s += 2 * HOUR_S
    history.housekeeping().finish()
    assert history.chunk_count() == 1
    assert history.times_s() == before


def test_an_hour_that_goes_on_is_left_alone(history: History) -> None:
    history.keep(legs((1000, 10.0)))
    many = history.chunk_count()
    history.now_s += 60.0
    history.housekeeping().finish()
    assert history.chunk_count() == many


def test_what_comes_after_an_hour_was_closed_takes_its_place_too(history: History) -> None:
    drive = list(legs((1000, 10.0)))
    history.keep([*drive[:300], *drive[400:]])
    history.now_s += 2 * HOUR_S
    history.housekeeping().finish()
    history.keep(drive[300:400])
    assert history.times_s() == pytest.approx(list(range(1000)))
    history.now_s += 2 * HOUR_S
    history.housekeeping().finish()
    assert history.chunk_count() == 1
    assert history.times_s() == pytest.approx(list(range(1000)))


def test_poses_are_thinned_when_they_are_old_enough(history: History) -> None:
    history.keep(legs((1000, 10.0)))
    limits = FOREVER._replace(thins_after_s=DAY_S)
    history.now_s += 2 * HOUR_S
    history.housekeeping(limits).finish()
    assert len(history.times_s()) == 1000
    history.now_s += DAY_S
    history.housekeeping(limits).finish()
    assert history.times_s() == pytest.approx([0, 999])


def test_what_is_older_than_its_days_is_let_go(history: History) -> None:
    history.keep(legs((100, 10.0)))
    limits = FOREVER._replace(days=2.0)
    history.now_s += DAY_S
    assert not history.housekeeping(limits).let_go()
    history.keep([pose(DAY_S + s, 0, 0) for s in range(10)])
    history.now_s += 1.5 * DAY_S
    assert history.housekeeping(limits).let_go()
    assert history.times_s() == pytest.approx([DAY_S + s for s in range(10)])
    assert history.reader.trips(VEHICLE, at(0), at(1e6)) == []


def test_an_old_recording_is_kept_as_long_as_if_it_were_new(history: History) -> None:
    history.now_s += 1000 * DAY_S
    history.keep(legs((100, 10.0)))
    history.housekeeping(FOREVER._replace(days=2.0)).let_go()
    assert len(history.times_s()) == 100


def test_the_oldest_hours_go_where_there_is_too_much(history: History) -> None:
    chance = np.random.default_rng(1)
    for hour in range(30):
        drive = [pose(hour * HOUR_S + s, chance.normal(0, 1e4), 10.0) for s in range(600)]
        history.keep(drive)
    limits = Limits(days=1e6, megabytes=0.1, thins_after_s=1e12)
    assert history.housekeeping(limits).let_go()
    left = history.times_s()
    assert left[-1] == pytest.approx(29 * HOUR_S + 599)
    assert 0 < len(left) < 30 * 600
    assert left[0] % HOUR_S == pytest.approx(0.0)
    with history.engine.connect() as connection:
        query = sa.text("SELECT sum(length(data)) FROM history_chunk")
        assert connection.execute(query).scalar_one() <= 1e5
    assert not history.housekeeping(limits).let_go()
    # a day that was let go can come again
    history.keep(legs((10, 10.0)))
    assert history.times_s(to_s=100) == pytest.approx(list(range(10)))


def test_a_vehicle_that_is_renamed_keeps_its_past_under_its_former_name(history: History) -> None:
    history.keep(legs((10, 10.0)))
    history.keep(legs((10, 10.0), start_s=20), "bus-new")
    assert history.times_s() == pytest.approx(list(range(10)))
    assert history.times_s("bus-new") == pytest.approx([20 + s for s in range(10)])


def test_vehicles_are_listed_with_their_hours(history: History) -> None:
    history.keep(legs((10, 10.0)))
    (kept,) = history.reader.vehicles()
    assert kept.vehicle_id == VEHICLE
    assert kept.first_ns <= at(0)
    assert kept.last_ns >= at(10)


def test_events_of_the_fleet_are_told_of_every_vehicle(history: History) -> None:
    history.keep(legs((10, 10.0)))
    gone = Piece(events=(Event(t_ns=at(5), kind="service_down", name="eta"),))
    history.store.save([("_fleet", gone)])
    told = history.reader.events(VEHICLE, at(0), at(100), 10)
    assert [event.kind for event in told] == ["mode", "service_down"]


def test_answers_go_on_while_the_oldest_is_let_go(history: History) -> None:
    for hour in range(20):
        history.keep([pose(hour * HOUR_S + s, 10.0 * s, 10.0) for s in range(100)])
    reading = history.reader.rows(VEHICLE, "fused", at(0), at(1e6))
    first = next(reading)
    limits = Limits(days=1e6, megabytes=0.02, thins_after_s=1e12)
    assert history.housekeeping(limits).let_go()
    hours = {int(chunk.times_us[0]) for chunk in (first, *reading)}
    # what was read at once is told whole, what had gone meanwhile is left out, the rest is there
    assert 6 <= len(hours) < 20
    assert max(hours) == at(19 * HOUR_S) // 1000


def test_a_day_of_a_year_is_read_in_as_many_steps_as_of_a_week(history: History) -> None:
    """By the queries it takes: seconds would tell of the machine."""
    asked: list[str] = []
    sa.event.listen(history.engine, "before_cursor_execute", lambda *given: asked.append(given[2]))
    counts = []
    for days in (range(7), range(7, 60)):
        for day in days:
            history.keep([pose(day * DAY_S + 600 * s, s, 1.0) for s in range(144)])
        asked.clear()
        assert len(history.times_s(from_s=3 * DAY_S, to_s=4 * DAY_S)) == 144
        counts.append(len(asked))
    assert counts[0] == counts[1]
