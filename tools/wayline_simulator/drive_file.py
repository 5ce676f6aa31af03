"""Pure: the text of a simulated drive's `drive.toml`."""

from collections.abc import Iterator, Mapping

import msgspec

from wayline.drive import RawSource, SignalMapping, Vehicle

NMEA_NAME, CAN_NAME, DBC_NAME = "gps.nmea", "can.log", "vehicle.dbc"
TRUTH_NAME, ROUTE_NAME = "truth.csv", "route.geojson"


def drive_toml(
    *,
    vehicle_id: str,
    description: str,
    signals: Mapping[str, SignalMapping],
    vehicle: Vehicle,
    has_gps: bool,
    raw: RawSource | None,
) -> str:
    """The file's text; without signals the drive has no CAN bus."""
    lines = [
        *_table("[drive]", {"vehicle_id": vehicle_id, "description": description}),
        *(_table("[[nmea]]", {"path": NMEA_NAME}) if has_gps else ()),
        *(_table("[[raw]]", _given(raw)) if raw else ()),
        *(_can(signals) if signals else ()),
        *_table("[vehicle]", _given(vehicle)),
        *_table("[route]", {"path": ROUTE_NAME}),
        *_table("[truth]", {"path": TRUTH_NAME}),
    ]
    return "\n".join(lines)


def _can(signals: Mapping[str, SignalMapping]) -> Iterator[str]:
    yield from _table("[[can]]", {"path": CAN_NAME, "dbc": [DBC_NAME]})
    yield "[can.signals]"
    for quantity, mapping in signals.items():
        yield f'"{quantity}" = {_value(_given(mapping))}'
    yield ""


def _table(header: str, values: Mapping[str, object]) -> Iterator[str]:
    yield header
    for key, value in values.items():
        yield f"{key} = {_value(value)}"
    yield ""


def _given(struct: msgspec.Struct) -> dict[str, object]:
    """A struct's fields that are not at their default."""
    return {
        field.name: getattr(struct, field.name)
        for field in msgspec.structs.fields(struct)
        if getattr(struct, field.name) != _default(field)
    }


def _default(field: msgspec.structs.FieldInfo) -> object:
    made = field.default_factory is not msgspec.NODEFAULT
    return field.default_factory() if made else field.default


def _value(value: object) -> str:
    """JSON's strings, numbers, booleans and lists are TOML's too; tables are written inline."""
    if isinstance(value, msgspec.Struct):
        return _value(_given(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return msgspec.json.encode(value).decode()
