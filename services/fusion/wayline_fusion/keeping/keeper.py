"""Pure: takes what is known of a vehicle over a restart."""

from typing import Protocol

import msgspec

from wayline.tuning import Tuning
from wayline_fusion.filter.estimate import Snapshot
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import GyroRestarted
from wayline_fusion.keeping.height import kept_height, noise_of, resumed_height, with_noise
from wayline_fusion.keeping.records import Saved
from wayline_fusion.keeping.restart import is_after, kept, resumed
from wayline_fusion.keeping.save_times import SaveTimes, is_silent


class Keepable(Protocol):
    """An estimate that is worth keeping."""

    t_ns: int

    @property
    def located(self) -> bool:
        """Whether position and heading are known."""
        ...

    @property
    def standing(self) -> bool:
        """Whether the vehicle stands."""
        ...

    def snapshot(self) -> Snapshot:
        """What is believed now."""
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Believe something else."""
        ...


class Keeper(Protocol):
    """Starts one estimate from what was kept, and says what to keep of it."""

    def begin(self, t_ns: int) -> bool:
        """Called with a message's instant, before the estimate gets it, until it says True."""
        ...

    def take_temperature(self, t_ns: int, temperature_c: float) -> GyroRestarted | None:
        """Of the gyro; the first one says how far what was kept of its bias still holds."""
        ...

    def due(self, t_ns: int, heard_ns: int | None) -> list[Saved]:
        """What to keep at a tick; `heard_ns` is when a sensor was heard last."""
        ...

    def last(self, heard_ns: int | None) -> list[Saved]:
        """What to keep at the end."""
        ...


class NoKeeper:
    """For architectures that learn nothing."""

    def begin(self, t_ns: int) -> bool:
        """There is nothing to begin with."""
        del t_ns
        return True

    def take_temperature(self, t_ns: int, temperature_c: float) -> GyroRestarted | None:
        """No bias was kept that warmth could have changed."""
        del t_ns, temperature_c
        return None

    def due(self, t_ns: int, heard_ns: int | None) -> list[Saved]:
        """There is nothing to keep."""
        del t_ns, heard_ns
        return []

    def last(self, heard_ns: int | None) -> list[Saved]:
        """There is nothing to keep at the end either."""
        del heard_ns
        return []


class EstimateKeeper:
    """Keeps calibration, pose and height."""

    def __init__(
        self, estimator: Keepable, vertical: VerticalEstimate, saved: Saved | None, tuning: Tuning
    ) -> None:
        self._estimator, self._vertical, self._tuning = estimator, vertical, tuning
        self._saved = saved
        """Until a message tells how old it is."""
        self._unknowing = estimator.snapshot()
        self._is_calibrated = False
        self._times = SaveTimes()
        self._kept_temperature_c = saved.calibration.gyro_temperature_c if saved else None
        self._temperature_c: float | None = None

    def begin(self, t_ns: int) -> bool:
        """Called with a message's instant, before the estimator gets it, until it says True.

        The bus's history may begin with messages of before the restart: they are calibrated, and
        if they do not tell where the vehicle is, the first one of later is placed.
        """
        saved = self._saved
        if saved is None:
            return True
        is_later = is_after(saved, t_ns)
        if is_later:
            self._saved = None
            self._begin_height(saved, t_ns)
        if not self._is_calibrated:
            self._vertical.know_noise(noise_of(saved.calibration))
        if not (self._is_calibrated and (self._estimator.located or not is_later)):
            self._is_calibrated = True
            self._estimator.restore(resumed(saved, self._unknowing, t_ns, self._tuning))
        return is_later

    def _begin_height(self, saved: Saved, t_ns: int) -> None:
        if saved.pose is None or saved.height is None or self._vertical.known:
            return
        fresh = self._vertical.snapshot()
        self._vertical.restore(resumed_height(saved, saved.height, fresh, t_ns, self._tuning))

    def take_temperature(self, t_ns: int, temperature_c: float) -> GyroRestarted | None:
        """Of the gyro; the first one says how far what was kept of its bias still holds."""
        self._temperature_c = temperature_c
        before_c, self._kept_temperature_c = self._kept_temperature_c, None
        return None if before_c is None else GyroRestarted(t_ns, temperature_c - before_c)

    def due(self, t_ns: int, heard_ns: int | None) -> list[Saved]:
        """What to keep at a tick; `heard_ns` is when a sensor was heard last."""
        standing = self._estimator.standing
        return self._now() if self._times.is_due(t_ns, heard_ns, standing=standing) else []

    def last(self, heard_ns: int | None) -> list[Saved]:
        """What to keep at the end; where the sensors have fallen silent before, that stands."""
        return [] if is_silent(self._estimator.t_ns, heard_ns) else self._now()

    def _now(self) -> list[Saved]:
        snapshot = self._estimator.snapshot()
        saved = kept(snapshot, snapshot.t_ns, self._temperature_c)
        if saved is None:
            return []
        height = kept_height(self._vertical.snapshot())
        calibration = with_noise(saved.calibration, self._vertical.noise_factors())
        return [msgspec.structs.replace(saved, calibration=calibration, height=height)]
