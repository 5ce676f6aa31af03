"""Mutual TLS with real sessions: who a vehicle is, its certificate says, not its password alone."""

import datetime as dt
import json
import queue
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
import trustme
import zenoh

from wayline.bus import Publishers, Subscription, client_config
from wayline.settings import BusSettings
from wayline_cli.access import access_control

SERVER = Path(__file__).parents[2] / "deploy/zenoh/server.json5"
PASSWORDS = {"bus-1": "one", "bus-2": "two", "_services": "three"}
WAIT_S = 10.0


class Authority:
    """Certificates in a folder, by name: those of a fleet, and of who would like to be in it."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._ca = folder, trustme.CA()
        self.root = folder / "ca.pem"
        self._ca.cert_pem.write_to_path(str(self.root))
        now, day = dt.datetime.now(dt.UTC), dt.timedelta(days=1)
        for name in ("router", "_services", "bus-1", "bus-2"):
            self._issue(self._ca, name, name, now + day)
        self._issue(trustme.CA(), "foreign", "bus-1", now + day)
        self._issue(self._ca, "expired", "bus-1", now - day)

    def files(self, name: str) -> tuple[str, str]:
        """Certificate chain and private key."""
        return str(self.folder / f"{name}.pem"), str(self.folder / f"{name}.key")

    def _issue(self, ca: trustme.CA, name: str, common_name: str, until: dt.datetime) -> None:
        issued = ca.issue_cert(
            "localhost",
            "127.0.0.1",
            common_name=common_name,
            not_before=until - dt.timedelta(days=9),
            not_after=until,
        )
        chain, key = self.files(name)
        Path(chain).write_bytes(b"".join(part.bytes() for part in issued.cert_chain_pems))
        issued.private_key_pem.write_to_path(key)


class Bus:
    """The server's router with its certificate, and sessions on it."""

    def __init__(self, folder: Path) -> None:
        self.authority = Authority(folder)
        with socket.create_server(("127.0.0.1", 0)) as listening:
            self.endpoint = f"tls/127.0.0.1:{listening.getsockname()[1]}"
        users = folder / "users"
        users.write_text("".join(f"{user}:{word}\n" for user, word in PASSWORDS.items()))
        certificate, key = self.authority.files("router")
        config = zenoh.Config.from_file(str(SERVER))
        tls = "transport/link/tls"
        entries: dict[str, object] = {
            "listen/endpoints": [self.endpoint],
            "transport/auth/usrpwd/dictionary_file": str(users),
            f"{tls}/root_ca_certificate": str(self.authority.root),
            f"{tls}/listen_certificate": certificate,
            f"{tls}/listen_private_key": key,
            f"{tls}/enable_mtls": True,
            "access_control": access_control(["bus-1", "bus-2"], certificates=True),
        }
        for entry, value in entries.items():
            config.insert_json5(entry, json.dumps(value))
        self._sessions = [zenoh.open(config)]

    def connect(self, user: str, certificate: str | None) -> zenoh.Session:
        """A service's session; raises where the router refuses it."""
        cert, key = (None, None) if certificate is None else self.authority.files(certificate)
        settings = BusSettings(
            connect=(self.endpoint,),
            user=user,
            password=PASSWORDS[user],
            tls_root_ca=str(self.authority.root),
            tls_cert=cert,
            tls_key=key,
        )
        config = client_config(settings)
        # a service waits for its router; here a refusal has to end
        config.insert_json5("connect/timeout_ms", "1500")
        config.insert_json5("connect/exit_on_failure", "true")
        session = zenoh.open(config)
        self._sessions.append(session)
        return session

    def close(self) -> None:
        """Clients first, so that none of them looks for its router."""
        for session in reversed(self._sessions):
            session.close()  # type: ignore[no-untyped-call]


@pytest.fixture
def bus(tmp_path: Path) -> Iterator[Bus]:
    bus = Bus(tmp_path)
    yield bus
    bus.close()


@pytest.mark.parametrize("certificate", ["foreign", "expired", None])
def test_without_a_good_certificate_a_password_opens_nothing(
    bus: Bus, certificate: str | None
) -> None:
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        bus.connect("bus-1", certificate)


def test_the_right_certificate_speaks_for_its_vehicle_and_anothers_does_not(bus: Bus) -> None:
    heard: queue.Queue[str] = queue.Queue()
    subscription = Subscription(
        bus.connect("_services", "_services"),
        ["*"],
        ["pose"],
        lambda key, payload: heard.put(payload.decode()),
    )
    for user, certificate in (("bus-1", "bus-2"), ("bus-2", "bus-1"), ("bus-1", "bus-1")):
        publishers = Publishers(bus.connect(user, certificate))
        publishers.put(user, "pose", "fusion", f"{user} by {certificate}".encode())
    assert heard.get(timeout=WAIT_S) == "bus-1 by bus-1"
    assert heard.empty()
    subscription.close()
