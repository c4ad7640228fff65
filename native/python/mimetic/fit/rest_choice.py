# SPDX-License-Identifier: GPL-3.0-or-later
"""Which frame was taken for the face at rest, and why, in words and in the fit's file."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from mimetic import InvalidInput

UNKNOWN = ""  # a fit of a picture by itself, or from an older file
# By why a frame was taken. The extension looks these up whole, to show them in Blender's language.
TEXTS = {
    UNKNOWN: "Frame {frame} is taken as rest",
    "asked for": "Frame {frame} is taken as rest, as was asked for; {alike} of the {seen} frames "
    "looked at show this expression",
    "relaxed": "Frame {frame} is taken as rest: the face is relaxed there and returns to it; "
    "{alike} of the {seen} frames looked at show this expression",
    "usual": "Frame {frame} is taken as rest: the face looks most at rest there, and {alike} of "
    "the {seen} frames looked at show this expression",
    "frontal": "Frame {frame} is taken as rest: where the face looks more at rest, the head is "
    "turned away; {alike} of the {seen} frames looked at show this expression",
}
RELAXED_ONCE = (
    "Frame {frame} is taken as rest: the face is most relaxed there, but none of the other frames "
    "looked at ({seen} in all) shows this expression; name another frame if it is not at rest"
)
MOST_SEEN = 100_000


@dataclass(frozen=True)
class RestChoice:
    """Of the frame of a fit: why it was taken, and how many frames show its expression."""

    why: str = UNKNOWN  # a key of TEXTS
    seen: int = 0  # frames in which a face was found and compared
    alike: int = 0  # of these, it among them

    @property
    def template(self) -> str:
        return RELAXED_ONCE if self.why == "relaxed" and self.alike == 1 else TEXTS[self.why]

    def text(self, frame: int) -> str:
        return self.template.format(frame=frame, seen=self.seen, alike=self.alike)

    def as_json(self) -> dict:
        return asdict(self) if self.why else {}

    @classmethod
    def from_json(cls, document: object) -> RestChoice:
        """Raises InvalidInput naming the field."""
        if document == {}:
            return cls()
        if not isinstance(document, dict) or sorted(document) != ["alike", "seen", "why"]:
            raise InvalidInput("face fit's rest must be an object with why, seen and alike")
        why, seen, alike = document["why"], document["seen"], document["alike"]
        if not isinstance(why, str) or why == UNKNOWN or why not in TEXTS:
            known = ", ".join(key for key in TEXTS if key)
            raise InvalidInput(f"face fit's rest must have a why of these: {known}")
        if not all(type(count) is int for count in (seen, alike)):
            raise InvalidInput("face fit's rest must have whole numbers seen and alike")
        if not 1 <= alike <= seen <= MOST_SEEN:
            raise InvalidInput(f"face fit's rest must have 1 <= alike <= seen <= {MOST_SEEN}")
        return cls(why, seen, alike)
