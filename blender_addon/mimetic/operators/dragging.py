# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections made by one drag over the footage, seen while the mouse moves."""

from bpy.app.translations import pgettext_iface as iface_

from .. import corrections, editors, native, outcome, scene_in, writable
from .correcting import Correcting


class Dragging(Correcting):
    """Mixin of operators that are told by a drag what `change` makes of them.

    Subclasses: `prepare(context)`, `grab_at(pixel)` and `drag_to(pixel)`, in pixels of the footage.
    """

    hint = ""  # what the status bar says
    heard: frozenset[str] = frozenset()  # keys that `press_key` answers
    num_begun = 0  # of all drags: one waits for its click at a time

    def prepare(self, context) -> None:
        """Reads what a drag begins from, at its click; raises what reading it raises."""

    def press_key(self, kind: str) -> None:
        """One of `heard`, before the drag or in its middle."""

    def invoke(self, context, event):
        if reason := scene_in.no_picture(context):
            return outcome.cancelled(self, context, reason)
        try:
            # The take is read before the first click is to be answered
            self._size = tuple(map(int, corrections.board(context).stored_size))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        self._is_dragging, self._clip = False, None
        Dragging.num_begun += 1
        self._number = Dragging.num_begun
        context.window.cursor_modal_set("CROSSHAIR")
        context.workspace.status_text_set(iface_(self.hint))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        try:
            return self._handle(context, event)
        except BaseException:
            self.cancel(context)  # nothing half made stays, and no cursor
            raise

    def _handle(self, context, event):
        if self._number != Dragging.num_begun and not self._is_dragging:
            return {"CANCELLED", "PASS_THROUGH"}  # another was begun instead
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self._leave(context, False)
        if event.type in self.heard and event.value == "PRESS":
            self.press_key(event.type)
            if self._is_dragging:
                self._show(context)
            return {"RUNNING_MODAL"}
        if not self._is_dragging:
            return self._wait(context, event)
        if event.type == "MOUSEMOVE":
            pixel = self._pixel(context, event, self._clip)
            if pixel is not None:
                self.drag_to(pixel)
                self._show(context)
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._leave(context, True)
        return {"RUNNING_MODAL"}

    def _wait(self, context, event):
        """For the click; editors may have come and gone since the button was pressed."""
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        area = scene_in.footage_area(context, event.mouse_x, event.mouse_y)
        pixel = self._pixel(context, event)
        if area is None or pixel is None:
            return {"PASS_THROUGH"}
        clip = area.spaces.active.clip
        with context.temp_override(edit_movieclip=clip):
            self._is_dragging = self._grab(context, event, clip)
        return {"RUNNING_MODAL"} if self._is_dragging else self._leave(context, False)

    def _pixel(self, context, event, clip=None):
        place = event.mouse_x, event.mouse_y
        area = scene_in.footage_area(context, *place, clip)
        return scene_in.footage_pixel(area, *place, self._size) if area is not None else None

    def _grab(self, context, event, clip) -> bool:
        """Begins the drag: clip, frame and corrections may be others than at the button."""
        self._frame = self.frame or scene_in.shown_frame(context)
        try:
            writable.check(self.obstacle(context))
            self._size = tuple(map(int, corrections.board(context).stored_size))
            self._before = corrections.of_clip(clip)
            self.prepare(context)
        except native.known_errors() as error:
            self.report({"WARNING"}, str(error))
            return False
        self._clip = clip
        self.grab_at(self._pixel(context, event, clip))
        return self._show(context)

    def _show(self, context) -> bool:
        """What is stated as it would be now; says whether it can be."""
        try:
            with context.temp_override(edit_movieclip=self._clip):
                now = self.change(context, self._before, self._frame)
            corrections.keep(self._clip, now)
        except native.known_errors() as error:
            self.report({"WARNING"}, str(error))
            return False
        editors.redraw("CLIP_EDITOR")
        return True

    def _leave(self, context, is_kept: bool):
        self._is_dragging, self._number = False, 0  # an exception ends no operator by itself
        if context.window is not None:
            context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        clip, self._clip = self._clip, None
        editors.redraw("CLIP_EDITOR")
        if clip is None:
            return {"CANCELLED"}
        corrections.keep(clip, self._before)
        if not is_kept:
            return {"CANCELLED"}
        with context.temp_override(edit_movieclip=clip):
            return self.execute(context)

    def cancel(self, context):
        self._leave(context, False)
