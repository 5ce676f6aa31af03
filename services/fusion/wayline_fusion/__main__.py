"""The fusion process."""

from argparse import Namespace

from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app
from wayline_fusion.core import FusionCore
from wayline_fusion.live_view import live_view

NAME = "fusion"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured, with its live view where that is wanted."""
    del options
    return Service(
        NAME,
        lambda *_: Node(NAME, FusionCore(settings.tuning)),
        FusionCore.reads,
        watch=live_view(settings),
        make_app=plain_app(NAME, settings),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Filters fixes and vehicle sensors into a pose.", build)


if __name__ == "__main__":
    main()
