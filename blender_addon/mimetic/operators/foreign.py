# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import StringProperty
from bpy.types import Operator

from .. import native, outcome, scene_in, scene_out
from ..jobs import Job


class MIMETIC_OT_add_landmarks(Operator):
    """Put an empty for each landmark near its place on the active head, to be moved there"""

    bl_idname = "mimetic.add_landmarks"
    bl_label = "Add Landmarks"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_foreign_head(context):
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context):
        head = context.active_object
        if empties := scene_in.landmark_empties(context.scene, head):
            message = f"There are landmarks for {head.name}: {', '.join(empties)}"
            return outcome.cancelled(self, context, message)
        parts = native.foreign_face()
        try:
            places = parts.guess_landmarks(scene_in.world_points(head))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        scene_out.foreign.add(context.collection, head, places)
        message = f"{len(places)} landmarks: put each in its place, then Attach Muscles"
        return outcome.finished(self, context, message, object=head.name, landmarks=sorted(places))


class MIMETIC_OT_attach_muscles(Job, Operator):
    """Give the active head sliders for muscles, jaw, lids and gaze. Its landmarks are empties or
    vertex groups with their names, or a file"""

    bl_idname = "mimetic.attach_muscles"
    bl_label = "Attach Muscles"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(
        name="Landmarks",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
        description="JSON file, name to vertex or place; empty takes empties and vertex groups",
    )

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_foreign_head(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        path = bpy.path.abspath(self.filepath) if self.filepath else ""
        return scene_in.foreign_head(context.scene, context.active_object), path

    def work(self, inputs, progress):
        head, path = inputs
        parts = native.foreign_face()
        landmarks = head.landmarks
        if path:
            from pathlib import Path

            landmarks = native.landmarks_file().read_landmarks(Path(path))
        polygons = parts.Polygons(head.starts, head.corners)
        try:
            face = parts.attach_face(head.points, polygons, landmarks, head.matrix, progress)
        except KeyboardInterrupt:  # stopped: half a face is none
            return None
        return head, landmarks, face

    def write(self, context, result):
        head, landmarks, face = result
        object_ = bpy.data.objects.get(head.name)
        if object_ is None or len(object_.data.vertices) != len(head.points):
            raise native.foreign_face().InvalidInput(
                f"{head.name} was changed meanwhile: attach its muscles again"
            )
        hand_changes = scene_out.foreign.attach(object_, head, landmarks, face)
        for note in face.notes:
            self.report({"WARNING"}, f"{head.name}: {note}")
        num_sliders = len(face.shapes) + len(face.groups)
        self.facts = {"object": head.name, "num_sliders": num_sliders, "notes": list(face.notes)}
        message = f"{head.name} has {num_sliders} sliders: sidebar, Mimetic, Muscles"
        return "; ".join(filter(None, (message, hand_changes)))


CLASSES = (MIMETIC_OT_add_landmarks, MIMETIC_OT_attach_muscles)
