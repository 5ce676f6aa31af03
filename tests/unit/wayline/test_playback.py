"""Drives played as they were driven, by several processes on one clock."""

import json
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import msgspec
import pytest
import zenoh

from builders import START_NS, at, gyro
from wayline.play_clock import PlayClock, agree, combined
from wayline.playback import PAUSE_NS, Playback, Played, PlayOptions
from wayline.received import Recording

FAST = 1e6
WAIT_S = 10.0


def recording(*seconds: float, bad_input: int = 0) -> Recording:
    """Gyro samples that arrive as they are measured."""
    messages = [(at(each), gyro(each, 0.0)) for each in seconds]
    return Recording("can-ingest", messages, lambda: bad_input)


def alone(own: PlayClock) -> PlayClock:
    """Nobody else plays; it is due at once."""
    return msgspec.structs.replace(own, start_ns=time.time_ns())


@contextmanager
def at_once(own: PlayClock) -> Iterator[PlayClock]:
    yield alone(own)


class Player:
    """Plays until so many messages were put."""

    def __init__(self, recordings: Sequence[Recording], count: int, **options: object) -> None:
        self._stop = threading.Event()
        self._count = count
        self.put: list[Played] = []
        self.clocks: list[PlayClock] = []
        self.opened = 0
        self._recordings = recordings
        play = msgspec.convert({"speed": FAST, **options}, PlayOptions)
        self.playback = Playback("can-ingest", self._open, play, self._agree)
        self.playback.run(self._take, self._stop)

    @property
    def times_ns(self) -> list[int]:
        return [played.message.t_ns for played in self.put]

    def _open(self) -> Sequence[Recording]:
        self.opened += 1
        return self._recordings

    @contextmanager
    def _agree(self, own: PlayClock) -> Iterator[PlayClock]:
        self.clocks.append(own)
        yield alone(own)

    def _take(self, message: msgspec.Struct) -> None:
        assert isinstance(message, Played)
        self.put.append(message)
        if len(self.put) == self._count:
            self._stop.set()


def test_a_drive_is_played_once_in_order_of_arrival_under_its_own_sources() -> None:
    player = Player([recording(0, 2), recording(1, 3)], 9)
    assert player.put == [Played("can-ingest", gyro(each, 0.0)) for each in range(4)]
    assert player.playback.detail == "played to its end, 4 messages"


def test_messages_are_due_as_they_were_driven_divided_by_the_speed() -> None:
    started_s = time.monotonic()
    Player([recording(0, 30)], 9, speed=100.0)
    assert 0.3 <= time.monotonic() - started_s < 3.0


def test_now_moves_every_message_by_one_constant() -> None:
    before_ns = time.time_ns()
    player = Player([recording(0, 1, 2.5)], 9, now=True)
    after_ns = time.time_ns()
    shift_ns = player.times_ns[0] - at(0)
    assert before_ns - START_NS <= shift_ns <= after_ns - START_NS
    assert player.times_ns == [at(0) + shift_ns, at(1) + shift_ns, at(2.5) + shift_ns]


def test_a_loop_begins_again_after_its_period_with_files_opened_anew() -> None:
    player = Player([recording(0, 1, 2.5, bad_input=2)], 7, loop=True)
    period_ns = at(2.5) - at(0) + PAUSE_NS
    once = [at(0), at(1), at(2.5)]
    assert player.clocks[0].period_ns == period_ns
    assert player.times_ns == [t_ns + loop * period_ns for loop in range(3) for t_ns in once][:7]
    # once for the clock, once a loop
    assert player.opened == 4
    assert player.playback.bad_input == 6
    assert player.playback.detail == "playing, loop 3"


def test_now_and_loop_together_keep_the_period() -> None:
    player = Player([recording(0, 1)], 4, loop=True, now=True)
    first_ns, second_ns, third_ns, _ = player.times_ns
    assert (second_ns - first_ns, third_ns - first_ns) == (at(1) - at(0), at(2) - at(0))


@pytest.mark.parametrize("loop", [False, True])
def test_a_player_without_messages_ends_and_brings_no_clock(loop: bool) -> None:
    player = Player([recording()], 1, loop=loop)
    assert player.clocks == []
    assert player.playback.detail == "played to its end, 0 messages"


def test_a_player_that_has_not_begun_does_not_say_that_it_has_ended() -> None:
    details: list[str | None] = []

    @contextmanager
    def agree_late(own: PlayClock) -> Iterator[PlayClock]:
        details.append(playback.detail)
        yield alone(own)

    playback = Playback("a", lambda: [recording(0)], PlayOptions(speed=FAST), agree_late)
    playback.run(lambda _: details.append(playback.detail), threading.Event())
    assert details == ["about to play", "about to play"]


def test_a_stop_ends_the_wait_for_the_next_message() -> None:
    stop = threading.Event()
    playback = Playback("a", lambda: [recording(0, 3600)], PlayOptions(speed=1.0), at_once)
    # the second message is due in an hour
    playback.run(lambda _: stop.set(), stop)
    assert stop.is_set()


def clock(origin_s: float, start_s: float, period_s: float) -> PlayClock:
    return PlayClock(origin_ns=at(origin_s), start_ns=at(start_s), period_ns=round(period_s * 1e9))


def test_players_that_come_together_take_first_origin_last_start_longest_period() -> None:
    one, other = clock(5.0, 100.0, 60.0), clock(4.0, 101.0, 50.0)
    assert combined([one, other]) == combined([other, one]) == clock(4.0, 101.0, 60.0)
    assert combined([one]) == one


@pytest.fixture
def session() -> Iterator[zenoh.Session]:
    """A session that reaches nobody but itself."""
    config = zenoh.Config()
    config.insert_json5("listen/endpoints", json.dumps([]))
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as opened:
        yield opened


def test_players_that_start_together_agree_and_a_later_one_takes_the_running_clock(
    session: zenoh.Session,
) -> None:
    own = [clock(5.0, 100.0, 60.0), clock(4.0, 101.0, 50.0)]
    with ThreadPoolExecutor(2) as threads:
        agreed = list(threads.map(lambda each: agree(session, "bus-7", each), own))
    # the queryables live as long as they are held
    assert [found for found, _ in agreed] == [clock(4.0, 101.0, 60.0)] * 2
    later, _ = agree(session, "bus-7", clock(0.0, 200.0, 90.0))
    assert later == msgspec.structs.replace(clock(4.0, 101.0, 60.0), running=later.running)
    elsewhere, _ = agree(session, "bus-8", clock(0.0, 200.0, 90.0))
    assert elsewhere == clock(0.0, 200.0, 90.0)
