"""Pure: what papers/001 prints of tight coupling."""

UNAIDED_HZ = 1.2
"""Bandwidth of figure 9's loop."""
FIGURE_8_HZ = (1.0, 0.1)
"""Bandwidths of figure 8, without and with the aid."""
FIGURE_8_DBHZ = 10.0
TRACKING_DB = 3.0
ACQUISITION_DB = 2.0
"""What it says is gained."""
