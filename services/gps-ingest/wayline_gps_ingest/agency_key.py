"""The key that an agency has given for its feed: from the environment, never from a file."""

from collections.abc import Mapping

from wayline.errors import InputError
from wayline.live_sources import LiveAvl


def key_of(avl: LiveAvl, environment: Mapping[str, str]) -> str | None:
    """The key; None where the feed needs none. Raises InputError where it is not there."""
    name = avl.api_key_env
    if name is None:
        return None
    if (avl.api_key_header is None) == (avl.api_key_parameter is None):
        mend = "name either api_key_header or api_key_parameter"
        raise InputError("configuration", f"[[avl]] does not say how to send {name}", mend)
    if key := environment.get(name):
        return key
    raise InputError("environment", f"{name} is not set", "set it to the agency's key")
