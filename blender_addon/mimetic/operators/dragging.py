# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections made by one drag over the footage, seen while the mouse moves."""

from bpy.app.translations import pgettext_iface as iface_

from .. import corrections, editors, native, outcome, scene_in
from .correcting import Correcting


class Dragging(Correcting):
    """Mixin of operators that are told by a drag what `change` makes of them.

    Subclasses: `prepare(context)`, `grab_at(pixel)` and `drag_to(pixel)`, in pixels of the footage.
    """

    hint = ""  # what the status bar says
    heard: frozenset[str] = frozenset()  # keys that `press_key` answers

    def prepare(self, context) -> None:
        """Reads what the first click needs; raises what reading it raises."""

    def press_key(self, kind: str) -> None:
        """One of `heard`, before the drag or in its middle."""

    def invoke(self, context, event):
        if reason := scene_in.no_picture(context):
            return outcome.cancelled(self, context, reason)
        try:
            # Read before the first click is to be answered
            self._size = tuple(map(int, corrections.board(context).stored_size))
            self._before = corrections.of_clip(scene_in.clip_of(context))
            self.prepare(context)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        self._is_dragging = False
        context.window.cursor_modal_set("CROSSHAIR")
        context.workspace.status_text_set(iface_(self.hint))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self._leave(context, False)
        if event.type in self.heard and event.value == "PRESS":
            self.press_key(event.type)
            if self._is_dragging:
                self._show(context)
            return {"RUNNING_MODAL"}
        pixel = scene_in.footage_pixel(context, event.mouse_x, event.mouse_y, self._size)
        if event.type == "LEFTMOUSE" and event.value == "PRESS" and pixel is not None:
            self.grab_at(pixel)
            self._is_dragging = self._show(context)
            return {"RUNNING_MODAL"} if self._is_dragging else self._leave(context, False)
        if self._is_dragging and event.type == "MOUSEMOVE" and pixel is not None:
            self.drag_to(pixel)
            self._show(context)
        if self._is_dragging and event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._leave(context, True)
        return {"RUNNING_MODAL"} if self._is_dragging else {"PASS_THROUGH"}

    def _show(self, context) -> bool:
        """What is stated as it would be now; says whether it can be."""
        clip = scene_in.clip_of(context)
        try:
            frame = self.frame or scene_in.shown_frame(context)
            corrections.keep(clip, self.change(context, self._before, frame))
        except native.known_errors() as error:
            self.report({"WARNING"}, str(error))
            return False
        editors.redraw("CLIP_EDITOR")
        return True

    def _leave(self, context, is_kept: bool):
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        corrections.keep(scene_in.clip_of(context), self._before)
        editors.redraw("CLIP_EDITOR")
        return self.execute(context) if is_kept else {"CANCELLED"}

    def cancel(self, context):
        self._leave(context, False)
