"""The doctor's checks of what strangers meet: certificates, tokens, the addresses listened on."""

import datetime as dt
import ipaddress
from collections.abc import Iterator
from pathlib import Path

from cryptography import x509

from wayline.errors import InputError
from wayline.http_settings import MAKE_TOKEN, HttpSettings
from wayline.settings import Settings
from wayline_cli.check import Check, Mark, attempted, fine, note

ENDS_SOON = dt.timedelta(days=30)
TOKEN_LENGTH_MIN = 32
"""A random token of 24 bytes in base64: nobody guesses it, which is why it is hashed only once."""


def check_doors(settings: Settings, now: dt.datetime) -> list[Check]:
    """A line for each certificate, for tokens, and for an address that the world can reach."""
    certificates = (
        ("http.tls_cert", settings.http.tls_cert),
        ("bus.tls_cert", settings.bus.tls_cert),
        ("bus.tls_root_ca", settings.bus.tls_root_ca),
    )
    checks = [
        _certificate(option, Path(path), now) for option, path in certificates if path is not None
    ]
    return [*checks, *_tokens(settings.http), *_address(settings.http)]


def _certificate(option: str, path: Path, now: dt.datetime) -> Check:
    subject = f"certificate {option}"
    check = attempted(subject, lambda: f"{path} is good until {_end_of(path, now):%Y-%m-%d}")
    if check.mark is Mark.FINE and _end_of(path, now) - now < ENDS_SOON:
        return note(subject, check.finding, "have a new one before it ends")
    return check


def _end_of(path: Path, now: dt.datetime) -> dt.datetime:
    """When a file's first certificate ends. Raises InputError for one that is not good now."""
    try:
        certificate = x509.load_pem_x509_certificates(path.read_bytes())[0]
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})", "check it") from None
    except ValueError:
        raise InputError(str(path), "holds no PEM certificate", "give one") from None
    begins, ends = certificate.not_valid_before_utc, certificate.not_valid_after_utc
    if not begins <= now < ends:
        what = f"is good from {begins:%Y-%m-%d} to {ends:%Y-%m-%d} only"
        raise InputError(str(path), what, "have a new one, or mend the clock")
    return ends


def _tokens(http: HttpSettings) -> Iterator[Check]:
    plain = [token for token in http.tokens if isinstance(token, str)]
    if any(len(token) < TOKEN_LENGTH_MIN for token in plain):
        finding = f"a token of http.tokens has fewer than {TOKEN_LENGTH_MIN} characters"
        yield note("tokens", finding, f"make one by {MAKE_TOKEN}")
    elif http.tokens:
        yield fine("tokens", f"{len(http.tokens)}, of which {len(plain)} may change things")


def _address(http: HttpSettings) -> Iterator[Check]:
    try:
        is_every = ipaddress.ip_address(http.host).is_unspecified
    except ValueError:
        return
    if is_every:
        finding = f"HTTP listens on {http.host}: every network of this machine reaches it"
        yield note("address", finding, "name one address, or let a firewall say who may")
