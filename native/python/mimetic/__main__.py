# SPDX-License-Identifier: GPL-3.0-or-later
"""The entry point of the command line."""

import os
import sys

from mimetic.shared.interrupts import exit_on_signals, ignore_signals


def main() -> int:
    """Runs the command line; returns the exit status."""
    _fill_streams()
    exit_on_signals()
    from mimetic.commands import cli  # numpy and the core: half a second in which Ctrl-C may come

    status = cli.main()
    ignore_signals()
    return status


def _fill_streams() -> None:
    """Takes the numbers of standard streams that were closed, as by `2>&-`.

    The next file that is opened, a result, would have such a number, and get all that is meant for
    the stream: what signals say is written to number 2 itself.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the least number that is free


if __name__ == "__main__":
    sys.exit(main())
