# SPDX-License-Identifier: GPL-3.0-or-later
"""What every bake can do to curves before it keys them."""

from __future__ import annotations

from bpy.app.translations import pgettext_iface as iface_
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty

from .. import native

MIRRORS = (
    ("SWAP", "Swap", "The left does what the right did, and the other way round"),
    ("LEFT", "Left to Right", "Both sides do what the subject's left does"),
    ("RIGHT", "Right to Left", "Both sides do what the subject's right does"),
    ("BOTH", "Symmetrical", "Both sides do the mean of the two"),
)


class CurveOptions:
    """Mixin of operators that bake."""

    CURVES = (
        "Curves",
        ("smoothing", "neutral_frame", "exaggeration", "group_exaggeration", "mirror"),
        False,
    )

    smoothing: FloatProperty(
        name="Smoothing",
        default=0.0,
        min=0.0,
        max=10.0,
        soft_max=1.0,
        precision=3,
        step=1,
        description="Seconds that neighbouring frames of a curve weigh in by, as a standard "
        "deviation; 0 leaves curves as captured. Of muscles, jaw and lips: lids blink too fast",
    )
    neutral_frame: IntProperty(
        name="Neutral Frame",
        default=0,
        min=0,
        description="Footage frame in which the actor's face is what the character's is at rest; "
        "0: none",
    )
    exaggeration: FloatProperty(
        name="Exaggeration",
        default=1.0,
        min=0.0,
        max=10.0,
        soft_max=3.0,
        description="That the expression is multiplied by, within what each muscle can do",
    )
    group_exaggeration: StringProperty(
        name="Of Groups",
        description="Factors of single groups instead, as in: Brow Raisers=1.5, Lip Corners=0.8",
    )

    mirror: EnumProperty(
        name="Mirror",
        items=(("NONE", "No", "Each side does what the actor's does"), *MIRRORS),
        description="What the sides do; the head moves as it did",
    )

    def curve_settings(self):
        """`mimetic.character.curve_settings.CurveSettings` of this call; raises InvalidInput."""
        return native.curve_settings().settings_of(
            self.smoothing,
            self.neutral_frame,
            self.exaggeration,
            self.group_exaggeration,
            "" if self.mirror == "NONE" else self.mirror.lower(),
        )

    def curve_remarks(self) -> list[str]:
        """The same for the list of takes, nothing where curves are as captured."""
        parts = []
        if self.smoothing:
            parts.append(iface_("smoothed over {seconds:.3g} s").format(seconds=self.smoothing))
        if self.neutral_frame:
            parts.append(iface_("neutral in frame {frame}").format(frame=self.neutral_frame))
        if self.exaggeration != 1:
            parts.append(iface_("exaggerated by {factor:.3g}").format(factor=self.exaggeration))
        parts += [self.group_exaggeration] if self.group_exaggeration else []
        how = next((name for key, name, _ in MIRRORS if key == self.mirror), "")
        return [*parts, iface_("mirrored: {how}").format(how=iface_(how))] if how else parts
