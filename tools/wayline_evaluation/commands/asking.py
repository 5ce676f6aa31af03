"""What the commands of `wayline evaluate` have in common: options, progress, reports."""
# ruff: noqa: PLC0415

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from wayline.errors import InputError

if TYPE_CHECKING:
    import msgspec
    from rich.table import Table

FILE_WIDTH = 120
"""Where no terminal sets a width, tables are not cut."""
Drives = Annotated[list[Path], typer.Argument(help="Drives' folders (with drive.toml).")]
Out = Annotated[Path | None, typer.Option(help="Keep the replays in this folder.")]
Json = Annotated[Path | None, typer.Option("--json", help="File for programs to read.")]
Plot = Annotated[Path | None, typer.Option(metavar="FILE.png", help="Picture to write.")]
Jobs = Annotated[int, typer.Option(min=1, help="Replays at a time.")]
Yardstick = Annotated[
    bool,
    typer.Option("--yardstick", help="Compare with a filter that is told a simulation's noise."),
]

Without = Annotated[
    str | None,
    typer.Option(metavar="PART,...", help="Withhold these: can, gyro, course, speed (of fixes)."),
]


def check_targets(json: Path | None, plot: Path | None) -> None:
    """Raise InputError for files that cannot be written, before the work and not after it."""
    from matplotlib.backend_bases import FigureCanvasBase

    for option, path in (("--json", json), ("--plot", plot)):
        if path is not None and not path.parent.is_dir():
            raise InputError(option, f"there is no folder {path.parent}", "make it or name another")
        if path is not None and path.is_dir():
            raise InputError(option, f"{path} is a folder", "name a file in it")
    kinds = FigureCanvasBase.get_supported_filetypes()
    if plot is not None and plot.suffix.lstrip(".").lower() not in kinds:
        mend = f"give one of {', '.join(f'.{kind}' for kind in sorted(kinds))}"
        raise InputError("--plot", f"{plot} is no kind of picture that can be written", mend)


def tell(tables: "Iterable[Table]", report: "msgspec.Struct", json: Path | None) -> None:
    """Print tables, and write the report where a file is named. Raises InputError."""
    from msgspec import json as codec

    console = Console()
    if not console.is_terminal:
        console = Console(width=FILE_WIDTH)
    for table in tables:
        console.print(table)
        console.print()
    if json is not None:
        try:
            json.write_bytes(codec.format(codec.encode(report), indent=2) + b"\n")
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError("--json", reason, "name a file that can be written") from None


@contextmanager
def progress(what: str = "replays") -> Iterator[Callable[[int, int], None]]:
    """Shows on a terminal how many of several pieces of work are done."""
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(what)

        def progressed(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        yield progressed
