# SPDX-License-Identifier: GPL-3.0-or-later
"""A face driven by a camera."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import live, native, scene_in
from ..scene_out import face_fit
from .muscles import Muscles
from .paragraph import paragraph


class MIMETIC_PT_live(Muscles, Panel):
    bl_idname = "MIMETIC_PT_live"
    bl_label = "Live"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic.live
        session = live.active
        column = layout.column()
        column.enabled = session is None
        self.draw_source(column, context, settings)
        self.draw_person(column, context, settings)
        column.row().prop(settings, "driven", expand=True)
        column.prop(settings, "taught_set", text="Taught")
        if settings.taught_set:
            column.row().prop(settings, "set_use", expand=True)
        layout.prop(settings, "stillness", slider=True)
        fps = 30.0 if session is None else session.thread.source.fps
        figures = native.stillness_figures(settings.stillness, fps)
        layout.label(
            text=iface_("lags {frames:.1f} frames, keeps {share:.0%} of jitter").format(
                frames=figures.lag_frames, share=figures.jitter_share
            )
        )
        layout.column(align=True).prop(settings, "channels")
        row = layout.row()
        row.enabled = session is None
        row.prop(settings, "use_fast_view")
        layout.prop(settings, "countdown")
        self.draw_view(layout, settings)
        if session is None:
            layout.operator("mimetic.live", icon="PLAY")
            return
        row = layout.row(align=True)
        for command, text in (
            ("NEUTRAL", "Neutral"),
            ("RECORD", "End Take" if session.is_recording else "Record"),
            ("STOP", "Stop"),
        ):
            row.operator("mimetic.live_command", text=text).command = command
        paragraph(layout, session.line())

    def draw_person(self, layout, context, settings):
        layout.prop(settings, "use_fit")
        if not settings.use_fit:
            return
        layout.prop(settings, "fit_path")
        if not settings.fit_path:
            clip = live.clip_with_fit(context)
            text = face_fit.summary(clip) if clip else iface_("no fit: a head is searched for")
            paragraph(layout, text)

    def draw_view(self, layout, settings):
        row = layout.row(align=True, heading="In the View")
        row.prop(settings, "show_picture", toggle=True)
        row.prop(settings, "show_plots", toggle=True)
        row = layout.row(align=True)
        row.active = settings.show_picture or settings.show_plots
        row.prop(settings, "view_corner", text="")
        row.prop(settings, "view_size")

    def draw_source(self, layout, context, settings):
        layout.row().prop(settings, "source", expand=True)
        if settings.source == "CAMERA":
            layout.prop(settings, "camera")
            layout.prop(settings, "microphone")
            return
        layout.prop(settings, "clip_path")
        clip = scene_in.clip_of(context)
        if not settings.clip_path:
            paragraph(layout, clip.name if clip else live.NO_SOURCE)


CLASSES = (MIMETIC_PT_live,)
