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
    _drop_unwritten()
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


def _drop_unwritten() -> None:
    """What a closed pipe or a full disk did not take is told by now; Python, as it ends, would try
    once more, and put its own status in the place of ours."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
