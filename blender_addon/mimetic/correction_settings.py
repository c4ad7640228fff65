# SPDX-License-Identifier: GPL-3.0-or-later
"""What clips and scenes remember of corrections."""

from bpy.props import FloatProperty, StringProperty

from . import corrections


class KeepsCorrections:
    """Mixin of what belongs to footage."""

    corrections: StringProperty(
        name="Corrections",
        description="What was corrected in single frames, as JSON (docs/guide/corrections.md)",
    )


class CorrectionSettings:
    """Mixin of the scene's settings: what the panel's buttons correct."""

    correction_name: StringProperty(
        name="Value",
        default="jaw_open",
        search=corrections.value_names,
        description="What Correct means: jaw, lid, lips' shape, gaze, muscle; lip_gap is in metres",
    )
    correction_reach: FloatProperty(
        name="Reach",
        default=8.0,
        min=1.0,
        soft_max=60.0,
        max=1000.0,
        description="Frames before and after from which on nothing of a correction counts",
    )
