"""Pure: which drives of the shipped scenarios a study looks at."""

import zlib
from typing import NamedTuple

from wayline_replay.outages import Outage

SEEDS = 9000
"""A scenario's own come from its name: drives of equal seeds would share their devices' errors."""
OUTAGES_S = (60.0, 100.0, 150.0, 200.0)
"""Lengths by turns, as issue 7 and papers/001 have them."""
FIRST_OUTAGE_S, BETWEEN_S = 240.0, 120.0
"""Time to calibrate before the first and between two."""


class ScenarioPlan(NamedTuple):
    """How much of a scenario is looked at."""

    length_m: float | None = None
    """Of the road, where the scenario's own is longer than pooled figures need."""
    laps: int | None = None
    outages: bool = False
    """Each drive once more with outages of GPS."""
    share: int = 1
    """Drives for every drive that is asked for."""


PLANS = {
    "town": ScenarioPlan(outages=True, share=3),
    "main-road": ScenarioPlan(outages=True, share=3),
    "motorway": ScenarioPlan(outages=True, share=3),
    "cheap-box": ScenarioPlan(outages=True),
    "like-css-164": ScenarioPlan(length_m=30_000.0, outages=True),
    "thesis-main-road": ScenarioPlan(length_m=15_000.0),
    "thesis-motorway": ScenarioPlan(length_m=15_000.0),
    "outages": ScenarioPlan(length_m=20_000.0),
    "shuttle-loop": ScenarioPlan(laps=3),
    "day": ScenarioPlan(laps=2),
}
"""Where the scenario as it is takes too long, or the drive serves for outages."""


class StudyDrive(NamedTuple):
    """One drive of a study."""

    scenario: str
    seed: int
    plan: ScenarioPlan

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"{self.scenario}-{self.seed}"


def first_seed(scenario: str) -> int:
    """The first of a scenario's seeds, alike on every machine."""
    return 1000 + zlib.crc32(scenario.encode()) % SEEDS


def study_drives(scenarios: list[str], seeds: int) -> list[StudyDrive]:
    """`seeds` drives of each scenario, more of a scenario whose outages are pooled."""
    return [
        StudyDrive(scenario, first_seed(scenario) + number, plan)
        for scenario in scenarios
        for plan in [PLANS.get(scenario, ScenarioPlan())]
        for number in range(seeds * plan.share)
    ]


def outages_within(duration_s: float) -> list[Outage]:
    """All that end within a drive."""
    found: list[Outage] = []
    begin_s = FIRST_OUTAGE_S
    while begin_s + (length_s := OUTAGES_S[len(found) % len(OUTAGES_S)]) < duration_s:
        found.append(Outage(begin_s, length_s))
        begin_s += length_s + BETWEEN_S
    return found
