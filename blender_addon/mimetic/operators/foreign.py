# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty
from bpy.types import Operator

from .. import control_preview, head_parts, heads, native, plural, scene_out, writable
from ..jobs import Job


class WithParts:
    """Mixin of operators that move a head's parts along."""

    others: EnumProperty(
        name="Other Objects",
        items=head_parts.CHOICES,
        description="Which meshes inside of the head's box are moved with its face",
    )


class MIMETIC_OT_add_landmarks(Job, Operator):
    """Find the landmarks of the active head, whichever way it looks, and put an empty at each. Drag
    those that are off; the doubtful ones are marked"""

    bl_idname = "mimetic.add_landmarks"
    bl_label = "Add Landmarks"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def obstacle(cls, context):
        return heads.no_foreign_head(context) or writable.no_objects(context.scene)

    def read(self, context):
        head = heads.active_head(context)
        if empties := heads.landmark_empties(context.scene, head):
            message = rpt_("There are landmarks for {head}: {names}").format(
                head=head.name, names=", ".join(empties)
            )
            raise native.invalid_input(message)
        return heads.foreign_head(context.scene, head)

    def work(self, head, progress):
        find = native.self_landmarks().find_on_object
        try:
            return head, find(*head.whole, head.matrix, progress)
        except KeyboardInterrupt:
            return None

    def write(self, context, result):
        head, landmarks = result
        object_ = heads.unchanged(head)
        doubtful = landmarks.doubtful
        scene_out.foreign.add(context, object_, landmarks.places, doubtful)
        self.facts = {
            "object": object_.name,
            "landmarks": sorted(landmarks.places),
            "doubtful": doubtful,
        }
        count = len(landmarks.places)
        if landmarks.guess:
            self.report({"WARNING"}, f"{object_.name}: {landmarks.guess}")
            return rpt_(
                "{count} landmarks, guessed: move each to its place, then Attach Muscles"
            ).format(count=count)
        if doubtful:
            return rpt_("{count} landmarks; look at {names}, then Attach Muscles").format(
                count=count, names=", ".join(doubtful)
            )
        return rpt_("{count} landmarks: check them, then Attach Muscles").format(count=count)


class MIMETIC_OT_attach_muscles(WithParts, Job, Operator):
    """Give the active head sliders for muscles, jaw, lids and gaze; ARKit's shapes that it has from
    here go along. Its landmarks are empties or vertex groups with their names, or a file"""

    bl_idname = "mimetic.attach_muscles"
    bl_label = "Attach Muscles"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(
        name="Landmarks",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
        description="JSON file, name to vertex or place; empty takes empties and vertex groups",
    )

    obstacle = staticmethod(heads.no_foreign_head)

    def read(self, context):
        path = bpy.path.abspath(self.filepath) if self.filepath else ""
        obj = heads.active_head(context)
        has_units = len(obj.mimetic.units) > 0
        return heads.foreign_head(context.scene, obj, self.others), path, has_units

    def work(self, inputs, progress):
        head, path, has_units = inputs
        landmarks = head.landmarks
        if path:
            from pathlib import Path

            landmarks = native.landmarks_file().read_landmarks(Path(path))
        face = _attached(head, landmarks, progress)
        if face is None:
            return None
        units, notes = face.unit_shapes() if has_units else ((), ())
        return head, landmarks, face, units, notes

    def write(self, context, result):
        head, landmarks, face, units, notes_of_units = result
        object_ = heads.unchanged(head)
        was_shown = control_preview.is_moving(object_)
        if was_shown:  # it was fitted to the muscles of before
            control_preview.end()
        attached = scene_out.foreign.attach(object_, head, landmarks, face, units)
        object_.mimetic.others = self.others
        notes = [*face.notes, *notes_of_units, *attached.notes]
        for note in notes:
            self.report({"WARNING"}, f"{head.name}: {note}")
        num_sliders = len(face.shapes) + len(face.groups)
        self.facts = {
            "object": head.name,
            "num_sliders": num_sliders,
            "notes": notes,
            "parts": attached.parts,
            "worn": list(head.worn),
        }
        message = rpt_("{name} has {num_sliders} sliders: sidebar, Mimetic, Muscles").format(
            name=head.name, num_sliders=num_sliders
        )
        ended = rpt_("the preview has ended: Preview shows it anew") if was_shown else ""
        worn = scene_out.part_keys.of_worn(head)
        remarks = (_along(attached.parts), worn, attached.hand_changes, ended)
        return "; ".join(filter(None, (message, *remarks)))


class MIMETIC_OT_add_arkit_shapes(WithParts, Job, Operator):
    """Give the active head ARKit's 52 blend shapes as shape keys. Its own keys stay; those that it
    was given here before are made again, but for changes by hand"""

    bl_idname = "mimetic.add_arkit_shapes"
    bl_label = "Add ARKit Shapes"
    bl_options = {"REGISTER", "UNDO"}

    obstacle = staticmethod(heads.no_bound_head)

    def read(self, context):
        return heads.bound_head(context.scene, heads.active_head(context), self.others)

    def work(self, head, progress):
        face = _attached(head, head.landmarks, progress)
        return None if face is None else (head, face.unit_shapes())

    def write(self, context, result):
        head, (shapes, notes) = result
        object_ = heads.unchanged(head)
        written = scene_out.arkit.give(object_, head, shapes)
        notes = [*notes, *written.notes]
        for note in notes:
            self.report({"WARNING"}, f"{object_.name}: {note}")
        self.facts = {
            "object": object_.name,
            "num_sliders": len(written.names),
            "notes": notes,
            "parts": written.parts,
            "worn": list(head.worn),
        }
        message = rpt_("{name} has {count} of ARKit's shapes").format(
            name=object_.name, count=len(written.names)
        )
        if written.parts:
            message += f"; {_along(written.parts)}"
        if worn := scene_out.part_keys.of_worn(head):
            message += f"; {worn}"
        if kept := written.kept:
            message += plural.one_or_many(
                len(kept),
                rpt_("; 1 key of such a name stays as it was: {names}"),
                rpt_("; {count} keys of such names stay as they were: {names}"),
            ).format(count=len(kept), names=", ".join(kept[:4]))
        changes = written.hand_changes.text()
        return f"{message}; {changes}" if changes else message


def _along(parts: list[str]) -> str:
    """Which objects move with the head's keys."""
    return rpt_("{names} moved along").format(names=", ".join(parts)) if parts else ""


def _attached(head, landmarks, progress):
    """A head's `mimetic.character.foreign_face.ForeignFace`; None if it was stopped."""
    parts = native.foreign_face()
    try:
        return parts.attach_face(*head.whole, landmarks, head.matrix, progress)
    except KeyboardInterrupt:
        return None


CLASSES = (
    MIMETIC_OT_add_landmarks,
    MIMETIC_OT_attach_muscles,
    MIMETIC_OT_add_arkit_shapes,
)
