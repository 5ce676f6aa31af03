"""Live receivers of raw measurements."""

from collections import Counter

from wayline.host_clock import EARLIEST_NS
from wayline.live_sources import LiveRaw
from wayline.node import Node
from wayline_gps_ingest.links import ubx_speech
from wayline_gps_ingest.raw import library
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.receivers import Receiver


class RawReceiver(Receiver):
    """A u-blox receiver that sends RXM-RAWX, and the node that makes messages of it.

    Raises InputError where the extra is missing, and for a navigation file without ephemerides.
    """

    def __init__(self, name: str, source: LiveRaw) -> None:
        torn: Counter[str] = Counter()
        super().__init__(name, source, ubx_speech(torn))
        ephemerides = library.broadcast(source.navs, source.url)
        heard = None if source.navs else ephemerides
        epochs = RawIngestCore(air=ephemerides, clock_from_ns=EARLIEST_NS)
        core = library.ubx_core(Placing(ephemerides), heard, epochs)
        self.node = Node(name, core)
        self.faults = lambda: torn + Counter(core.faults)
