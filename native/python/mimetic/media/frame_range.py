# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of frames as people write them."""

from __future__ import annotations

import re

from mimetic import InvalidInput


def parse_range(text: str) -> tuple[int | None, int | None]:
    """`A:B`, `A:`, `:B` as (first, last), counted from 1; raises InvalidInput."""
    match = re.fullmatch(r"(\d{0,9}):(\d{0,9})", text)
    if not match:
        raise InvalidInput(f"{text!r} is not A:B, such as 10:200")
    first, last = (int(number) if number else None for number in match.groups())
    if first == 0 or (last is not None and last < (first or 1)):
        raise InvalidInput(f"{text!r}: frames count from 1, the first before the last")
    return first, last
