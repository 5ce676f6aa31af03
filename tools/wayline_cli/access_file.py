"""Writes the access control of a fleet into a router's configuration file, in place.

    python -m wayline_cli.access_file [--certificates] /etc/wayline/server.json5 bus-1 bus-2

With `--certificates` a vehicle has its rights only with a certificate whose common name is its id
(the router's `tls` has to ask for one: `enable_mtls`). Everything else in the file, comments
included, stays as it is.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from wayline.errors import InputError
from wayline_cli.access import access_control

BEGIN, END = "  // access control begins", "  // access control ends"
CERTIFICATES = "--certificates"
USAGE = f"usage: python -m wayline_cli.access_file [{CERTIFICATES}] ROUTER.json5 VEHICLE_ID..."


def rewrite(path: Path, vehicle_ids: Sequence[str], *, certificates: bool = False) -> None:
    """Replace what is between the two marking lines of the file by these vehicles' rules.

    Raises InputError for a vehicle id that is none and for a file without the marking lines.
    """
    table = rendered(vehicle_ids, certificates=certificates)
    text = _read(path)
    head, begin, rest = text.partition(BEGIN)
    marking, _, rest = rest.partition("\n")
    _, end, tail = rest.partition(END)
    if not (begin and end):
        mend = "begin with a copy of deploy/zenoh/server.json5"
        raise InputError(str(path), f"has no lines {BEGIN.strip()!r} and {END.strip()!r}", mend)
    path.write_text(f"{head}{begin}{marking}\n{table}{end}{tail}", encoding="utf-8")


def rendered(vehicle_ids: Sequence[str], *, certificates: bool = False) -> str:
    """The table as an indented member of the file's object."""
    text = json.dumps(
        {"access_control": access_control(vehicle_ids, certificates=certificates)}, indent=2
    )
    members = text.splitlines()[1:-1]
    return "\n".join(members) + ",\n"


def main(arguments: Sequence[str]) -> int:
    """Run the command: 0, or 2 after one line that says what to mend."""
    certificates = CERTIFICATES in arguments
    named = [argument for argument in arguments if argument != CERTIFICATES]
    if not named:
        sys.stderr.write(f"{USAGE}\n")
        return 2
    try:
        rewrite(Path(named[0]), named[1:], certificates=certificates)
    except InputError as error:
        sys.stderr.write(f"wayline: {error}\n")
        return 2
    return 0


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
