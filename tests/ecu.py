"""A car's control unit that answers OBD-II on a virtual bus."""

import threading

import can

SUPPORTED = {0x0C, 0x0D, 0x20, 0x33, 0x40, 0x60, 0x62, 0x63}
VALUES = {
    0x0C: bytes((0x1F, 0x40)),  # 2000 rpm
    0x0D: bytes((90,)),  # 25 m/s
    0x33: bytes((98,)),  # kPa
    0x62: bytes((165,)),  # 40 %
    0x63: bytes((0x01, 0x2C)),  # 300 Nm
}


def support(first: int) -> bytes:
    """The reply to 00, 20, 40 or 60."""
    bits = sum(1 << (32 - (pid - first)) for pid in SUPPORTED if first < pid <= first + 32)
    return bits.to_bytes(4, "big")


class Ecu:
    """Answers service 01 in single frames while `speaks`; `refuses` values on request."""

    def __init__(self, channel: str, *, extended: bool = False) -> None:
        self._bus = can.Bus(interface="virtual", channel=channel)
        self._extended = extended
        self._stop = threading.Event()
        self.speaks = True
        self.refuses: dict[int, int] = {}
        self.asked: list[bytes] = []
        self._thread = threading.Thread(target=self._answer, daemon=True)
        self._thread.start()

    @property
    def _requests(self) -> tuple[int, int]:
        return (0x18DB33F1, 0x18DA10F1) if self._extended else (0x7DF, 0x7E0)

    def _answer(self) -> None:
        while not self._stop.is_set():
            got = self._bus.recv(0.05)
            if got is None or got.is_extended_id != self._extended:
                continue
            if got.arbitration_id in self._requests and self.speaks:
                self.asked.append(bytes(got.data[1 : 1 + got.data[0]]))
                self._say(self._reply(*self.asked[-1][:2]))

    def _reply(self, service: int, pid: int) -> bytes:
        if service != 1 or pid in self.refuses:
            return bytes((0x7F, service, self.refuses.get(pid, 0x11)))
        value = support(pid) if pid % 32 == 0 else VALUES[pid]
        return bytes((0x41, pid)) + value

    def _say(self, reply: bytes) -> None:
        identifier = 0x18DAF110 if self._extended else 0x7E8
        data = bytes((len(reply),)) + reply
        self._bus.send(
            can.Message(
                arbitration_id=identifier,
                data=data.ljust(8, b"\xaa"),
                is_extended_id=self._extended,
            )
        )

    def close(self) -> None:
        """Unplug it."""
        self._stop.set()
        self._thread.join()
        self._bus.shutdown()
