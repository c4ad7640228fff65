# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of things, in words."""


def counted(number: int, thing: str) -> str:
    """As in "1 clip", "2 clips"; thing: the word for one, whose plural is with an s."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"
