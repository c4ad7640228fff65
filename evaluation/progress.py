# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a command is, beside what it prints."""

import sys


def to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
