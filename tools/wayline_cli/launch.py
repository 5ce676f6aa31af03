"""Starts the `wayline` command, and says in one line which package an installation lacks."""

import sys


def main() -> None:
    """Run the command; a package that is not installed is one line and status 2."""
    try:
        from wayline_cli.__main__ import main as run  # noqa: PLC0415  -- that is what is tried

        run()
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if not package or package.startswith("wayline"):
            raise
        sys.stderr.write(
            f"wayline: this command needs the package {package}, which is not installed; "
            "in Wayline's folder: pip install --constraint constraints.txt '.[cli]', or '.[all]'\n"
        )
        sys.exit(2)


if __name__ == "__main__":
    main()
