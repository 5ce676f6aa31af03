"""A program that floods the bus as one vehicle: ENDPOINT VEHICLE SECONDS RATE_HZ PAYLOAD_BYTES.

RATE_HZ 0 is as fast as it goes. The last line that it prints is how many messages it sent.
"""

import sys
import time

from besieged import street_pose
from wayline.bus import open_session
from wayline.codec import encode
from wayline.keys import message_key
from wayline.settings import BusSettings


def main(endpoint: str, vehicle_id: str, seconds: float, rate_hz: float, size: int) -> None:
    """Publish poses until the time is over."""
    with open_session(BusSettings(connect=(endpoint,))) as session:
        publisher = session.declare_publisher(message_key(vehicle_id, "pose", "fusion"))
        start_s, sent = time.monotonic(), 0
        while (now_s := time.monotonic() - start_s) < seconds:
            due = sent + 1 if not rate_hz else round(now_s * rate_hz)
            while sent < due:
                payload = encode(street_pose(time.time_ns(), 10.0 * now_s))
                publisher.put(payload + b" " * (size - len(payload)))
                sent += 1
            if rate_hz:
                time.sleep(0.002)
        publisher.undeclare()  # type: ignore[no-untyped-call]
    sys.stdout.write(f"{sent}\n")


if __name__ == "__main__":
    where, who, how_long, how_fast, how_large = sys.argv[1:]
    main(where, who, float(how_long), float(how_fast), int(how_large))
