"""Answers to Zenoh queries: the same functions that answer over HTTP."""

from collections.abc import Callable, Iterator, Mapping

import msgspec
import zenoh

from wayline.codec import ENCODING
from wayline.digits import rounded
from wayline.query_error import QueryError

Answer = Callable[[str, Mapping[str, str]], msgspec.Struct]
"""From the vehicle of a query's key and its parameters to the answer. Raises QueryError."""


def replier(answer: Answer) -> Callable[[zenoh.Query], None]:
    """A queryable's callback: the answer as JSON, or an error reply that says what is wrong."""

    def reply(query: zenoh.Query) -> None:
        with query:
            vehicle_id = str(query.key_expr).split("/")[2]
            parameters = dict(_pairs(str(query.parameters)))
            try:
                payload = msgspec.json.encode(rounded(answer(vehicle_id, parameters)))
            except QueryError as error:
                query.reply_err(msgspec.json.encode({"detail": str(error)}))
            else:
                query.reply(query.key_expr, payload, encoding=ENCODING)

    return reply


def _pairs(parameters: str) -> Iterator[tuple[str, str]]:
    """`a=1;b=2` as Zenoh's selectors carry it."""
    for part in filter(None, parameters.split(";")):
        name, _, value = part.partition("=")
        yield name, value
