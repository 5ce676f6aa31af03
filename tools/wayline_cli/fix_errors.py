"""How far a replay's poses lie from recorded fixes, for a drive without a better truth.

`python -m wayline_cli.fix_errors OUT [--reference OUT] [--outage START_S:LENGTH_S] [--plot PNG]`:
the fixes are those of the reference, a replay of the same drive without an outage; `--outage` may
be repeated.
"""

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline.messages import TOPICS

Floats = NDArray[np.float64]
Row = dict[str, Any]


class FixErrors(NamedTuple):
    """Distances of fixes from the poses at their instants."""

    seconds: Floats
    """Of the fixes, from the drive's smallest t_ns."""
    apart_m: Floats
    """nan before the first pose with a position."""

    def at_end_of(self, start_s: float, length_s: float) -> float:
        """Distance at the last fix within an outage, in metres."""
        inside = (self.seconds >= start_s) & (self.seconds < start_s + length_s)
        return float(self.apart_m[np.flatnonzero(inside)[-1]])


def read_topic(out: Path, topic: str) -> list[Row]:
    """The messages of one topic of a replay."""
    with (out / f"{topic}.jsonl").open("rb") as file:
        return [msgspec.json.decode(line) for line in file]


def start_of(out: Path) -> int:
    """Smallest t_ns of a drive's input, which outages are counted from."""
    ingested = ("gps_fix", "odometer", "gyro", "torque", "barometer")
    heads = [read_topic(out, topic)[:1000] for topic in ingested]
    return min(int(row["t_ns"]) for head in heads for row in head)


def fix_errors(out: Path, reference: Path) -> FixErrors:
    """Distances of the reference's valid fixes from the poses, interpolated in time."""
    start_ns = start_of(reference)
    fixes = [fix for fix in read_topic(reference, TOPICS["gps_fix"].topic) if fix["valid"]]
    poses = [pose for pose in read_topic(out, "pose") if pose["lat_deg"] is not None]
    seconds = np.array([(fix["t_ns"] - start_ns) * 1e-9 for fix in fixes])
    times = np.array([(pose["t_ns"] - start_ns) * 1e-9 for pose in poses])
    lat, lon = (
        np.interp(seconds, times, [pose[name] for pose in poses], left=np.nan)
        for name in ("lat_deg", "lon_deg")
    )
    known = ~np.isnan(lat)
    apart_m = np.full(len(fixes), np.nan)
    fix_lat, fix_lon = (np.array([fix[name] for fix in fixes]) for name in ("lat_deg", "lon_deg"))
    _, _, apart_m[known] = WGS84.inv(lon[known], lat[known], fix_lon[known], fix_lat[known])
    return FixErrors(seconds, apart_m)


def plot(out: Path, errors: FixErrors, path: Path) -> None:
    """Track, error and grade in one picture."""
    from matplotlib.figure import Figure  # noqa: PLC0415  -- slow to import, seldom needed

    poses = [pose for pose in read_topic(out, "pose") if pose["lat_deg"] is not None]
    start_ns = start_of(out)
    seconds = [(pose["t_ns"] - start_ns) * 1e-9 for pose in poses]
    figure = Figure(figsize=(10, 12), layout="constrained")
    track, error, grade = figure.subplots(3, 1)
    track.plot([pose["lon_deg"] for pose in poses], [pose["lat_deg"] for pose in poses])
    track.set(title="track", xlabel="longitude, deg", ylabel="latitude, deg")
    error.semilogy(errors.seconds, errors.apart_m)
    error.set(title="pose to recorded fix", xlabel="s", ylabel="m")
    known = [(s, pose["grade_pct"]) for s, pose in zip(seconds, poses, strict=True)]
    grade.plot(*zip(*((s, g) for s, g in known if g is not None), strict=True))
    grade.set(title="grade", xlabel="s", ylabel="%", ylim=(-10, 10))
    figure.savefig(path, dpi=80)


def main() -> None:
    """Print the errors of a replay."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--reference", type=Path)
    parser.add_argument("--outage", metavar="START_S:LENGTH_S", action="append", default=[])
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    errors = fix_errors(options.out, options.reference or options.out)
    p50, p95, p100 = np.nanpercentile(errors.apart_m, [50, 95, 100])
    within = np.mean(errors.apart_m <= 15.0)
    print(f"{len(errors.seconds)} fixes: p50 {p50:.2f} m, p95 {p95:.2f} m, max {p100:.1f} m")
    print(f"within 15 m: {100.0 * within:.1f} %")
    ends_m = [errors.at_end_of(*map(float, outage.split(":"))) for outage in options.outage]
    if ends_m:
        p50, p90, p100 = np.percentile(ends_m, [50, 90, 100])
        print(f"at the end of {len(ends_m)} outages: {', '.join(f'{m:.1f}' for m in ends_m)} m")
        print(f"p50 {p50:.1f} m, p90 {p90:.1f} m, max {p100:.1f} m")
    if options.plot:
        plot(options.out, errors, options.plot)


if __name__ == "__main__":
    main()
