"""Pure: finds messages and signals over several databases, or says what there is instead."""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from cantools.database.can import Database
from cantools.database.can import Message as DbcMessage

from wayline.drive import Places
from wayline.errors import InputError


class Part(NamedTuple):
    """A mapping with its databases: of a `[[can]]` itself, or of a profile."""

    where: str
    """The file that holds it, for errors."""
    signals: Mapping[str, Places]
    j1939: bool
    databases: Sequence[Database]


class Known(NamedTuple):
    """A message of a database, and whether its frames are told by their PGN."""

    message: DbcMessage
    j1939: bool


class Directory:
    """Messages by name; where several databases have one of a name, the first database's.

    A name that one database has for several identifiers tells nothing: who maps it is refused.
    """

    def __init__(self, parts: Sequence[Part]) -> None:
        self._where = parts[0].where
        self._messages: dict[str, Known] = {}
        self._namesakes: dict[str, list[DbcMessage]] = {}
        for part in parts:
            for database in part.databases:
                for name, messages in _by_name(database).items():
                    if name not in self._messages:
                        self._messages[name] = Known(messages[0], part.j1939)
                        self._namesakes[name] = messages

    def message(self, name: str, quantity: str) -> Known:
        """A message that a quantity names."""
        if len(self._namesakes.get(name, ())) > 1:
            numbers = ", ".join(f"{each.frame_id:X}h" for each in self._namesakes[name])
            raise InputError(
                self._where,
                f'"{quantity}" names message {name}, of which a dbc has several ({numbers})',
                "rename all but one of them in the dbc",
            )
        if name in self._messages:
            return self._messages[name]
        raise InputError(
            self._where,
            f'"{quantity}" names message {name}, which no dbc of this [[can]] has',
            did_you_mean(name, self._messages),
        )

    def check_signal(self, message: DbcMessage, name: str, quantity: str) -> None:
        """Refuse a signal that a message does not have."""
        names = [signal.name for signal in message.signals]
        if name not in names:
            raise InputError(
                self._where,
                f'"{quantity}" names signal {name}, which message {message.name} does not have',
                did_you_mean(name, names),
            )


def _by_name(database: Database) -> dict[str, list[DbcMessage]]:
    named: dict[str, list[DbcMessage]] = {}
    for message in database.messages:
        named.setdefault(message.name, []).append(message)
    return named


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Known names like a misspelt one, or some of the known names where none is like it."""
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=3, cutoff=0.5) or names[:8]
    return f"did you mean {', '.join(near)}?" if near else "name a dbc that has it"
