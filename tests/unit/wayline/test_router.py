"""The built-in router asks no password, so it must not be reached from elsewhere."""

import json

import pytest

from wayline.errors import InputError
from wayline.router import is_local, router_config
from wayline.settings import BusSettings


@pytest.mark.parametrize(
    ("endpoint", "local"),
    [
        ("tcp/127.0.0.1:7447", True),
        ("tcp/[::1]:7447", True),
        ("tls/localhost:7447", True),
        ("tcp/0.0.0.0:7447", False),
        ("tcp/[::]:7447", False),
        ("tcp/192.168.1.2:7447", False),
        ("tcp/127.0.0.1.example.org:7447", False),
        ("tcp/10.0.0.1:7447#tcp/127.0.0.1:7447", False),
        ("nonsense", False),
    ],
)
def test_the_built_in_router_listens_on_loopback_only(endpoint: str, local: bool) -> None:
    assert is_local(endpoint) is local
    settings = BusSettings(connect=(endpoint,))
    if local:
        config = router_config(settings)
        assert json.loads(config.get_json("listen/endpoints")) == [endpoint]
        assert json.loads(config.get_json("connect/endpoints")) == []
    else:
        with pytest.raises(InputError, match="is not on this machine alone"):
            router_config(settings)
