"""RINEX 3 as a receiver's software writes it, of the sky that `ubx_sky` has."""

from collections.abc import Iterable, Sequence

from wayline_bench.made_up_ubx import Orbit, Signal

Field = tuple[str, Signal]
"""A satellite as RINEX names it, and what was measured."""


def labelled(body: str, label: str) -> str:
    return f"{body:<60}{label:<20}\n"


def observations(epochs: Iterable[tuple[int, float, Sequence[Field]]]) -> str:
    """An observation file: hour and second of 2026-01-08, and the signals."""
    head = (
        labelled("     3.03           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE")
        + labelled("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES")
        + labelled("R    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES")
        + labelled("  1 R05  1", "GLONASS SLOT / FRQ #")
        + labelled("  2026     1     8     2     0    0.0000000     GPS", "TIME OF FIRST OBS")
        + labelled("", "END OF HEADER")
    )
    return head + "".join(_epoch(*epoch) for epoch in epochs)


def _epoch(minute: int, second: float, signals: Sequence[Field]) -> str:
    lines = [f"> 2026 01 08 02 {minute:02d}{second:11.7f}  0{len(signals):3d}\n"]
    for name, each in signals:
        numbers = (each.pseudorange_m, each.phase_cycles, each.doppler_hz, float(each.cn0_dbhz))
        lines.append(name + "".join(f"{number:14.3f}  " for number in numbers) + "\n")
    return "".join(lines)


def navigation_file(orbits: Iterable[Orbit]) -> str:
    """A navigation file with ephemerides of 2026-01-08 02:00."""
    head = labelled("     3.03           N: GNSS NAV DATA    G: GPS", "RINEX VERSION / TYPE")
    return head + labelled("", "END OF HEADER") + "".join(map(_ephemeris, orbits))


def _ephemeris(orbit: Orbit) -> str:
    of = orbit.numbers
    rows = [
        [of["iode"], 0.0, of["deln"], of["m0"]],
        [0.0, of["e"], 0.0, of["sqrt_a"]],
        [of["toe_s"], 0.0, of["omega0"], 0.0],
        [of["i0"], 0.0, of["omega"], of["omega_dot"]],
        [0.0, 0.0, float(orbit.week), 0.0],
        [2.0, of["health"], of["tgd_s"], of["iodc_low"]],
        [of["toe_s"] - 7200.0, 4.0, 0.0, 0.0],
    ]
    first = f"G{orbit.prn:02d} 2026 01 08 02 00 00" + _numbers([of["f0_s"], of["f1"], 0.0])
    return first + "\n" + "".join(f"    {_numbers(row)}\n" for row in rows)


def _numbers(numbers: Sequence[float]) -> str:
    return "".join(f"{number:19.12E}" for number in numbers)
