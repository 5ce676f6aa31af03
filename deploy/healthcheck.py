"""Asks the service of this container how it is: exit status 0 only where /livez says that it turns.

What a service lacks (/readyz) does not get better by starting it anew.

SERVICE=eta python healthcheck.py [wayline.toml]
"""

import os
import ssl
import sys
import urllib.error
import urllib.request
from pathlib import Path

from wayline.settings import load_settings

CONFIG = "/etc/wayline/wayline.toml"
TIMEOUT_S = 4.0


def address(config: Path, service: str) -> str:
    """Where the service answers, from inside."""
    http = load_settings(config).http_of(service)
    return f"{'https' if http.tls_cert else 'http'}://127.0.0.1:{http.port}/livez"


def is_alive(url: str) -> bool:
    """Whether the answer is 200."""
    # the certificate is another name's, and nothing secret is sent
    context = ssl._create_unverified_context()  # noqa: S323
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT_S, context=context) as answer:  # noqa: S310
            return bool(answer.status == 200)
    except (OSError, urllib.error.URLError):
        return False


if __name__ == "__main__":
    path = Path(sys.argv[1] if len(sys.argv) > 1 else CONFIG)
    sys.exit(0 if is_alive(address(path, os.environ["SERVICE"])) else 1)
