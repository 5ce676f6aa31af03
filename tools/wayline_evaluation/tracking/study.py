"""`wayline evaluate tracking`: the loops of papers/001 with and without the vehicle's velocity."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.replays import drive_name
from wayline_evaluation.tracking.acquisition import SearchModel
from wayline_evaluation.tracking.aid import (
    RIGHT,
    Aid,
    AidModel,
    Wrong,
    aid_of,
    as_printed,
    doubtful,
    held,
)
from wayline_evaluation.tracking.assumptions import assumptions
from wayline_evaluation.tracking.driven import read_driven, stretches_of
from wayline_evaluation.tracking.figures import (
    acquisition,
    family,
    figure_8,
    figure_9,
    thermal_example_hz,
)
from wayline_evaluation.tracking.fll import stress_hz, threshold_dbhz
from wayline_evaluation.tracking.lock import gained_db, lock_lost
from wayline_evaluation.tracking.loop import SAMPLES_HZ, Complexes, Told, white_noise
from wayline_evaluation.tracking.motion import MotionModel, Motions, doppler_hz, random_motions
from wayline_evaluation.tracking.printed import UNAIDED_HZ
from wayline_evaluation.tracking.report import Dynamics, Loop, TrackingReport
from wayline_evaluation.tracking.stress import Allowed, allowed, widened_hz

Progressed = Callable[[int, int], None]
LEVELS_DBHZ = tuple(np.arange(6.0, 24.5, 0.5).tolist())
BANDWIDTHS_HZ = (1.2, 0.8, 0.4, 0.2, 0.1)
"""At which the aided loop is shown beside the bandwidth that the aid allows."""
HEADING_DEG = 5.0
SPIKE_MPS = 1.5
"""For a tenth of a second a gyro claims as much as fusion believes: 15 m/s2 to the side."""


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """What is simulated."""

    motion: MotionModel = MotionModel()
    aid: AidModel = AidModel()
    search: SearchModel = SearchModel()
    seconds: float = 60.0
    runs: int = 100
    seed: int = 1


class Case(NamedTuple):
    """One loop to be simulated."""

    name: str
    bandwidth_hz: float
    told: Told
    left_hzps2: float
    """Jerk that stresses it."""
    aided: bool = True


def tracking_study(plan: Plan, folder: Path | None, progressed: Progressed) -> TrackingReport:
    """Loops under random motion, or that of a drive. Raises InputError for a drive without any."""
    motions, model = _motions(plan, folder)
    noise = white_noise(len(motions.speeds_mps), plan.runs, _random(plan, "noise"))
    aids = _Aids(plan, model, motions)
    right = aids.of()
    found = aids.allowed(right)
    loops = _simulated(_cases(aids), noise, progressed)
    std_hz = _rms(right.std_hz)
    return TrackingReport(
        drive=None if folder is None else drive_name(folder),
        assumptions=assumptions(plan.motion, model, plan.search, plan.seconds, plan.runs),
        example_hz=thermal_example_hz(),
        jitters=family(),
        dynamics=Dynamics(
            jerk_hzps2=found.jerk_hzps2,
            left_by_aid_hzps2=found.left_hzps2,
            aid_std_hz=std_hz,
            aid_error_hz=_rms(right.doppler_hz - aids.doppler_hz),
        ),
        loops=loops,
        figure_8=figure_8(aids.doppler_hz, right.doppler_hz, noise),
        figure_9=figure_9(found.bandwidth_hz, model, noise, _random(plan, "low dynamics")),
        acquisition=acquisition(std_hz, plan.search),
    )


def _motions(plan: Plan, folder: Path | None) -> tuple[Motions, AidModel]:
    """And what an aid knows of them: of a drive as its poses claim."""
    random = _random(plan, "motion")
    if folder is None:
        samples = round(plan.seconds * SAMPLES_HZ)
        return random_motions(plan.motion, samples, plan.runs, random), plan.aid
    stretches = stretches_of(
        read_driven(folder),
        plan.seconds,
        plan.runs,
        clock_hz_per_sqrt_s=plan.motion.clock_hz_per_sqrt_s,
        random=random,
    )
    model = msgspec.structs.replace(
        plan.aid,
        speed_std_mps=stretches.speed_std_mps,
        heading_std_deg=stretches.heading_std_deg,
    )
    return stretches.motions, model


def _random(plan: Plan, what: str) -> np.random.Generator:
    """One for each part, so that no part changes another's numbers."""
    return np.random.default_rng([plan.seed, *what.encode()])


class _Aids:
    """Of one set of motions: the same errors whatever else is wrong."""

    def __init__(self, plan: Plan, model: AidModel, motions: Motions) -> None:
        self._plan, self.model, self._motions = plan, model, motions
        self.doppler_hz = doppler_hz(motions)
        self.moved_hz = self.doppler_hz - motions.clocks_hz

    def of(self, wrong: Wrong = RIGHT, model: AidModel | None = None) -> Aid:
        """The aid with an error, or by another model."""
        return aid_of(self._motions, model or self.model, _random(self._plan, "aid"), wrong)

    def allowed(self, aid: Aid) -> Allowed:
        """How narrow it lets a loop be."""
        return allowed(self.moved_hz, aid.moved_hz, UNAIDED_HZ)

    def case(self, name: str, aid: Aid, bandwidth_hz: float | None = None) -> Case:
        """A loop that gets an aid, as narrow as that allows if no bandwidth is given."""
        found = self.allowed(aid)
        told = Told(self.doppler_hz, aid.doppler_hz)
        return Case(name, bandwidth_hz or found.bandwidth_hz, told, found.left_hzps2)

    def case_without(self) -> Case:
        """The loop that gets none."""
        jerk_hzps2 = self.allowed(self.of()).jerk_hzps2
        untold = Told(self.doppler_hz, np.zeros_like(self.doppler_hz))
        return Case("told nothing", UNAIDED_HZ, untold, jerk_hzps2, aided=False)


def _cases(aids: _Aids) -> list[Case]:
    right = aids.of()
    narrow_hz = aids.allowed(right).bandwidth_hz
    off, spike = aids.of(Wrong(heading_deg=HEADING_DEG)), aids.of(Wrong(spike_mps=SPIKE_MPS))
    said_hz = _rms(aids.of(model=doubtful(aids.model, HEADING_DEG)).std_hz)
    wider_hz = widened_hz(narrow_hz, said_hz / _rms(right.std_hz), UNAIDED_HZ)
    return [
        aids.case_without(),
        aids.case("aided, as its error allows", right),
        aids.case("the same, aids held", aids.of(model=held(aids.model))),
        aids.case("the same, aids every 10 ms", aids.of(model=as_printed(aids.model))),
        *(aids.case("aided", right, each) for each in BANDWIDTHS_HZ),
        aids.case("heading 5 deg off, unsaid", off, narrow_hz),
        aids.case("heading 5 deg off, its std says so", off, wider_hz),
        aids.case("gyro spike, unsaid", spike, narrow_hz),
    ]


def _simulated(cases: Sequence[Case], noise: Complexes, progressed: Progressed) -> tuple[Loop, ...]:
    loops: list[Loop] = []
    progressed(0, len(cases))
    for case in cases:
        lost = lock_lost(case.told, case.bandwidth_hz, LEVELS_DBHZ, noise)
        stress = stress_hz(360.0 * case.left_hzps2, case.bandwidth_hz)
        loops.append(
            Loop(
                name=case.name,
                bandwidth_hz=case.bandwidth_hz,
                aided=case.aided,
                stress_hz=stress,
                threshold_dbhz=threshold_dbhz(case.bandwidth_hz, stress),
                lost=lost,
                gained_db=gained_db(loops[0].lost, lost) if loops else None,
            )
        )
        progressed(len(loops), len(cases))
    return tuple(loops)


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
