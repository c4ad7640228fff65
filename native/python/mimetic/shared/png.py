# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures as PNG, without a package for it."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

COLOUR_TYPES = {3: 2, 4: 6}  # channels: PNG's number for them


def png_bytes(picture: NDArray[np.uint8]) -> bytes:
    """A PNG of H x W x 3 (red, green, blue) or x 4 (and opacity)."""
    rows, cols, channels = picture.shape
    lines = np.zeros((rows, 1 + cols * channels), dtype=np.uint8)  # a filter's number before each
    lines[:, 1:] = picture.reshape(rows, -1)
    header = struct.pack(">2I5B", cols, rows, 8, COLOUR_TYPES[channels], 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(content))
        + kind
        + content
        + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in parts
    )
