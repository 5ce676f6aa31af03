"""Reads and writes GeoJSON features (RFC 7946), so far as routes need them."""

from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from wayline.errors import InputError
from wayline.text_file import read_text

Properties = TypeVar("Properties", bound=msgspec.Struct)
RFC = "see RFC 7946, or make the file with `wayline route import`"


class Geometry(msgspec.Struct, frozen=True):
    """A shape; what its coordinates hold depends on its type."""

    type: str
    coordinates: Any = None


class Feature(msgspec.Struct, frozen=True):
    """A shape with properties."""

    geometry: Geometry | None
    properties: dict[str, Any] | None = None
    type: Literal["Feature"] = "Feature"

    @property
    def kind(self) -> str:
        """The type of its geometry, empty without one."""
        return self.geometry.type if self.geometry else ""

    def positions(self, where: str, what: str) -> list[tuple[float, float]]:
        """Latitude and longitude in degrees of its point or of its line's points.

        Raises InputError, naming `where` and `what`, for coordinates that are not on Earth.
        """
        coordinates = self.geometry.coordinates if self.geometry else None
        listed = [coordinates] if self.kind == "Point" else coordinates
        try:
            pairs = [(row[1], row[0]) for row in msgspec.convert(listed, list[list[float]])]
        except (msgspec.ValidationError, IndexError):
            raise InputError(
                where, f"{what} has coordinates that are not numbers in pairs", RFC
            ) from None
        for lat_deg, lon_deg in pairs:
            if not (-90.0 <= lat_deg <= 90.0 and -180.0 <= lon_deg <= 180.0):
                raise InputError(
                    where,
                    f"{what} has a point at latitude {lat_deg:g}, longitude {lon_deg:g}",
                    "write longitude first, both in degrees",
                )
        return pairs


class FeatureCollection(msgspec.Struct, frozen=True):
    """A GeoJSON file."""

    features: list[Feature]
    type: Literal["FeatureCollection"] = "FeatureCollection"


def read_features(path: Path) -> list[Feature]:
    """The features of a GeoJSON file; InputError where it is missing or something else."""
    text = read_text(path)
    try:
        return msgspec.json.decode(text, type=FeatureCollection).features
    except msgspec.DecodeError as error:
        raise InputError(str(path), f"is not a GeoJSON FeatureCollection ({error})", RFC) from None
    except RecursionError:
        raise InputError(str(path), "is nested too deep to be GeoJSON", RFC) from None


def read_properties(
    feature: Feature, where: str, what: str, struct: type[Properties]
) -> Properties:
    """A feature's properties as a Struct; InputError for a missing or unfit one."""
    try:
        return msgspec.convert(feature.properties or {}, struct)
    except msgspec.ValidationError as error:
        raise InputError(where, f"{what}: {error}", "add or correct that property") from None


def write_features(features: list[Feature], path: Path) -> None:
    """Write a GeoJSON file for people and programs; InputError where the place is not writable."""
    content = msgspec.json.format(msgspec.json.encode(FeatureCollection(features)), indent=1)
    try:
        path.write_bytes(content + b"\n")
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error})", "check the folder") from None
