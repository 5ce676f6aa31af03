"""Pure: what one check of `wayline doctor` found."""

from collections.abc import Callable, Iterable
from enum import Enum
from typing import NamedTuple

from wayline.errors import InputError


class Mark(Enum):
    """How a check went."""

    FINE = "fine"
    NOTE = "note"
    """Works, but somebody may miss something."""
    WRONG = "wrong"


class Check(NamedTuple):
    """One line of the doctor's table."""

    subject: str
    mark: Mark
    finding: str
    mend: str = ""


def fine(subject: str, finding: str) -> Check:
    """Nothing to do."""
    return Check(subject, Mark.FINE, finding)


def note(subject: str, finding: str, mend: str) -> Check:
    """Nothing broken."""
    return Check(subject, Mark.NOTE, finding, mend)


def wrong(subject: str, finding: str, mend: str) -> Check:
    """Something to mend."""
    return Check(subject, Mark.WRONG, finding, mend)


def attempted(subject: str, finding: Callable[[], str]) -> Check:
    """Fine with what a call finds, wrong with what its InputError says."""
    try:
        return fine(subject, finding())
    except InputError as error:
        return wrong(subject, f"{error.where}: {error.what}", error.mend)


def is_well(checks: Iterable[Check]) -> bool:
    """Whether nothing is wrong."""
    return all(check.mark is not Mark.WRONG for check in checks)
