"""Pure: the sentences of one epoch merged into one fix."""

from typing import Literal

from wayline.messages import FixKind, GpsFix
from wayline_gps_ingest.decode import Facts, Observation
from wayline_gps_ingest.sky import Sky

POSITION_KINDS = frozenset(("GGA", "RMC", "GLL", "GNS"))
VERDICTS: tuple[Literal["rmc_valid", "gga_valid", "gns_valid", "gll_valid"], ...] = (
    "rmc_valid",
    "gga_valid",
    "gns_valid",
    "gll_valid",
)


class Epoch:
    """What a receiver said of one instant."""

    def __init__(self) -> None:
        self.facts = Facts()
        self.time_ns: int | None = None
        """Since midnight UTC."""
        self.is_whole_s = True
        """Whether no sentence told decimals of the second."""
        self.repeat = False
        self.kinds: set[str] = set()
        self.timed_keys: set[str] = set()
        self.first_key = ""
        """The first timed sentence."""
        self._gsa_mode = 0
        self._sky: Sky | None = None

    def add(self, observation: Observation) -> None:
        """Merge a sentence in; what is said twice stands as said last."""
        kind = observation.kind
        self.kinds.add(kind)
        if kind == "GSV":
            self.sky.add(observation)
            return
        if observation.time_ns is not None:
            self.time_ns = observation.time_ns
            if not observation.is_whole_s:
                self.is_whole_s = False
            if not self.first_key:
                self.first_key = observation.key
            self.timed_keys.add(observation.key)
        elif kind == "GSA":
            self.sky.add(observation)
            # one GSA a constellation: the one without used satellites says "no fix"
            self._gsa_mode = max(self._gsa_mode, observation.facts.get("gsa_mode", 0))
        self.facts.update(observation.facts)

    def merge(self, later: "Epoch") -> None:
        """Add what came in a second burst of the same instant."""
        self.kinds |= later.kinds
        self.timed_keys |= later.timed_keys
        self._gsa_mode = max(self._gsa_mode, later._gsa_mode)
        if later._sky:
            self.sky.merge(later._sky)
        self.facts.update(later.facts)

    @property
    def sky(self) -> Sky:
        """Satellites in view and in use."""
        if self._sky is None:
            self._sky = Sky()
        return self._sky

    @property
    def in_view(self) -> bool:
        """Whether satellites in view were told."""
        return "GSV" in self.kinds

    @property
    def has_position(self) -> bool:
        """Whether a sentence came that says where the receiver is, or that it does not know."""
        return not POSITION_KINDS.isdisjoint(self.kinds)

    @property
    def is_valid(self) -> bool:
        """Every sentence that judges the position must call it valid, and one must."""
        facts, judged = self.facts, False
        for name in VERDICTS:
            if name in facts:
                if not facts[name]:
                    return False
                judged = True
        return judged and not self.repeat

    def fix(self, t_ns: int = 0) -> GpsFix:
        """The epoch as a message."""
        facts = self.facts
        if self.repeat:
            return GpsFix(t_ns=t_ns, valid=False, repeat=True)
        if not self.is_valid:
            return GpsFix(
                t_ns=t_ns,
                valid=False,
                satellites=self._satellites(),
                hdop=facts.get("hdop"),
                pdop=facts.get("pdop"),
                vdop=facts.get("vdop"),
            )
        return GpsFix(
            t_ns=t_ns,
            valid=True,
            lat_deg=facts["lat_deg"],
            lon_deg=facts["lon_deg"],
            alt_m=facts.get("alt_m", facts.get("other_alt_m")),
            geoid_sep_m=facts.get("geoid_sep_m"),
            speed_mps=facts.get("speed_mps"),
            course_deg=facts.get("course_deg"),
            mode=self._mode(),
            fix=fix_kind(facts),
            satellites=self._satellites(),
            hdop=facts.get("hdop"),
            pdop=facts.get("pdop"),
            vdop=facts.get("vdop"),
            h_std_m=facts.get("h_std_m"),
            v_std_m=facts.get("v_std_m"),
        )

    def _mode(self) -> Literal[2, 3]:
        if self._gsa_mode > 1:
            return 3 if self._gsa_mode == 3 else 2
        return 3 if "alt_m" in self.facts or "other_alt_m" in self.facts else 2

    def _satellites(self) -> int | None:
        """In use; GGA counts to 12 in many receivers, GSA lists them all."""
        told = self.facts.get("satellites")
        listed = len(self._sky.used()) if self._sky else 0
        return max(told, listed) if told is not None else listed or None


def fix_kind(facts: Facts) -> FixKind:
    """Quality of GGA or GNS first, they tell more kinds; dead reckoning wins wherever said."""
    if facts.get("mode_fix") == "dead_reckoning":
        return "dead_reckoning"
    return facts.get("quality") or facts.get("mode_fix") or "gps"
