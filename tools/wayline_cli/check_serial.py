"""The doctor's check of receivers on serial lines."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from serial.tools import list_ports

from wayline.settings import LiveNmea
from wayline_cli.check import Check, fine, wrong

SERIAL = "serial://"

SerialState = Callable[[str], str | None]
"""What is wrong with a device, None where nothing is."""
Devices = Callable[[], list[str]]


def check_receivers(
    receivers: Sequence[LiveNmea], state: SerialState, devices: Devices
) -> list[Check]:
    """Receivers on serial lines; those on the network come and go by themselves."""
    return [
        _check_line(receiver.url.removeprefix(SERIAL), state, devices)
        for receiver in receivers
        if receiver.url.startswith(SERIAL)
    ]


def _check_line(device: str, state: SerialState, devices: Devices) -> Check:
    subject, problem = f"receiver {device}", state(device)
    if problem is None:
        return fine(subject, "there, may be read and written")
    if "not there" in problem:
        present = ", ".join(devices()) or "none"
        return wrong(subject, problem, f"plug it in or correct [[nmea]] url (present: {present})")
    return wrong(subject, problem, "add the services' user to the device's group (dialout)")


def serial_state(device: str) -> str | None:
    """Whether a serial device is there and may be used."""
    if not Path(device).exists():
        return "is not there"
    return None if os.access(device, os.R_OK | os.W_OK) else "may not be read and written"


def serial_devices() -> list[str]:
    """Serial lines that this machine has."""
    return sorted(port.device for port in list_ports.comports())
