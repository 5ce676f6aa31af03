"""`wayline demo`: the whole system live here, with a recorded shuttle and a simulated truck."""

import os
import sys
import threading
import webbrowser
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from wayline.ending import Ending, ending_on_signals
from wayline.errors import InputError
from wayline.services import SERVICES
from wayline_cli.demo_files import LOOPBACK, Demo, check_ports, choose_ports, prepare
from wayline_cli.demo_ready import await_live
from wayline_cli.journal import Journal, journal_in
from wayline_cli.up import keep_running
from wayline_dashboard.page import NOT_BUILT, STATIC

OURS = "WAYLINE_"


def demo(
    *,
    keep: Path | None = None,
    first_port: int | None = None,
    open_page: bool = True,
    seconds: float | None = None,
    say: Callable[[str], None] = print,
) -> None:
    """Run the demo until SIGTERM, Ctrl-C or the end of `seconds`; `say` is told in lines.

    Raises InputError for a port that is taken, a folder that cannot be used, a missing part.
    """
    if seconds is not None and not seconds > 0.0:
        raise InputError("--seconds", f"{seconds:g} is not positive", "give how long to run")
    with ending_on_signals() as ending, _folder(keep) as folder:
        ports = choose_ports(first_port)
        check_ports(ports)
        ready = prepare(folder, ports)
        _forget_overrides()
        with journal_in(folder) as journal:
            say(f"starting a router and the services; what they say is in {journal.path}")
            _run(ready, journal, ending, seconds, open_page=open_page, say=say)


def _forget_overrides() -> None:
    """The demo is a world of its own: it must not write into a real vehicle's database or bus."""
    for name in [name for name in os.environ if name.startswith(OURS)]:
        del os.environ[name]


def _run(
    demo_: Demo,
    journal: Journal,
    ending: Ending,
    seconds: float | None,
    *,
    open_page: bool,
    say: Callable[[str], None],
) -> None:
    host = threading.Thread(
        target=_welcome, args=(demo_, journal, ending), kwargs={"open_page": open_page, "say": say}
    )
    clock = threading.Timer(seconds or 0.0, ending.request)
    if seconds is not None:
        clock.start()
    host.start()
    try:
        keep_running(demo_.stages, ending, journal.note)
    finally:
        ending.request()
        clock.cancel()
        host.join()


def _welcome(
    demo_: Demo, journal: Journal, ending: Ending, *, open_page: bool, say: Callable[[str], None]
) -> None:
    for absent in await_live(demo_, ending):
        say(f"still waiting for {', '.join(absent)}")
        for line in journal.last_words(absent):
            say(f"  {line}")
    if ending.requested:
        return
    is_built = (STATIC / "index.html").is_file()
    say("\n".join(addresses(demo_, is_built=is_built)))
    if open_page and is_built and has_display(os.environ, sys.platform):
        show(page_address(demo_))


def page_address(demo_: Demo) -> str:
    """Where the page is."""
    return f"http://{LOOPBACK}:{demo_.ports.http['dashboard']}"


def addresses(demo_: Demo, *, is_built: bool) -> list[str]:
    """Where to look, line by line."""
    page, http = page_address(demo_), demo_.ports.http
    apis = [(row.shows, name) for name, row in SERVICES.items() if row.shows]
    rerun = f"rerun+http://{LOOPBACK}:{demo_.ports.rerun}/proxy"
    return [
        "",
        f"  Wayline is live    {page}" if is_built else f"  Wayline is live, but {NOT_BUILT}",
        *(f"  {title:<16}   http://{LOOPBACK}:{http[name]}/docs" for title, name in apis),
        f"  Rerun              rerun {rerun}"
        if demo_.has_rerun
        else '  Rerun              not installed: pip install "wayline[rerun]"',
        "  end it with Ctrl-C",
        "",
    ]


def has_display(environment: Mapping[str, str], platform: str) -> bool:
    """Whether a browser would have a window; one for terminals would take over this one."""
    if platform in {"darwin", "win32"}:
        return True
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def show(address: str) -> None:
    """Open the page; whoever has no browser has read the address."""
    try:
        webbrowser.open(address)
    except (webbrowser.Error, OSError):
        return


@contextmanager
def _folder(keep: Path | None) -> Iterator[Path]:
    """A folder to keep, or one that is removed in the end."""
    if keep is None:
        with TemporaryDirectory(prefix="wayline-demo-") as name:
            yield Path(name)
        return
    try:
        keep.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(keep), reason, "name a folder that can be written") from None
    yield keep.resolve()
