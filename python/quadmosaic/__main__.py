"""The command line."""

import os
import signal
import sys

from ._native import command_line


def main() -> int:
    """Does what the arguments ask for; returns the exit code."""
    # Ctrl-C ends the program at once, as it does any other.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if "XDG_RUNTIME_DIR" not in os.environ:
        # On a server without a desktop, a layer that Mesa puts before the driver complains at every start.
        os.environ["NODEVICE_SELECT"] = "1"
    return command_line(["quadmosaic", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
