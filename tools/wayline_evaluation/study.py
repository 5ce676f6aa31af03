"""`scripts/study`: figures of today's filters on all shipped scenarios, beside the yardstick."""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from wayline.errors import InputError
from wayline_evaluation.commands.asking import progress
from wayline_evaluation.figures import figures_of
from wayline_evaluation.scenario_plan import study_drives
from wayline_evaluation.scenario_study import study
from wayline_evaluation.scenario_table import markdown, yardstick_lines
from wayline_evaluation.studied import Studied
from wayline_simulator.scenario_file import shipped_scenarios

TABLE_NAME, DRIVES_NAME = "study.md", "study.json"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; bad input is one line and status 2."""
    options = _parser().parse_args(arguments)
    try:
        shipped = list(shipped_scenarios())
        if unknown := [name for name in options.only if name not in shipped]:
            raise InputError("--only", f"{unknown[0]} is not known", f"give {', '.join(shipped)}")
        drives = study_drives(options.only or shipped, 1 if options.quick else options.seeds)
        with progress("drives") as progressed:
            studied = study(drives, options.out, options.jobs, progressed)
        text = "\n".join([*markdown(studied), "", *yardstick_lines(studied)]) + "\n"
        _keep(options.out, text, studied)
    except InputError as error:
        sys.stderr.write(f"study: {error}\n")
        sys.exit(2)
    print(text, end="")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="study", description=__doc__)
    parser.add_argument("out", type=Path, help="folder for the drives, study.md and study.json")
    parser.add_argument("--quick", action="store_true", help="the same as --seeds 1")
    seeds = "drives of each scenario, three times as many where outages are pooled"
    parser.add_argument("--seeds", type=int, default=2, help=seeds)
    parser.add_argument("--jobs", type=int, default=1, help="drives at a time")
    parser.add_argument("--only", action="append", default=[], help="a scenario; may be repeated")
    return parser


def _keep(out: Path, text: str, studied: Sequence[Studied]) -> None:
    rows = msgspec.json.format(msgspec.json.encode(list(_rows(studied))), indent=1)
    try:
        (out / TABLE_NAME).write_text(text, encoding="utf-8")
        (out / DRIVES_NAME).write_bytes(rows + b"\n")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(out), reason, "name a folder that can be written") from None


def _rows(studied: Sequence[Studied]) -> Iterator[dict[str, object]]:
    """Each drive by itself: where the worst of a scenario is to be found."""
    for each in studied:
        yield {
            "drive": each.drive.name,
            "horizontal_m": {
                name: figures_of(errors.horizontal_m) for name, errors in each.errors.items()
            },
            "bars": {name: _finite(value) for name, value in each.bars.items()},
            "outages": each.outages,
        }


def _finite(value: float | None) -> float | str | None:
    return "never" if value is not None and math.isinf(value) else value


if __name__ == "__main__":
    main()
