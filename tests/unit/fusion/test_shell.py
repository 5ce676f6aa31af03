"""The fusion process: with a database it goes on where it stopped, each vehicle by itself."""

import contextlib
from argparse import Namespace
from pathlib import Path

from builders import about, only
from unit.fusion.drives import Sensors, messages_of, town, truth_of
from wayline.messages import FusionStatus, Message
from wayline.node import Node
from wayline.settings import Settings
from wayline_fusion.__main__ import build

SENSORS = Sensors(odometer_scale=0.95, gps_noise_m=1.0)


def served(settings: Settings, vehicle_id: str) -> list[FusionStatus]:
    """Two minutes of one vehicle, from the start of the process to its end."""
    service = build(settings, Namespace())
    with contextlib.ExitStack() as stack:
        if service.store is not None:
            # as the loop does
            service.store.start(lambda: None)
            stack.callback(service.store.close)
        return driven(service.make_node(vehicle_id, ""))


def driven(node: Node) -> list[FusionStatus]:
    published: list[Message] = []
    last_ns = 0
    for message in messages_of(town, truth_of(town, 120.0), SENSORS):
        last_ns = message.t_ns
        published += node.take(message, "test")
    published += node.finish(last_ns)
    statuses: list[FusionStatus] = only(published, FusionStatus)
    return statuses


def test_a_vehicle_starts_with_its_own_calibration_only(tmp_path: Path) -> None:
    settings = Settings(vehicles=("*",), database_url=f"sqlite:///{tmp_path}/fusion.db")
    assert served(settings, "bus-1")[0].odometer_scale == 1.0
    assert served(settings, "bus-1")[0].odometer_scale == about(0.95, 0.02)
    assert served(settings, "bus-2")[0].odometer_scale == 1.0


def test_without_a_database_fusion_runs_and_keeps_nothing() -> None:
    settings = Settings(vehicles=("*",))
    assert served(settings, "bus-1")[-1].odometer_scale == about(0.95, 0.02)
    assert served(settings, "bus-1")[0].odometer_scale == 1.0
