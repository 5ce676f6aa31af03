"""Fusion stays a house that one can hold in the head: counted, not promised."""

import ast
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import FrameType
from typing import Any

import msgspec
import pytest

from builders import at, only
from unit.fusion.drives import Sensors, messages_of, town, truth_of, winding
from unit.fusion.skies import Receiver, epochs_of, with_epochs
from wayline.messages import Barometer, GpsFix, Message, Odometer, Pose, Torque
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.filter.horizontal import HorizontalFilter
from wayline_fusion.intake import events
from wayline_fusion.intake.events import ClockStep, Elapsed, Event, GyroRestarted, GyroWarmed

ROOT = Path(__file__).parents[2]
FUSION = ROOT / "services/fusion/wayline_fusion"
SERVICES = [path.parent for path in (ROOT / "services").glob("*/wayline_*/core.py")]
MOST_COLLABORATORS = 10
MOST_FILES = 8
OPERATION = re.compile(r"\b(?:reset|inflate|project)_\w+")


def modules(path: Path) -> set[str]:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}


@pytest.mark.parametrize("path", sorted((FUSION / "aids").glob("*.py")), ids=lambda path: path.stem)
def test_no_aid_imports_another(path: Path) -> None:
    assert not {name for name in modules(path) if name.startswith("wayline_fusion.aids")}


@pytest.mark.parametrize("service", SERVICES, ids=lambda path: path.name)
def test_no_core_has_more_than_ten_collaborators(service: Path) -> None:
    """Modules of its own service that it works with; messages and tuning are its language."""
    own = {name for name in modules(service / "core.py") if name.startswith(service.name)}
    assert len(own) <= MOST_COLLABORATORS, sorted(own)


@pytest.mark.parametrize("path", sorted((FUSION / "aids").glob("[a-z]*.py")), ids=lambda p: p.stem)
def test_every_aid_says_when_it_starts_goes_on_stops_and_resets(path: Path) -> None:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    documented = [node for node in nodes if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    texts = [" ".join((ast.get_docstring(node) or "").split()) for node in documented]
    words = ("Starts:", "Goes on:", "Stops:", "Resets:")
    assert any(all(word in text for word in words) for text in texts)


def test_inheritance_is_one_deep_at_most() -> None:
    """No class is derived from one that is itself derived from another of fusion's."""
    own = {node.name: bases(node) for node in all_classes()}
    derived = {name for name, of in own.items() if set(of) & set(own)}
    assert derived
    assert not {name for name, of in own.items() if set(of) & derived}


def all_classes() -> list[ast.ClassDef]:
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in FUSION.rglob("*.py")]
    return [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]


def bases(node: ast.ClassDef) -> list[str]:
    return [base.id for base in node.bases if isinstance(base, ast.Name)]


def documented_callers() -> dict[str, set[str]]:
    """The table in docs/fusion.md: operation, and who may call it."""
    text = (ROOT / "docs/fusion.md").read_text(encoding="utf-8")
    operation = r"`((?:reset|inflate|project)_\w+)`"
    rows = re.findall(rf"^\| {operation} \|[^|]*\|([^|]*)\|$", text, re.MULTILINE)
    return {name: set(re.findall(r"`([\w/]+\.py)`", callers)) for name, callers in rows}


def real_callers() -> dict[str, set[str]]:
    """Who calls an operation of a filter; the filters themselves may call their own."""
    found: dict[str, set[str]] = {}
    for path in FUSION.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        for name in names:
            if OPERATION.fullmatch(name) and path.name != "horizontal.py":
                found.setdefault(name, set()).add(str(path.relative_to(FUSION)))
    return found


def test_only_those_in_the_table_change_a_covariance() -> None:
    assert real_callers() == documented_callers()


def test_every_operation_on_a_covariance_is_in_the_table() -> None:
    operations = {name for name in vars(HorizontalFilter) if OPERATION.fullmatch(name)}
    assert operations <= set(documented_callers())


class Files:
    """Which of fusion's files run while an event is added to the timeline."""

    def __init__(self) -> None:
        self.by_kind: dict[str, set[str]] = {}
        self._kind = ""

    def watch(self, core: FusionCore) -> None:
        timeline: Any = core._timeline
        push = timeline._push

        def watched(event: Event) -> None:
            self._kind = type(event).__name__
            touched = self.by_kind.setdefault(self._kind, {"filter/timeline.py"})
            sys.setprofile(lambda frame, what, _: self._note(frame, what, touched))
            try:
                push(event)
            finally:
                sys.setprofile(None)

        timeline._push = watched

    @staticmethod
    def _note(frame: FrameType, what: str, touched: set[str]) -> None:
        path = Path(frame.f_code.co_filename)
        if what == "call" and FUSION in path.parents:
            touched.add(str(path.relative_to(FUSION)))


def give(core: FusionCore, messages: Iterable[Message]) -> Sequence[object]:
    node = Node("fusion", core)
    return [output for message in messages for output in node.take(message, "test")]


def watched_drive() -> Files:
    """A minute without being watched, driving, standing, fixes, pressures and three rarities."""
    files, core = Files(), FusionCore(Tuning())
    messages: list[Message] = []
    for message in messages_of(town, truth_of(town, 130.0), Sensors(0.3, gps_noise_m=0.5)):
        is_fix = isinstance(message, GpsFix)
        messages.append(with_altitude(message) if is_fix else message)
        if isinstance(message, Odometer):
            pressure_pa = 99_000.0 + 0.1 * (len(messages) % 3)
            messages.append(Barometer(t_ns=message.t_ns, pressure_pa=pressure_pa))
            messages.append(engine_of(message))
    split = next(i for i, message in enumerate(messages) if message.t_ns >= at(60))
    assert only(give(core, messages[:split]), Pose)  # type: ignore[arg-type]
    files.watch(core)
    give(core, messages[split:])
    core._add(GyroRestarted(at(131), 5.0))
    core._add(ClockStep(at(132), 1.0))
    core._add(GyroWarmed(at(133), 1.0))
    return files


def watched_satellites() -> Files:
    """Half a minute of raw measurements, after a minute without being watched."""
    files, core = Files(), FusionCore(Tuning(architecture="measurement"))
    truths = truth_of(winding, 90.0)
    sensed = [
        message
        for message in messages_of(winding, truths, Sensors())
        if not isinstance(message, GpsFix)
    ]
    messages = with_epochs(sensed, epochs_of(truths, Receiver()))
    split = next(i for i, message in enumerate(messages) if message.t_ns >= at(60))
    give(core, messages[:split])
    files.watch(core)
    give(core, messages[split:])
    return files


def engine_of(odometer: Odometer) -> Torque:
    """In one gear, pulling steadily; the vehicle finds the road level."""
    speed_mps = odometer.speed_mps or 0.0
    return Torque(
        t_ns=odometer.t_ns, engine_torque_nm=60.0, engine_speed_rpm=120.0 * speed_mps, slope_pct=0.0
    )


def with_altitude(message: Message) -> Message:
    return msgspec.structs.replace(message, alt_m=200.0)


def test_one_event_touches_at_most_eight_files() -> None:
    by_kind = watched_satellites().by_kind | watched_drive().by_kind
    kinds = {kind.__name__ for kind in events.Event.__args__}
    assert set(by_kind) == kinds
    assert Elapsed.__name__ in kinds
    too_many = {kind: sorted(paths) for kind, paths in by_kind.items() if len(paths) > MOST_FILES}
    assert not too_many
