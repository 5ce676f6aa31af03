"""A history in a database, with clocks that stand where a test puts them."""

from collections.abc import Iterable

import sqlalchemy as sa

from builders import START_NS
from unit.history.driven import VEHICLE, kept_of
from wayline.database import open_database
from wayline.messages import Message
from wayline_history.housekeeping import Housekeeping, Limits
from wayline_history.reading import HistoryReader
from wayline_history.store import HistoryStore

FOREVER = Limits(days=1e6, megabytes=1e6, thins_after_s=1e12)


class History:
    """A store, its reader and its housekeeping on one engine; `now_s` is the host's clock."""

    def __init__(self, url: str) -> None:
        self.engine: sa.Engine = open_database(url, "wayline_history")
        self.now_s = START_NS * 1e-9
        self.store = HistoryStore(self.engine, lambda: self.now_s)
        self.reader = HistoryReader(self.engine)

    def keep(self, messages: Iterable[Message], vehicle_id: str = VEHICLE) -> None:
        """Keep what a vehicle's core makes of messages."""
        self.store.save((vehicle_id, piece) for piece in kept_of(messages).pieces)

    def housekeeping(self, limits: Limits = FOREVER) -> Housekeeping:
        return Housekeeping(self.engine, limits, lambda: self.now_s)

    def times_s(
        self, vehicle_id: str = VEHICLE, from_s: float = 0, to_s: float = 1e6
    ) -> list[float]:
        """Of the poses, in seconds after the tests' epoch."""
        span = START_NS + round(from_s * 1e9), START_NS + round(to_s * 1e9)
        chunks = self.reader.rows(vehicle_id, "fused", *span)
        return [
            (t_us * 1000 - START_NS) * 1e-9 for chunk in chunks for t_us in chunk.times_us.tolist()
        ]

    def chunk_count(self) -> int:
        with self.engine.connect() as connection:
            count = connection.exec_driver_sql("SELECT count(*) FROM history_chunk").scalar()
        assert isinstance(count, int)
        return count
