# SPDX-License-Identifier: GPL-3.0-or-later
"""Facial performance capture: from video to muscle activations and head motion."""

from mimetic._core import InvalidInput, UnreadableMedia, __version__

__all__ = ["InvalidInput", "UnreadableMedia", "__version__"]
