"""Eta in a replay."""

from wayline.node import Node
from wayline.replayed_drive import ReplayedDrive
from wayline_eta.core import make_eta_core


def node(replay: ReplayedDrive) -> Node:
    """Eta on the drive's route."""
    routes = [replay.route] if replay.route else []
    return Node("eta", make_eta_core(routes, replay.drive.tuning))
