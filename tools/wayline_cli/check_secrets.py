"""The doctor's check of files that hold passwords, tokens or keys: who may read them."""

import stat
from collections.abc import Iterator
from pathlib import Path

from wayline.settings import Settings
from wayline_cli.check import Check, fine, note


def check_secrets(config: Path, settings: Settings) -> list[Check]:
    """A line for each file with secrets; `settings` are what the file says by itself."""
    held = ", ".join(secrets_in(settings))
    keys = {"http.tls_key": settings.http.tls_key, "bus.tls_key": settings.bus.tls_key}
    files = [(config, held)] if held else []
    files += [(Path(path), name) for name, path in keys.items() if path and Path(path).is_file()]
    return [_readers(path, what) for path, what in files]


def secrets_in(settings: Settings) -> Iterator[str]:
    """The names of the options that are secrets and set."""
    if settings.bus.password:
        yield "bus.password"
    if settings.http.tokens:
        yield "http.tokens"
    url = settings.database_url or ""
    user = url.partition("://")[2].rpartition("@")[0]
    if ":" in user or "password=" in url:
        yield "database_url"


def _readers(path: Path, what: str) -> Check:
    mode = stat.S_IMODE(path.stat().st_mode)
    if not mode & stat.S_IROTH:
        return fine("secrets", f"{path} ({what}) is not for everybody")
    finding = f"everybody on this machine may read {path} (mode {mode:o}), which holds {what}"
    return note("secrets", finding, f"chmod o= {path}")
