# SPDX-License-Identifier: GPL-3.0-or-later
"""What scenes, clips and faces remember of captures: `scene.mimetic`, `movieclip.mimetic`,
`object.mimetic`."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    PointerProperty,
    StringProperty,
)

from . import (
    captured_rows,
    clip_lens,
    compat,
    control_rows,
    correction_settings,
    head_parts,
    mesh_frame,
    take_rows,
    writable,
)
from .clip_overlay_settings import ClipOverlaySettings
from .face_view_settings import FaceViewSettings
from .live_settings import MimeticLive
from .look_settings import MimeticLook
from .scene_out import contact, expressions, gaze, rigs


def _is_mesh(self, candidate) -> bool:
    return candidate.type == "MESH"


def _is_expression(self, candidate) -> bool:
    return expressions.is_expression(candidate)


HEAD_MODES = (
    (
        "RELATIVE",
        "From Rest",
        "The target stays as it is in the rest frame, and moves on from there",
    ),
    (
        "ABSOLUTE",
        "As Filmed",
        "The target is where the camera saw the head; a bone is at rest where the actor faces it",
    ),
)
FACINGS = tuple(
    (axis, axis, f"The target's face looks along {axis}") for axis in ("-Y", "+X", "+Y", "-X")
)


def _choose_bones(self, context) -> None:
    """Fills in an armature's head and neck by their names; whatever is chosen can be changed."""
    self.bone = self.neck = ""
    # A character's head bone turns, and an object goes where the head goes
    self.use_translation = self.target is not None and self.target.type != "ARMATURE"
    if self.target is not None and self.target.type == "ARMATURE":
        bones = rigs.head_bones(self.target)
        self.bone, self.neck = bones.head, bones.neck


class MimeticHead(bpy.types.PropertyGroup):
    """Where the head's motion goes."""

    target: PointerProperty(
        name="Target",
        type=bpy.types.Object,
        update=_choose_bones,
        description="Object, empty or armature that the head's motion goes to",
    )
    bone: StringProperty(name="Head", description="Bone that turns; empty moves the whole armature")
    neck: StringProperty(name="Neck", description="Bone that takes a share of the head's turns")
    neck_share: FloatProperty(
        name="Neck Share",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="Part of the turns that the neck takes; head and neck together turn as filmed",
    )
    mode: EnumProperty(name="Motion", items=HEAD_MODES, description="What the motion starts from")
    rest_frame: IntProperty(
        name="Rest Frame",
        min=0,
        description="Footage frame in which the actor holds the head as the target does at rest; "
        "0 takes the frame in which it is seen best",
    )
    facing: EnumProperty(
        name="Facing", items=FACINGS, description="Where the target's face looks, in its own axes"
    )
    use_translation: BoolProperty(
        name="Translation", default=True, description="Key the target's location too"
    )
    translation_scale: FloatProperty(
        name="Scale",
        default=1.0,
        soft_min=0.0,
        soft_max=10.0,
        description="Of the distances that the head moves",
    )
    pivot: FloatVectorProperty(
        name="Pivot",
        size=3,
        subtype="TRANSLATION",
        unit="LENGTH",
        description="The point whose path is keyed, from midway between the ears: to the person's "
        "left, back, up. A bone at the base of the skull is some 5 cm below",
    )
    smoothing: FloatProperty(
        name="Smoothing",
        default=0.5,
        min=0.0,
        soft_max=3.0,
        description="Strength of smoothing, in the poses' own standard deviations; 0 keeps poses "
        "as they were measured. It looks ahead as far as back, so nothing is delayed",
    )


class MimeticShape(bpy.types.PropertyGroup):
    """A shape key of a face, by the name that it has there, and what it was given last."""

    shape: StringProperty(name="Shape", description="Its name before any was given by hand")
    group: StringProperty(name="Group", description="What its slider is listed under")
    place: IntProperty(default=-1, description="Its number among the keys; -1: nothing is known")
    lowest: FloatProperty(description="Of the slider that it was given")
    highest: FloatProperty(description="Of the slider that it was given")
    points: FloatVectorProperty(size=8, description="Fingerprint of its points")
    offsets: FloatVectorProperty(size=8, description="Fingerprint of its points from the basis")


def _switch_contact(self, context) -> None:
    """On: the key is there and follows; off: it is gone, and so is what it did."""
    face = self.id_data
    if face.data.shape_keys is None or writable.no_shapes(face):
        return
    if self.use_contact:
        contact.ensure_key(face)
    elif key := contact.key_of(face):
        face.shape_key_remove(key)
    face.data.shape_keys.update_tag()


class MimeticLandmark(bpy.types.PropertyGroup):
    """A landmark that muscles were attached by, by its name."""

    vertex: IntProperty(default=-1, description="Vertex that it is, or -1")
    place: FloatVectorProperty(size=3, precision=6, description="Where it was in metres")


YAWS, PITCHES = (-0.873, 0.873), (-0.873, 0.698)  # radians: 50 and 40 degrees


def _gaze_slider(name: str, side: str, axis: int, lowest: float, highest: float):
    """A slider, shown in degrees, for an eye, which five shape keys turn."""

    def get(self) -> float:
        return gaze.angles(self.id_data, side)[axis]

    def turn(self, value: float) -> None:
        angles = list(gaze.angles(self.id_data, side))
        angles[axis] = value
        gaze.set_angles(self.id_data, side, *angles)

    return FloatProperty(
        name=name,
        subtype="ANGLE",
        min=lowest,
        max=highest,
        get=get,
        set=turn,
        options={"SKIP_SAVE"},
        description="Turns the eyeball rigidly, by the shape keys eye_down, eye_left and their "
        "products, on which curves are keyed; the upper lid goes along",
    )


class MimeticPart(bpy.types.PropertyGroup):
    """An object that moves with a head: an eyeball, teeth, the tongue."""

    part: PointerProperty(type=bpy.types.Object, description="The eyeball, teeth or tongue")
    head_from_part: FloatVectorProperty(
        size=16, precision=6, description="Where it was in the head's frame, row by row"
    )
    mesh_frame: PointerProperty(
        type=mesh_frame.MimeticMeshFrame, description="The part's own frame then"
    )


class MimeticFace(take_rows.HasTakes, control_rows.HasControls, bpy.types.PropertyGroup):
    lid_following: FloatVectorProperty(
        size=4,
        description="How the left and the right upper lid go along with the eyes: closure for a "
        "degree downwards, and the pitch at which they do not",
    )
    gaze_yaw_left: _gaze_slider("Left Eye to the Left", "L", 0, *YAWS)
    gaze_pitch_left: _gaze_slider("Left Eye Up", "L", 1, *PITCHES)
    gaze_yaw_right: _gaze_slider("Right Eye to the Left", "R", 0, *YAWS)
    gaze_pitch_right: _gaze_slider("Right Eye Up", "R", 1, *PITCHES)
    control_object: PointerProperty(
        name="Control Object",
        type=bpy.types.Object,
        description="The armature whose bones drive the face's shape keys",
    )
    has_controls: BoolProperty(description="Whether it was given one: it may have been deleted")
    has_lights: BoolProperty(description="Whether it was given lights: they may have been deleted")
    before_preview: StringProperty(options={"HIDDEN"})  # JSON: previewed controls as they were
    landmark: StringProperty(name="Landmark", description="What an empty stands for on a head")
    footage: StringProperty(
        name="Footage", description="Fingerprint of the footage that the face was baked from"
    )
    landmarks: CollectionProperty(
        type=MimeticLandmark, description="What muscles of another head were attached by"
    )
    use_live_landmarks: BoolProperty(
        name="Follow Landmarks",
        default=True,
        description="Attach the muscles again when a landmark was dragged and kept still for half "
        "a second. On, as a drag is meant to be seen; off at first on heads of more than 100,000 "
        "vertices, where that takes longer than 5 seconds",
    )
    others: EnumProperty(
        name="Other Objects",
        items=head_parts.CHOICES,
        description="Which other objects the muscles were attached with",
    )
    metres_from_object: FloatVectorProperty(
        size=16, description="The object's matrix when its muscles were attached, row by row"
    )
    mesh_frame: PointerProperty(
        type=mesh_frame.MimeticMeshFrame,
        description="The frame in which landmarks, parts and the points of shape keys are noted",
    )
    parts: CollectionProperty(
        type=MimeticPart, description="Objects that the muscles were attached with"
    )
    companions: CollectionProperty(
        type=MimeticPart,
        override=writable.KEPT_ROWS,
        description="Other meshes that its takes are on",
    )
    use_contact: BoolProperty(
        name="Contact",
        description="Let lips rest on each other and lids on each other as sliders move",
        update=_switch_contact,
    )
    shapes: CollectionProperty(type=MimeticShape, description="Shape keys that the face was given")
    groups: CollectionProperty(type=MimeticShape, description="Shape keys that move whole groups")
    units: CollectionProperty(
        type=MimeticShape, description="ARKit's shapes that the face was given"
    )
    rest: PointerProperty(type=MimeticShape, description="What the basis was given last")
    num_keys: IntProperty(description="Shape keys after they were given last")
    subdivision: IntVectorProperty(
        size=2, default=(-1, -1), description="Levels given last in viewport and render; -1: none"
    )


class MimeticFootage(
    captured_rows.KeepsCapturedTakes,
    correction_settings.KeepsCorrections,
    bpy.types.PropertyGroup,
):
    """What belongs to footage, by the fingerprint of its content, which is the name."""

    face_fit: StringProperty(
        name="Face Fit",
        description="The person found in the footage: head shape, pose, camera, pins and "
        "calibration, as JSON",
    )


class MimeticClip(clip_lens.HasLens, bpy.types.PropertyGroup):
    """A clip keeps what belongs to each content that its file has had."""

    footage: CollectionProperty(type=MimeticFootage)
    fingerprint: StringProperty(
        name="Fingerprint", description="Of the file's content when something was last kept of it"
    )
    landmarks_of: StringProperty(
        name="Landmarks", description="Fingerprint of the content whose landmarks the tracks show"
    )
    landmark_object: StringProperty(description="Name of the tracking object that has them")
    landmark_offset: IntProperty(
        description="The clip's Frame Offset by which their markers lie on its frames"
    )
    held_by: StringProperty(
        description="Names of the tracks that hold the head still, one in each line"
    )


class MimeticScene(
    FaceViewSettings,
    ClipOverlaySettings,
    correction_settings.CorrectionSettings,
    captured_rows.NamesCapture,
    bpy.types.PropertyGroup,
):
    clip: PointerProperty(
        name="Footage", type=bpy.types.MovieClip, description="Movie clip with the face"
    )
    face_fit: StringProperty(
        name="Face Fit",
        options={"HIDDEN"},
        description="From an earlier version; goes to the clip as the file is opened",
    )
    num_turns: IntProperty(
        name="Turned Views",
        options={"HIDDEN"},
        description="How many times a bake turned 3D views to the camera, for undo and redo",
    )
    use_live_pins: BoolProperty(
        name="Follow Pins",
        default=True,
        description="Fit the face again while landmarks are dragged in the clip editor",
    )
    use_frame_range: BoolProperty(
        name="Part of the Clip", description="Take only some of the footage's frames"
    )
    frame_first: IntProperty(
        name="First",
        default=1,
        min=1,
        description="First footage frame to capture or to calibrate on",
    )
    frame_last: IntProperty(
        name="Last",
        default=100,
        min=1,
        description="Last footage frame to capture or to calibrate on",
    )
    performance_path: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        options={"ANIMATABLE", *compat.RELATIVE_PATH},
        description="Captured performance (.npz) to bake while the scene has no footage",
    )
    expression: PointerProperty(
        name="Expression",
        type=bpy.types.Action,
        poll=_is_expression,
        description="The kept expression that buttons mean",
    )
    face: PointerProperty(
        name="Face",
        type=bpy.types.Object,
        poll=_is_mesh,
        description="The baked face; baking again updates it",
    )
    camera: PointerProperty(
        name="Camera", type=bpy.types.Object, description="The footage's camera in the scene"
    )
    head: PointerProperty(type=MimeticHead)
    live: PointerProperty(type=MimeticLive)


CLASSES = (
    *mesh_frame.CLASSES,
    MimeticHead,
    MimeticLook,
    MimeticLive,
    MimeticShape,
    MimeticLandmark,
    MimeticPart,
    control_rows.MimeticControl,
    *take_rows.CLASSES,
    MimeticFace,
    *captured_rows.CLASSES,
    MimeticFootage,
    MimeticClip,
    MimeticScene,
)


def register() -> None:
    for group in CLASSES:
        bpy.utils.register_class(group)
    bpy.types.Scene.mimetic = PointerProperty(type=MimeticScene)
    bpy.types.MovieClip.mimetic = PointerProperty(type=MimeticClip)
    bpy.types.Object.mimetic = PointerProperty(type=MimeticFace, override=writable.KEPT)


def unregister() -> None:
    del bpy.types.Object.mimetic
    del bpy.types.MovieClip.mimetic
    del bpy.types.Scene.mimetic
    for group in reversed(CLASSES):
        bpy.utils.unregister_class(group)
