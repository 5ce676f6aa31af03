"""What has been learned is kept key by key, and can be learned anew from the raw rows."""

from collections.abc import Iterator
from zoneinfo import ZoneInfo

import msgspec
import pytest
import sqlalchemy as sa

from unit.eta.route_drives import SECOND_NS, START_NS
from wayline.database import open_database
from wayline_eta.experience import Experience
from wayline_eta.legs import Leg
from wayline_eta.records import Came, Known, Learned, Taken
from wayline_eta.store import EtaTables
from wayline_eta.tables import KNOWN, TAKEN

BERLIN = ZoneInfo("Europe/Berlin")
HOUR_NS = 3_600 * SECOND_NS
LEG = Leg("r|s0>s1", 100.0)


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, "wayline_eta")
    yield opened
    opened.dispose()


def runs() -> list[Learned]:
    """Forty, an hour apart, slower by and by."""
    return [
        Learned(
            taken=Taken(
                START_NS + run * HOUR_NS, LEG.key, "r", 100.0, 150.0 + run, "r|s1", 20.0 + run % 7
            ),
            came=(Came(START_NS + run * HOUR_NS - SECOND_NS, "r|s1", "r", 0, 0.5),),
        )
        for run in range(40)
    ]


def started(engine: sa.Engine) -> Experience:
    """What a process knows that starts on a database."""
    experience = Experience(BERLIN, is_timetable=False)
    for each in EtaTables(engine, BERLIN).look():
        if isinstance(each, Known):
            experience.recall(each)
    return experience


def expected(experience: Experience) -> tuple[object, ...]:
    later_ns = START_NS + 100 * HOUR_NS
    return (
        experience.travel(LEG, "r", later_ns),
        experience.dwell("r|s1", "r", 0.0),
        experience.plan_off("r", later_ns),
    )


def test_a_start_knows_what_the_process_before_it_knew(engine: sa.Engine) -> None:
    before, tables = Experience(BERLIN, is_timetable=False), EtaTables(engine, BERLIN)
    tables.look()
    for learned in runs():
        before.learn(learned.taken, is_now=False)
        tables.save("bus-1", learned)
    for again in runs():
        tables.save("bus-1", again)
    for told, known in zip(expected(started(engine)), expected(before), strict=True):
        assert told == pytest.approx(known)


def test_what_another_model_has_left_is_learned_anew(engine: sa.Engine) -> None:
    tables = EtaTables(engine, BERLIN)
    tables.look()
    for learned in runs():
        tables.save("bus-1", learned)
    right = expected(started(engine))
    with engine.begin() as connection:
        connection.execute(sa.update(KNOWN).values(weight=0.5, mean=3.0))
    for told, known in zip(expected(started(engine)), right, strict=True):
        assert told == pytest.approx(known)


def test_what_was_saved_before_the_first_look_counts_once(engine: sa.Engine) -> None:
    """As when the database was away at the start."""
    tables, only = EtaTables(engine, BERLIN), runs()[0]
    tables.save("bus-1", only)
    tables.look()
    [leg] = [
        each
        for each in EtaTables(engine, BERLIN).look()
        if isinstance(each, Known) and each.key == f"leg\t{LEG.key}"
    ]
    assert leg.weight == 1.0


def test_a_breakdown_is_kept_as_such_and_teaches_nothing_then_or_anew(engine: sa.Engine) -> None:
    tables = EtaTables(engine, BERLIN)
    for learned in runs():
        tables.save("bus-7", learned)
    before = expected(started(engine))
    broken = msgspec.structs.replace(
        runs()[0].taken,
        t_ns=START_NS + 50 * HOUR_NS,
        travel_s=900.0,
        dwell_s=700.0,
        disruption="breakdown",
    )
    tables.save("bus-7", Learned(taken=broken))
    assert expected(started(engine)) == before
    with engine.begin() as connection:
        connection.execute(sa.delete(KNOWN))
        kept = connection.execute(sa.select(TAKEN.c.disruption)).scalars().all()
    assert expected(started(engine)) == before
    assert [each for each in kept if each is not None] == ["breakdown"]
