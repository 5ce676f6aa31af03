"""The one adapter to Rerun: bus messages become a recording with a map, plots and states."""

from wayline.rerun_view.recording import DEFAULT_PORT, LOOPBACK, RerunRecording
from wayline.rerun_view.view import READS, RerunView

__all__ = ["DEFAULT_PORT", "LOOPBACK", "READS", "RerunRecording", "RerunView"]
