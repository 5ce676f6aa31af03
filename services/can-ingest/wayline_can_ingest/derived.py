"""Pure: fields of a message that the bus gives in another form."""

from wayline.drive import Vehicle
from wayline_can_ingest.counter import Unwrapped
from wayline_can_ingest.quantity import Extractor, Value

Fields = dict[str, Value]


class Derived:
    """Torque from percent, distance from a counter, reverse from a negative speed."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._reference_torque_nm = vehicle.engine_reference_torque_nm
        self._friction_pct = 0.0
        self._counters: dict[str, Unwrapped] = {}

    def put(self, fields: Fields, extractor: Extractor, value: Value, t_ns: int, unit: int) -> None:
        """Set what one quantity means for its message; the unit is who sent the frame."""
        field = extractor.field
        if field == "engine_reference_torque_nm":
            # a unit that has not read its own says 0
            self._reference_torque_nm = float(value) or self._reference_torque_nm
        elif field == "engine_friction_pct":
            self._friction_pct = float(value)
        elif field == "engine_torque_pct":
            self._put_torque(fields, float(value))
        elif field == "distance_m":
            counter = self._counters.get(extractor.message)
            if counter is None:
                counter = self._counters[extractor.message] = Unwrapped(extractor.span)
            distance_m = counter.distance_m(float(value), t_ns, unit)
            if distance_m is not None:
                fields[field] = distance_m
        elif field == "speed_mps" and float(value) < 0.0:
            fields[field] = -float(value)
            fields.setdefault("reverse", True)
        else:
            fields[field] = value

    def _put_torque(self, fields: Fields, torque_pct: float) -> None:
        """Net torque: percent torque includes what the engine needs to turn itself (SPN 514)."""
        if self._reference_torque_nm is not None and "engine_torque_nm" not in fields:
            net_pct = torque_pct - self._friction_pct
            fields["engine_torque_nm"] = net_pct / 100.0 * self._reference_torque_nm
