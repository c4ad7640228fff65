# SPDX-License-Identifier: GPL-3.0-or-later
"""One thing is told in the singular. Both texts are translated whole."""


def one_or_many(count: int, one: str, many: str) -> str:
    """The text that fits a count, both translated already; its values are still to be put in."""
    return one if count == 1 else many
