"""A Rerun recording of any number of vehicles: to a file, to viewers on this machine, or both."""

import socket
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

import rerun as rr

from wayline.errors import InputError
from wayline.messages import Message
from wayline.rerun_view.blueprint import make_blueprint
from wayline.rerun_view.shapes import NEAR_ZOOM
from wayline.rerun_view.view import RerunView
from wayline.route import Route

APPLICATION_ID = "wayline"
LOOPBACK = "127.0.0.1"
"""Rerun's server knows no passwords, so nothing outside this machine may reach it."""
DEFAULT_PORT = 9876


class RerunRecording:
    """Takes the bus's messages; a vehicle gets its page when its first message comes.

    `save` names a file (.rrd), `port` makes the recording live at `address`; one of them at
    least. Rows wait for `batch_s` of measurement time. Raises InputError for a file that cannot
    be written and for a port that is taken.
    """

    def __init__(
        self,
        *,
        save: Path | None = None,
        port: int | None = None,
        routes: Mapping[str, Sequence[Route]] | None = None,
        batch_s: float = 1.0,
        memory_limit: str = "256MiB",
    ) -> None:
        self._views: dict[str, RerunView] = {}
        self._routes, self._batch_s = routes or {}, batch_s
        self.address: str | None = None
        self._stream = rr.RecordingStream(APPLICATION_ID, recording_id=uuid.uuid4())
        sinks: list[rr.FileSink | rr.GrpcServerSink] = []
        if port is not None:
            _check_port_is_free(port)
            server = rr.GrpcServerSink(
                LOOPBACK, port, newest_first=True, server_memory_limit=memory_limit
            )
            self.address = server.uri
            sinks.append(server)
        if save is not None:
            _check_can_be_written(save)
            sinks.append(rr.FileSink(save))
        if not sinks:
            raise ValueError("a recording needs a file or a port")
        self._stream.set_sinks(*sinks)

    def __enter__(self) -> "RerunRecording":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def rows_sent(self) -> int:
        """Rows sent so far, of all vehicles."""
        return sum(view.rows_sent for view in self._views.values())

    def log(self, vehicle_id: str, message: Message, source: str) -> None:
        """Take one message of the bus."""
        view = self._views.get(vehicle_id) or self._add_vehicle(vehicle_id)
        view.log(message, source)

    def flush(self) -> None:
        """Send what waits for its batch: for a shell whose vehicles have gone quiet."""
        for view in self._views.values():
            view.flush()

    def close(self) -> None:
        """Send what waits, finish the file, stop serving."""
        self.flush()
        if self.address is None and self._views:
            # a file knows at its end how far the vehicles went; a watched map stays as it is
            self._send_blueprint({key: view.extent.zoom() for key, view in self._views.items()})
        self._stream.flush()
        self._stream.disconnect()

    def _add_vehicle(self, vehicle_id: str) -> RerunView:
        routes = self._routes.get(vehicle_id, ())
        view = RerunView(vehicle_id, self._stream, routes=routes, batch_s=self._batch_s)
        self._views[vehicle_id] = view
        self._send_blueprint(dict.fromkeys(self._views, NEAR_ZOOM))
        return view

    def _send_blueprint(self, zooms: Mapping[str, float]) -> None:
        self._stream.send_blueprint(make_blueprint(zooms))


def _check_port_is_free(port: int) -> None:
    """Rerun only logs that it could not listen, and then loses what it is given."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, port))
        except OSError as error:
            reason = error.strerror or str(error)
            mend = "close the viewer or recorder that has it, or name another port"
            raise InputError(f"Rerun's port {port}", reason, mend) from None


def _check_can_be_written(path: Path) -> None:
    try:
        path.open("wb").close()
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(path), reason, "name a file that can be written") from None
