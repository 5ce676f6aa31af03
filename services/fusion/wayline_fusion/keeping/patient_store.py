"""A store that the vehicle can do without: a full disk costs calibration, not poses."""

import logging
from collections.abc import Sequence

import msgspec
import sqlalchemy as sa

from wayline.core import Record
from wayline_fusion.keeping.records import Saved
from wayline_fusion.keeping.store import FusionStore

log = logging.getLogger("wayline")


class PatientStore:
    """Says once that a database cannot be used, and once that it can again."""

    def __init__(self, store: FusionStore) -> None:
        self._store = store
        self._failing = False

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Keep a record if the database can."""
        try:
            answers = self._store.save(record)
        except sa.exc.DBAPIError as error:
            self._tell(error)
            return ()
        if self._failing:
            log.info("calibration is kept again")
        self._failing = False
        return answers

    def load(self) -> Saved | None:
        """What was kept; nothing where the database cannot tell."""
        try:
            return self._store.load()
        except sa.exc.DBAPIError as error:
            self._tell(error)
            return None

    def _tell(self, error: sa.exc.DBAPIError) -> None:
        if not self._failing:
            log.warning("calibration is not kept: %s", error.orig)
        self._failing = True
