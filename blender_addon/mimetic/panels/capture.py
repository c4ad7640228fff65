# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps from footage to file, top to bottom, the same in both editors."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import (
    clip_lens,
    clip_time,
    clips,
    jobs,
    native,
    next_step,
    scene_in,
    scene_out,
    takes,
    targets,
)
from .paragraph import one_line, paragraph


class Capture:
    bl_label = "Mimetic"
    bl_region_type = "UI"
    bl_category = "Mimetic"

    def draw(self, context):
        layout = self.layout
        if reason := native.problem():
            paragraph(layout, reason)
            return
        settings = context.scene.mimetic
        if jobs.running:
            self.draw_running(layout, jobs.running)
        else:
            self.draw_next(layout, settings, next_step.of(context))
        self.draw_footage(layout, context, settings)
        self.draw_capture(layout, context, settings)
        self.draw_bake(layout, context)

    def draw_running(self, layout, run):
        if run.is_endless:
            paragraph(layout, run.text())
            return
        row = layout.row(align=True)
        row.progress(factor=run.fraction, text=run.short_text())
        row.operator("mimetic.stop", text="", icon="X").index = 0
        paragraph(layout, run.what)
        for i, later in enumerate(jobs.waiting, start=1):
            row = layout.row(align=True)
            then = iface_("Then: {job}").format(job=later.name())
            paragraph(row.column(align=True), then, num_beside=1)
            row.operator("mimetic.stop", text="", icon="X").index = i
        keeps, stops = iface_("Esc stops and keeps what is done"), iface_("Esc stops")
        paragraph(layout, keeps if run.keeps_part else stops)

    def draw_next(self, layout, settings, step):
        """What takes the footage further, lit, at the top, where no sidebar is too low for it."""
        if step.operator:
            layout.operator(step.operator, text=step.text, icon="FORWARD", depress=True)
        paragraph(layout, step.beside, "NONE" if step.operator else "CHECKMARK")
        if not step.operator and self.bl_space_type == "CLIP_EDITOR":
            pin = layout.operator("mimetic.pin_skin", icon="PINNED")
            pin.reach = settings.correction_reach

    def draw_footage(self, layout, context, settings):
        row = layout.row(align=True)
        row.operator("mimetic.load_clip", icon="FILE_MOVIE")
        row.operator("mimetic.open_workspace", text="", icon="WORKSPACE")
        clip = scene_in.clip_of(context)
        if getattr(context, "edit_movieclip", None) is None:
            layout.prop(settings, "clip", text="")
        self.draw_rate(layout, context)
        row = layout.row(align=True)
        row.operator("mimetic.find_face", icon="VIEWZOOM")
        row.operator("mimetic.pick_face", text="", icon="EYEDROPPER")
        if clip:
            self.draw_clip(layout, clip)
            self.draw_rest(layout, clip)
            self.draw_lens(layout, clip)
        if scene_in.has_fit(clip):
            self.draw_pins(layout, settings)

    def draw_clip(self, layout, clip):
        """The clip whose face and take the buttons below use."""
        if clips.is_missing(clip):
            paragraph(layout, iface_("{name} is missing").format(name=clip.name), "ERROR")
            layout.operator("mimetic.find_missing")
        paragraph(layout, clips.change_of(clip))
        paragraph(layout, f"{clip.name}: {scene_out.face_fit.summary(clip)}", "FILE_MOVIE")

    def draw_rest(self, layout, clip):
        """Which frame the head is fitted in, and the button for whoever knows a better one."""
        column = layout.column(align=True)
        paragraph(column, scene_out.face_fit.rest_remark(clip))
        shown = column.operator("mimetic.find_face", text="Rest = Shown Frame", icon="TIME")
        shown.use_shown_frame = True

    def draw_lens(self, layout, clip):
        """What it was filmed with; the numbers where they count, which are the clip's own."""
        column = layout.column(align=True)
        column.prop(clip.mimetic, "lens")
        if clip_lens.is_known(clip):
            column.prop(clip.tracking.camera, "focal_length")
            column.prop(clip.tracking.camera, "sensor_width")
        paragraph(column, scene_out.face_fit.lens_remark(clip))
        paragraph(column, clip_lens.unread(clip))

    def draw_rate(self, layout, context):
        """How the clip's time differs from the scene's; nothing while they agree."""
        remark = clip_time.remark(context.scene, scene_in.clip_of(context))
        paragraph(layout, remark, "TIME")
        if remark:
            layout.operator("mimetic.scene_as_clip", icon="PREVIEW_RANGE")

    def draw_pins(self, layout, settings):
        row = layout.row(align=True)
        row.operator("mimetic.pin", icon="PINNED")
        row.operator("mimetic.unpin", icon="UNPINNED")
        row.operator("mimetic.show_landmarks", text="", icon="ADD")
        row.prop(settings, "use_live_pins", text="", icon="FORWARD")
        if not settings.use_live_pins:
            layout.operator("mimetic.follow_pins")

    def draw_capture(self, layout, context, settings):
        layout.prop(settings, "use_frame_range")
        if settings.use_frame_range:
            row = layout.row(align=True)
            row.prop(settings, "frame_first")
            row.prop(settings, "frame_last")
        if scene_out.face_fit.is_calibrated(scene_in.clip_of(context)):
            layout.operator("mimetic.calibrate", text="Calibrate Again", icon="CHECKMARK")
        else:
            layout.operator("mimetic.calibrate", icon="USER")
        row = layout.row(align=True)
        row.operator("mimetic.capture", icon="REC")
        row.operator("mimetic.track_head", text="Head Only")

    def draw_bake(self, layout, context):
        layout.operator("mimetic.load_performance", icon="FILE_FOLDER")
        take = takes.of_clip(context.scene, scene_in.clip_of(context))
        if take and takes.find(take):
            paragraph(layout, takes.name_of(take), "CHECKMARK")
        elif take:
            paragraph(layout, iface_("{name} is missing").format(name=takes.name_of(take)), "ERROR")
            layout.operator("mimetic.find_missing")
        head = targets.bound_head(context)
        text = iface_("Bake on {head}").format(head=head.name) if head else "Bake"
        layout.operator("mimetic.bake", text=one_line(text, 1.5), icon="ACTION")
        row = layout.row(align=True)
        row.operator("mimetic.export_gltf", icon="EXPORT")
        row.operator("mimetic.export_character", text="", icon="FILE_3D")


class MIMETIC_PT_capture_clip(Capture, Panel):
    bl_idname = "MIMETIC_PT_capture_clip"
    bl_space_type = "CLIP_EDITOR"


class MIMETIC_PT_capture_view(Capture, Panel):
    bl_idname = "MIMETIC_PT_capture_view"
    bl_space_type = "VIEW_3D"


CLASSES = (MIMETIC_PT_capture_clip, MIMETIC_PT_capture_view)
