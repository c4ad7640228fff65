# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scene keeps of what is drawn over footage and along the time."""

from bpy.props import BoolProperty

from . import editors


def _redraw_clips(self, context) -> None:
    editors.redraw("CLIP_EDITOR")


def _redraw_takes(self, context) -> None:
    editors.redraw(*editors.OF_TAKES)


def _redraw_graphs(self, context) -> None:
    editors.redraw("GRAPH_EDITOR")


class ClipOverlaySettings:
    """Mixin of the scene's settings."""

    show_fit: BoolProperty(
        name="Fitted Mesh",
        default=True,
        description="Draw the fitted face over its frames in the clip editor",
        update=_redraw_clips,
    )
    show_capture: BoolProperty(
        name="Captured Face",
        default=True,
        description="Draw the captured face over every frame of its take in the clip editor",
        update=_redraw_clips,
    )
    show_capture_mesh: BoolProperty(
        name="Surface",
        default=True,
        description="The skin's mesh, where nothing covers it",
        update=_redraw_clips,
    )
    show_capture_features: BoolProperty(
        name="Lids, Lips, Irises",
        default=True,
        description="The margins of lids and lips, and the irises' rims",
        update=_redraw_clips,
    )
    show_capture_landmarks: BoolProperty(
        name="Landmarks",
        default=True,
        description="The landmarks that are seen",
        update=_redraw_clips,
    )
    show_quality: BoolProperty(
        name="Quality",
        default=True,
        description="A strip at the bottom of the clip editor and along Timeline, Dope Sheet and "
        "Graph Editor: red where the face was lost and is held, by yellow to green where the "
        "picture is well explained, blue above where you corrected it",
        update=_redraw_takes,
    )
    show_error_bars: BoolProperty(
        name="Error Bars",
        default=True,
        description="Bands in the Graph Editor that hold nine in ten of the true values of the "
        "selected curves, as captured. Orange where pictures cannot tell a muscle from another",
        update=_redraw_graphs,
    )
