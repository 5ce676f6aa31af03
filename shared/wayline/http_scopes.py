"""Pure: what a token may do, and which token does."""

import hashlib
import hmac
from collections.abc import Iterable
from enum import IntEnum

from wayline.http_settings import KeptToken


class Scope(IntEnum):
    """What somebody may do; who may more, may less too."""

    PUBLIC = 1
    """Ask for arrivals, routes, stops and GTFS-Realtime."""
    READ = 2
    """Ask for everything."""
    WRITE = 3
    """Change something."""


class Keyring:
    """The tokens that are known, by their SHA-256 alone. A plain one may write."""

    def __init__(self, tokens: Iterable[str | KeptToken]) -> None:
        self._scopes = [_known(token) for token in tokens]

    def scope_of(self, token: str) -> Scope | None:
        """What a token may do; None for an unknown one.

        Every known hash is compared, each in a time that does not tell how nearly it fits.
        """
        digest = _digest(token)
        fits = [scope for known, scope in self._scopes if hmac.compare_digest(known, digest)]
        return max(fits, default=None)


def _known(token: str | KeptToken) -> tuple[bytes, Scope]:
    if isinstance(token, KeptToken):
        return bytes.fromhex(token.sha256), Scope[token.scope.upper()]
    return _digest(token), Scope.WRITE


def _digest(token: str) -> bytes:
    # tokens are long and random, so that no slow hash is needed to keep them from being guessed
    return hashlib.sha256(token.encode()).digest()
