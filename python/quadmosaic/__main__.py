"""The command line."""

import signal
import sys

from ._native import command_line


def main() -> int:
    """Does what the arguments ask for; returns the exit code."""
    # Ctrl-C ends the program at once, as it does any other.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command_line(["quadmosaic", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
