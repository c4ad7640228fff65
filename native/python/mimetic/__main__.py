# SPDX-License-Identifier: GPL-3.0-or-later
"""The entry point of the command line."""

import sys

from mimetic.shared.interrupts import exit_on_signals, ignore_signals


def main() -> int:
    """Runs the command line; returns the exit status."""
    exit_on_signals()
    from mimetic.commands import cli  # numpy and the core: half a second in which Ctrl-C may come

    status = cli.main()
    ignore_signals()
    return status


if __name__ == "__main__":
    sys.exit(main())
