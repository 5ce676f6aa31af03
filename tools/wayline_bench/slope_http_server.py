"""A server for `bench slope`: the slope map's answers, or as many bytes from a bare endpoint.

`python -m wayline_bench.slope_http_server KM|bare` prints its port and serves until its input ends.
"""

import sys

from fastapi import FastAPI
from fastapi.testclient import TestClient

from wayline.http_server import HttpServer
from wayline_bench.eta_http_server import ANYWHERE, bare_app
from wayline_bench.slope_http import PATH, SMALL_KM
from wayline_bench.slope_map import made_up_map
from wayline_slope_map.app import create_slope_app
from wayline_slope_map.book import SlopeBook


def our_app(length_km: float) -> FastAPI:
    """The slope map's, of a map so long."""
    book = SlopeBook(made_up_map(1000.0 * length_km))
    return create_slope_app(book, ANYWHERE, drives=lambda *_: None)


def main() -> None:
    """Serve one of them."""
    if sys.argv[1] == "bare":
        body = TestClient(our_app(SMALL_KM), base_url="http://localhost").get(PATH).content
        app = bare_app(body, PATH.partition("?")[0])
    else:
        app = our_app(float(sys.argv[1]))
    with HttpServer(app, ANYWHERE) as server:
        print(server.port, flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
