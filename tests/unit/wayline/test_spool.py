"""The spool: in order, bounded, and nothing lost uncounted."""

from wayline.core import Record
from wayline.spool import Spool, Waiting


class Number(Record, frozen=True):
    n: int


def waiting(n: int, vehicle_id: str = "bus-1") -> Waiting:
    return Waiting(vehicle_id, Number(n=n))


def emptied(spool: Spool) -> list[Waiting]:
    found = []
    while (first := spool.first()) is not None:
        spool.take_out(first)
        found.append(first)
    return found


def test_records_come_out_in_the_order_in_which_they_went_in() -> None:
    spool, records = Spool(), [waiting(n) for n in range(5)]
    for each in records:
        spool.put(each)
    assert (len(spool), emptied(spool), len(spool)) == (5, records, 0)


def test_the_oldest_makes_room_and_is_counted() -> None:
    spool, records = Spool(3), [waiting(n) for n in range(5)]
    for each in records:
        spool.put(each)
    assert (emptied(spool), spool.lost) == (records[2:], 2)


def test_of_each_vehicle_the_newest_waits() -> None:
    spool = Spool(2, newest_only=True)
    for each in (waiting(1, "a"), waiting(2, "b"), waiting(3, "a")):
        spool.put(each)
    assert (emptied(spool), spool.lost) == ([waiting(3, "a"), waiting(2, "b")], 0)


def test_what_replaced_a_record_that_is_being_written_stays() -> None:
    spool = Spool(newest_only=True)
    spool.put(waiting(1))
    writing = spool.first()
    assert writing is not None
    spool.put(waiting(2))
    spool.take_out(writing)
    assert emptied(spool) == [waiting(2)]


def test_equal_records_are_two() -> None:
    spool = Spool()
    spool.put(waiting(1))
    spool.put(waiting(1))
    assert len(emptied(spool)) == 2
