# SPDX-License-Identifier: GPL-3.0-or-later
"""Facial performance capture: from video to muscle activations and head motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mimetic._core import InvalidInput, UnreadableMedia, __version__

__all__ = ["InvalidInput", "UnreadableMedia", "__version__"]


def __getattr__(name: str) -> object:
    """The core's names, loaded on first use: the command line handles Ctrl-C before that."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from mimetic import _core

    return getattr(_core, name)
