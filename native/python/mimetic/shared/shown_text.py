# SPDX-License-Identifier: GPL-3.0-or-later
"""Text from files as it is shown: on a terminal, in a page, in Blender."""

from __future__ import annotations

import re

# Control characters steer terminals, bidirectional ones turn what is read round, separators break
# lines, and lone surrogates (from names of files that are no UTF-8) cannot be written at all
UNSAFE = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")

LONGEST = 400  # characters of one part of an error


def shown(text: object) -> str:
    """One line that does nothing but read; what would do more is written as \\x1b or \\u202e."""
    return UNSAFE.sub(lambda match: ascii(match[0])[1:-1], str(text))


def shortened(text: object) -> str:
    """An error's text, which may hold any part of a file, `shown` and as long as a line can be."""
    line = shown(text)
    return line if len(line) <= LONGEST else f"{line[:LONGEST]} ..."
