"""The built page (see web/): its files, cached as their names allow."""

import importlib.resources
from pathlib import Path

from fastapi import FastAPI
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

STATIC = Path(str(importlib.resources.files("wayline_dashboard"))) / "static"
FOREVER = "public, max-age=31536000, immutable"
NOT_BUILT = "the page is not built; run `npm ci && npm run build` in services/dashboard/web"


class PageFiles(StaticFiles):
    """Files named by their content's hash stay in the browser; the rest is asked for again."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file, or 404."""
        response = await super().get_response(path, scope)
        is_named_by_hash = path.startswith("assets/")
        response.headers["cache-control"] = FOREVER if is_named_by_hash else "no-cache"
        return response


def add_page(app: FastAPI, folder: Path = STATIC) -> None:
    """Serve the page at `/`; where it was never built, `/` says how to."""
    if (folder / "index.html").is_file():
        app.mount("/", PageFiles(directory=folder, html=True), name="page")
        return

    @app.get("/", include_in_schema=False)
    def missing() -> None:
        raise HTTPException(503, NOT_BUILT)


def is_page(path: str) -> bool:
    """Whether a path is one of the page's files, which are the same for everybody."""
    return path in {"/", "/index.html", "/favicon.svg", "/manifest.webmanifest"} or (
        path.startswith("/assets/")
    )
