"""Pure: the verdicts and counts that the next status tells."""

from collections.abc import Iterable

from wayline.messages import Verdict

SECOND_NS = 1_000_000_000


class Told:
    """Collects verdicts from one status to the next."""

    def __init__(self) -> None:
        self.late = 0
        """Measurements that came too late to be applied."""
        self.rejected = 0
        """Measurements that were refused or rejected."""
        self._verdicts: list[Verdict] = []
        self._refused_ns: dict[str, int] = {}

    def refuse(self, sensor: str, t_ns: int, reason: str, now_ns: int) -> None:
        """Count a reading that cannot be; of each sensor one a second is told."""
        self.rejected += 1
        if now_ns - self._refused_ns.get(sensor, 0) >= SECOND_NS:
            self._refused_ns[sensor] = now_ns
            self._verdicts.append(
                Verdict(
                    sensor=sensor, t_ns=t_ns, accepted=False, nis=0.0, threshold=0.0, reason=reason
                )
            )

    def add(self, verdicts: Iterable[Verdict], t_ns: int) -> None:
        """Tell the verdicts of one instant; those of events that were set back are known."""
        for verdict in verdicts:
            if verdict.t_ns == t_ns:
                self.rejected += not verdict.accepted
                self._verdicts.append(verdict)

    def take(self) -> tuple[Verdict, ...]:
        """Verdicts since the last call."""
        verdicts, self._verdicts = tuple(self._verdicts), []
        return verdicts
