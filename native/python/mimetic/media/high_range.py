# SPDX-License-Identifier: GPL-3.0-or-later
"""Movies of high dynamic range (HDR): how ffmpeg brings them to what is seen in others."""

from __future__ import annotations

import re
import subprocess
from typing import NamedTuple

from mimetic.media.ffmpeg import ffmpeg_program

# A line of its own, or a file's title could say it
COLOURS = re.compile(
    rb"^\[Parsed_showinfo[^]\n]*\] color_range:\S+ "
    rb"color_space:(\S+) color_primaries:(\S+) color_trc:(\S+)",
    re.MULTILINE,
)
TRANSFERS = {"arib-std-b67": "HLG", "smpte2084": "PQ"}  # ffmpeg's names -> everyone's
# What HDR is filmed in; any other word is nothing or nonsense, and taken for BT.2020's
PRIMARIES = ("bt2020", "smpte432", "smpte431", "bt709")
MATRICES = ("bt2020nc", "bt709", "bt470bg", "smpte170m")
WHITE = 203  # cd/m2 of what SDR shows as white, by BT.2408: 75 % of HLG, 58 % of PQ
PEAK = 1000 / WHITE  # HLG's own; brighter PQ are lamps
# Up to here, of white's, light is left as it is; above it gets fainter. A face in the sun that is
# cut off at white has activations wrong by .20, with this by .04 (rms; at .5 and .7 too).
# By the curves that films get (Hable, Reinhard) ordinary skin loses contrast, too.
KNEE = 0.6
# Whole colour for each pixel: zscale refuses odd sides of pictures whose colour is at half
# resolution
WHOLE = "|".join(f"{kind}{depth}" for kind in ("yuv444p", "gbrp") for depth in ("", 10, 12, 16))


class HighRange(NamedTuple):
    """How a movie is HDR, `name` "HLG" or "PQ", and the ffmpeg filter that makes it SDR (BT.709).

    filter: None where this ffmpeg cannot do it.
    """

    name: str
    filter: str | None

    def warning(self, clip: str) -> str:
        if self.filter is None:
            return (
                f"{clip} is HDR ({self.name}), which this ffmpeg cannot convert (it has no zscale "
                "or tonemap): skin is seen wrongly; unset IMAGEIO_FFMPEG_EXE, or convert it to SDR"
            )
        return f"{clip} is HDR ({self.name}): it is worked with as SDR, its highlights fainter"


def high_range_of(report: bytes) -> HighRange | None:
    """By showinfo's lines on the first frame; None where they do not say that it is HDR."""
    match = COLOURS.search(report)
    if match is None:
        return None
    matrix, primaries, transfer = (word.decode(errors="replace") for word in match.groups())
    if transfer not in TRANSFERS:
        return None
    if not _can_convert():
        return HighRange(TRANSFERS[transfer], None)
    matrix = matrix if matrix in MATRICES else MATRICES[0]
    primaries = primaries if primaries in PRIMARIES else PRIMARIES[0]
    # All is named: zscale finds no way from colours that are not stated. Its approximate curves
    # (agamma) show red of skin in HLG 2 % too strong, brightness right; exact ones take thrice as
    # long.
    stated = f"tin={transfer}:pin={primaries}:min={matrix}"
    steps = (
        f"format={WHOLE}",
        f"zscale={stated}:t=linear:p=bt709:m=gbr:r=full:npl={WHITE}",
        "format=gbrpf32",
        f"tonemap=mobius:param={KNEE}:peak={PEAK:.4f}:desat=0",
        "zscale=tin=linear:t=bt709:p=bt709:m=gbr:r=full",
        "format=gbrp",
    )
    return HighRange(TRANSFERS[transfer], ",".join(steps))


def _can_convert() -> bool:
    """Whether this ffmpeg, which may be the user's own, has the filters."""
    command = (ffmpeg_program(), "-hide_banner", "-v", "error", "-filters")
    listed = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True).stdout.split()
    return b"zscale" in listed and b"tonemap" in listed
