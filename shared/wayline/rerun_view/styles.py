"""How entities look: colours, widths and names, by where they stand below the vehicle's id.

Blue is fusion's estimate, orange what GPS says, green the odometer, red what a gate rejected,
magenta the vehicle: seen on bright map tiles as well as on none.
"""

import rerun as rr

Colour = tuple[int, int, int]

FUSED: Colour = (77, 148, 255)
SIGMA: Colour = (62, 84, 120)
GPS: Colour = (255, 157, 46)
ODOMETER: Colour = (92, 200, 120)
REJECTED: Colour = (240, 72, 72)
ACCEPTED: Colour = (60, 170, 95)
GATE: Colour = (170, 170, 170)
KNOWN: Colour = (196, 130, 255)
ROUTE: Colour = (150, 150, 160)
VEHICLE: Colour = (230, 50, 200)
ELLIPSE: Colour = (0, 165, 185)


def _with_sigma(name: str) -> rr.SeriesLines:
    return rr.SeriesLines(
        names=[name, "+1 sigma", "-1 sigma"],
        colors=[FUSED, SIGMA, SIGMA],
        widths=[2.0, 1.0, 1.0],
    )


def _series(colour: Colour, width: float = 1.5, name: str | None = None) -> rr.SeriesLines:
    return rr.SeriesLines(colors=[colour], widths=[width], names=name)


def _marks(
    colour: Colour, marker: rr.components.MarkerShape, size: float, name: str
) -> rr.SeriesPoints:
    return rr.SeriesPoints(colors=[colour], markers=[marker], marker_sizes=[size], names=name)


def _dots(colour: Colour, radius: float) -> rr.GeoPoints:
    return rr.GeoPoints.from_fields(radii=rr.Radius.ui_points(radius), colors=[colour])


def _strokes(colour: Colour, radius: float) -> rr.GeoLineStrings:
    return rr.GeoLineStrings.from_fields(radii=rr.Radius.ui_points(radius), colors=[colour])


def _states(colours: dict[str, Colour]) -> rr.StateConfiguration:
    return rr.StateConfiguration(values=list(colours), colors=list(colours.values()))


_MODES: dict[str, Colour] = {
    "starting": (120, 120, 128),
    "gps": (200, 130, 40),
    "fused": (48, 120, 220),
    "dead_reckoning": (150, 90, 200),
    "lost": (200, 50, 50),
}
_CALIBRATIONS: dict[str, Colour] = {
    "none": (120, 120, 128),
    "started": (200, 130, 40),
    "calibrated": (50, 140, 80),
}
_VERDICTS: dict[str, Colour] = {
    "accepted": (50, 140, 80),
    "rejected": (200, 50, 50),
    "silent": (90, 90, 96),
}
_FIXES: dict[str, Colour] = {
    "none": (90, 90, 96),
    "gps": (200, 130, 40),
    "dgps": (160, 150, 40),
    "rtk_float": (90, 150, 60),
    "rtk_fixed": (50, 140, 80),
    "dead_reckoning": (150, 90, 200),
    "manual": (120, 120, 128),
    "simulator": (60, 130, 150),
}
_SENSORS: dict[str, Colour] = {
    "gps_position": GPS,
    "gps_speed": ODOMETER,
    "gps_course": FUSED,
}
"""Sensors whose every measurement has a verdict; Rerun colours the others apart."""
_ROUTE_STATES: dict[str, Colour] = {"on route": (50, 140, 80), "off route": (200, 50, 50)}


def style_of(path: str) -> rr.AsComponents | None:
    """The look of the entity at a path below the vehicle's id; None leaves it to Rerun."""
    first, _, rest = path.partition("/")
    if first == "innovations":
        sensor, _, part = rest.rpartition("/")
        return _innovation(sensor, part)
    kind = rest.partition("/")[0]
    return _STYLES.get((first, kind)) or _STYLES.get((first, ""))


def _innovation(sensor: str, part: str) -> rr.AsComponents | None:
    shapes = rr.components.MarkerShape
    if part == "rejected":
        return _marks(REJECTED, shapes.Cross, 5.0, part)
    colour = _SENSORS.get(sensor)
    # of the others only rejections are told: a line would join what is minutes apart
    if part == "gate":
        return _series(GATE, 1.0, part) if colour else _marks(GATE, shapes.Circle, 1.5, part)
    if colour is None:
        return rr.SeriesPoints(marker_sizes=[2.0], names=sensor)
    return _series(colour, name=sensor)


_STYLES: dict[tuple[str, str], rr.AsComponents] = {
    ("sky", "satellites"): rr.Points2D.from_fields(
        radii=rr.Radius.ui_points(5.0), show_labels=True
    ),
    ("map", "route"): _strokes(ROUTE, 2.0),
    ("map", "stops"): _dots(ROUTE, 5.0),
    ("map", "fixes"): _dots(GPS, 1.5),
    ("map", "rejected"): _dots(REJECTED, 3.0),
    ("map", "rejected_from"): _strokes(REJECTED, 0.5),
    ("map", "path"): _strokes(FUSED, 2.5),
    ("map", "vehicle"): _dots(VEHICLE, 5.0),
    ("map", "heading"): _strokes(VEHICLE, 1.5),
    ("map", "ellipse_95"): _strokes(ELLIPSE, 1.0),
    ("map", "on_route"): _dots(KNOWN, 4.0),
    ("speed", "fused"): _series(FUSED, 2.0),
    ("speed", "gps"): _series(GPS),
    ("speed", "odometer"): _series(ODOMETER),
    ("altitude", "fused"): _with_sigma("fused"),
    ("altitude", "gps"): _series(GPS),
    ("grade", "fused"): _with_sigma("fused"),
    ("grade", "vehicle"): _series(ODOMETER),
    ("grade", "gps_altitude"): _series(GPS),
    ("grade", "barometer"): _series(ELLIPSE),
    ("grade", "torque"): _series(VEHICLE),
    ("grade", "vehicle_slope"): _series(ODOMETER, 2.0),
    ("grade", "earlier_runs"): _series(KNOWN, 2.0),
    ("calibration", ""): _with_sigma("estimate"),
    ("states", "mode"): _states(_MODES),
    ("states", "calibration"): _states(_CALIBRATIONS),
    ("states", "fix"): _states(_FIXES),
    ("states", "verdict"): _states(_VERDICTS),
    ("states", "route"): _states(_ROUTE_STATES),
}
