"""A server for `bench eta`: eta's own answers, or as many bytes from a bare FastAPI endpoint.

`python -m wayline_bench.eta_http_server ours|bare` prints its port and serves until its input ends.
"""

import sys
import threading
import time
from itertools import islice

from fastapi import FastAPI, Response
from fastapi.testclient import TestClient

from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings
from wayline.inputs import Tick
from wayline.messages import Message
from wayline.tuning import Tuning
from wayline.view import Receipt
from wayline_bench.eta import poses, town_route
from wayline_bench.eta_http import PATH, VEHICLE
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard
from wayline_eta.core import EtaCore

ANYWHERE = HttpSettings(port=0)
TICK_S = 1.0


def told() -> list[Message]:
    """What eta tells of a vehicle some seconds after it was first seen."""
    core = EtaCore([town_route()], Tuning())
    said: list[Message] = []
    for pose in islice(poses(town_route()), 20):
        core.handle(pose, "bench")
        answers = core.handle(Tick(pose.t_ns), "bench")
        said = [each for each in answers if isinstance(each, Message)]
    return said


def our_app(messages: list[Message]) -> FastAPI:
    """Eta's, of a vehicle that is told of once a second."""
    board = EtaBoard()

    def tell() -> None:
        while True:
            for message in messages:
                board.put(VEHICLE, message, "eta", Receipt(time.monotonic_ns()))
            time.sleep(TICK_S)

    threading.Thread(target=tell, daemon=True).start()
    return create_eta_app(board, [town_route()], ANYWHERE)


def bare_app(body: bytes, path: str = PATH) -> FastAPI:
    """One endpoint that answers with what is there already."""
    app = FastAPI()

    @app.get(path)
    async def bare() -> Response:
        return Response(body, media_type="application/json")

    return app


def main() -> None:
    """Serve one of them."""
    app = our_app(told())
    if sys.argv[1] == "bare":
        app = bare_app(TestClient(app, base_url="http://localhost").get(PATH).content)
    with HttpServer(app, ANYWHERE) as server:
        print(server.port, flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
