"""Asks an agency's address for its feed: with its key, within bounds of time and size."""

import logging
import time

import httpx2

from wayline.live_sources import LiveAvl

AGENT = "wayline"
TIMEOUT_S = 10.0
"""For a connection, and between two pieces of an answer."""
WHOLE_S = 30.0
"""For a whole answer."""
SIZE_MAX_BYTES = 64 * 1024 * 1024
REDIRECTS_MAX = 3
RETRY_AFTER_MAX_S = 3_600.0
NOT_MODIFIED = 304
VALIDATORS = (("If-None-Match", "ETag"), ("If-Modified-Since", "Last-Modified"))
"""What is asked with, and what an answer tells for it."""

# at its default level it would write down addresses, and with them a key that is part of one
logging.getLogger("httpx2").setLevel(logging.WARNING)


class FeedError(Exception):
    """Why an answer is of no use; says nothing that is secret."""

    def __init__(self, what: str, retry_after_s: float = 0.0) -> None:
        super().__init__(what)
        self.retry_after_s = retry_after_s
        """The server asks to be left alone for so long."""


class RealtimeClient:
    """One address. A key goes to its host only."""

    def __init__(self, source: LiveAvl, key: str | None) -> None:
        self._source = source
        self._key = key
        self._client = httpx2.Client(timeout=TIMEOUT_S, headers={"User-Agent": AGENT})
        self._validators: dict[str, str] = {}

    def close(self) -> None:
        """Let the connection go."""
        self._client.close()

    def fetched(self) -> bytes | None:
        """The feed's bytes; None where it has not changed since. Raises FeedError."""
        try:
            return self._fetched()
        except httpx2.TimeoutException:
            raise FeedError("does not answer") from None
        except httpx2.HTTPError as error:
            # its own words may hold the address, and with it the key
            raise FeedError(f"cannot be asked ({type(error).__name__})") from None

    def _fetched(self) -> bytes | None:
        url, headers = httpx2.URL(self._source.url), dict(self._validators)
        if self._key is not None and self._source.api_key_header is not None:
            headers[self._source.api_key_header] = self._key
        elif self._key is not None and self._source.api_key_parameter is not None:
            url = url.copy_merge_params({self._source.api_key_parameter: self._key})
        for _ in range(REDIRECTS_MAX + 1):
            with self._client.stream("GET", url, headers=headers) as answer:
                if answer.next_request is None:
                    return self._body(answer)
                target = answer.next_request.url
            if _origin(target) != _origin(url):
                raise FeedError(f"redirects to {target.host}; set url to where it is now")
            url = target
        raise FeedError("redirects without end")

    def _body(self, answer: httpx2.Response) -> bytes | None:
        if answer.status_code == NOT_MODIFIED:
            return None
        if not answer.is_success:
            raise FeedError(f"answers {answer.status_code}", _retry_after_s(answer))
        until_s, body = time.monotonic() + WHOLE_S, bytearray()
        for piece in answer.iter_bytes():
            body += piece
            if len(body) > SIZE_MAX_BYTES:
                raise FeedError(f"answers with more than {SIZE_MAX_BYTES >> 20} MB")
            if time.monotonic() > until_s:
                raise FeedError(f"takes longer than {WHOLE_S:.0f} s to answer")
        told = answer.headers
        self._validators = {asked: told[name] for asked, name in VALIDATORS if name in told}
        return bytes(body)


def _origin(url: httpx2.URL) -> tuple[str, str, int | None]:
    return url.scheme, url.host, url.port


def _retry_after_s(answer: httpx2.Response) -> float:
    told = answer.headers.get("Retry-After", "")
    return min(float(told), RETRY_AFTER_MAX_S) if told.isdigit() else 0.0
