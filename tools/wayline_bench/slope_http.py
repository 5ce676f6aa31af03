"""Look-ahead over HTTP at a large map, beside a bare FastAPI endpoint and beside a small map."""

from wayline_bench.eta_http import alternating, answer_us, server
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared
from wayline_bench.slope_map import place_on

LARGE_KM, SMALL_KM = 10_000, 100
PLACE = place_on(1, 20_000.0)
PATH = "/v1/lookahead?lat_deg={:.6f}&lon_deg={:.6f}&heading_deg={:.1f}&length_m=2000".format(*PLACE)
BARE_BAR = 1.0 / 0.55
SMALL_BAR = 1.3
MODULE = "wayline_bench.slope_http_server"


def http_rows(say: Say) -> list[Row]:
    """An answer, where as many as possible are asked for."""
    say(f"a map of {LARGE_KM} km")
    with (
        server(MODULE, f"{LARGE_KM}") as large,
        server(MODULE, f"{SMALL_KM}") as small,
        server(MODULE, "bare") as bare,
    ):
        ports = {"large": large, "small": small, "bare": bare}
        us = alternating(
            ports, lambda port: answer_us(port, PATH), lambda text: say(f"http: {text}")
        )
    what = f"HTTP: 2 km ahead at {LARGE_KM:,} km of map"
    return [
        compared(
            what, us["large"], us["bare"], "bare FastAPI, same bytes", unit="us", bar=BARE_BAR
        ),
        compared(what, us["large"], us["small"], f"at {SMALL_KM} km", unit="us", bar=SMALL_BAR),
    ]
