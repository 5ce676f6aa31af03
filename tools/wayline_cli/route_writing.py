"""Writes imported routes: one file, or a folder with one a route."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

from wayline.errors import InputError
from wayline.route import Route
from wayline.route_file import write_route


def is_folder(out: Path) -> bool:
    """Whether an output is meant to be a folder: it is one, or its name has no suffix."""
    return out.is_dir() or (not out.exists() and not out.suffix)


def write_routes(routes: Sequence[Route], out: Path) -> Iterator[tuple[Path, Route]]:
    """Write every route and say where. Raises InputError where that cannot be written."""
    if len(routes) == 1 and not is_folder(out):
        write_route(routes[0], out)
        yield out, routes[0]
        return
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        what = f"cannot be made ({error.strerror})"
        raise InputError(str(out), what, "name another folder") from None
    for route in routes:
        path = out / f"{quote(route.route_id, safe=' ')}.geojson"
        write_route(route, path)
        yield path, route
