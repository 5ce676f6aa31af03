"""Old messages of a vehicle that plays no recording are not the present."""

import datetime as dt
import time

from msgspec.structs import replace

from besieged import Besieged, Bus, await_true
from wayline.messages import Health

HOUR_NS = 3_600_000_000_000
LATE = "late-bus"


def test_an_hour_old_poses_are_an_hour_old_to_everybody(besieged: Besieged, bus: Bus) -> None:
    start_ns = time.time_ns()
    said = Health(t_ns=start_ns, service="fusion", version="0", started_ns=start_ns)

    def speak() -> None:
        now_ns = time.time_ns()
        besieged.put(replace(said, t_ns=now_ns), LATE)
        besieged.put(replace(bus.pose(now_ns), t_ns=now_ns - HOUR_NS), LATE)
        time.sleep(0.1)

    def is_old() -> bool:
        speak()
        vehicles = besieged.get("eta", "/v1/vehicles")["vehicles"]
        ages_s = {each["vehicle_id"]: each["age_s"] for each in vehicles}
        return bool(3_500.0 < ages_s.get(LATE, 0.0) < 3_700.0)

    assert await_true(is_old, "an hour's age") < 5.0
    ends_s = time.monotonic() + 2.0
    while time.monotonic() < ends_s:
        speak()
    arrivals = besieged.get("eta", f"/v1/vehicles/{LATE}/arrivals")["arrivals"]
    assert all(arrival["stale"] for arrival in arrivals)
    view = besieged.get("dashboard", "/v1/view")
    (late,) = [each for each in view["vehicles"] if each["vehicle_id"] == LATE]
    now, heard = (dt.datetime.fromisoformat(text) for text in (view["now"], late["heard"]))
    assert 3_500.0 < (now - heard).total_seconds() < 3_700.0
