"""The doctor's check of serial lines: the configured receivers', and what else is plugged in."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from serial.tools import list_ports

from wayline.live_sources import LiveNmea, LiveRaw
from wayline_cli.check import Check, fine, note, wrong
from wayline_cli.listen_serial import Hearing
from wayline_gps_ingest.links import UBX_ONLY

SERIAL = "serial://"

Live = LiveNmea | LiveRaw
Listen = Callable[[Live], Hearing]
Devices = Callable[[], list[str]]


def check_receivers(receivers: Sequence[Live], listen: Listen, devices: Devices) -> list[Check]:
    """Receivers on serial lines, all at once; those on the network come and go by themselves."""
    configured = [each for each in receivers if each.url.startswith(SERIAL)]
    known = {Path(device_of(each)).resolve() for each in configured}
    present = devices()
    others = [
        LiveNmea(url=f"{SERIAL}{device}")
        for device in present
        if Path(device).resolve() not in known
    ]
    lines: list[Live] = [*configured, *others]
    if not lines:
        return []
    with ThreadPoolExecutor(len(lines)) as threads:
        heard = iter(list(threads.map(listen, lines)))
    return [
        *(_configured(each, next(heard), present) for each in configured),
        *(_other(each, next(heard)) for each in others),
    ]


def device_of(receiver: Live) -> str:
    """The device that a URL names."""
    return receiver.url.removeprefix(SERIAL).partition("?")[0]


def _configured(receiver: Live, heard: Hearing, present: Sequence[str]) -> Check:
    subject = f"receiver {device_of(receiver)}"
    problem = heard.problem
    if problem is None:
        is_raw = isinstance(receiver, LiveRaw)
        return _measuring(subject, heard) if is_raw else _speaking(subject, heard)
    if "in use" in problem:
        return fine(subject, problem)
    if "is not there" in problem:
        there = ", ".join(present) or "none"
        return wrong(subject, problem, f"plug it in or correct its url (present: {there})")
    if "dialout" in problem:
        return wrong(subject, problem, "add the services' user to the device's group (dialout)")
    return wrong(subject, _with_note(problem, heard), _mend(heard))


def _other(receiver: LiveNmea, heard: Hearing) -> Check:
    """A device that no [[nmea]] names: perhaps the receiver that is looked for, perhaps a modem."""
    subject = f"serial line {device_of(receiver)}"
    if heard.problem is None:
        return _speaking(subject, heard, unused=f'give [[nmea]] url = "{receiver.url}"')
    return fine(subject, f"{_with_note(heard.problem, heard)}; no [[nmea]] names it")


def _speaking(subject: str, heard: Hearing, unused: str = "") -> Check:
    found = f"{heard.note}: {' '.join(heard.sentences)}, {'a fix' if heard.has_fix else 'no fix'}"
    mend = "" if heard.has_fix else "give the antenna a view of the sky and some minutes"
    mends = "; ".join(filter(None, (unused, mend)))
    return note(subject, found, mends) if mends else fine(subject, found)


def _measuring(subject: str, heard: Hearing) -> Check:
    """A raw source whose messages are understood."""
    found = f"{heard.note}: {', '.join(heard.sentences)}"
    if heard.has_fix:
        return fine(subject, found)
    mend = "switch RXM-RAWX and RXM-SFRBX on (docs/connect-a-receiver.md)"
    return wrong(subject, f"{found}, no RXM-RAWX", mend)


def _with_note(problem: str, heard: Hearing) -> str:
    return f"{problem} ({heard.note})" if heard.note else problem


def _mend(heard: Hearing) -> str:
    if UBX_ONLY in (heard.note or ""):
        return "switch its NMEA output on, or put gpsd before it (docs/connect-a-receiver.md)"
    return "check power, wiring and baud rate (docs/connect-a-receiver.md)"


def serial_devices() -> list[str]:
    """Serial lines that this machine has."""
    return sorted(port.device for port in list_ports.comports())
