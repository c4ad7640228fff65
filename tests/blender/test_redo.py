# SPDX-License-Identifier: GPL-3.0-or-later
"""The redo panel undoes an operator and runs it again at once, before anything is evaluated."""

import json
from dataclasses import dataclass, field

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix
from scene_state import assert_same, curves_of, in_window, state
from test_attach_muscles import new_head, put_landmarks
from test_corrections import captured  # noqa: F401
from test_expressions import BROWS, bump, face, smile  # noqa: F401
from test_head import rig  # noqa: F401
from test_head_parts import _piece
from test_own_controls import character, played  # noqa: F401
from test_pins import drag, found, select  # noqa: F401

STANDS = Matrix.Translation((1, 2, 3)) @ Euler((0.3, 0.2, 1.0)).to_matrix().to_4x4()


def redo(**changed) -> None:
    """As F9 does it, after some of the last operator's properties were changed there."""
    last = bpy.context.window_manager.operators[-1]
    for name, value in changed.items():
        setattr(last.properties, name, value)
    in_window(bpy.ops.ed.undo_redo)


def other_values(operator, of_case: dict) -> dict:
    """For every setting that the redo panel shows, another value than it has."""
    last = bpy.context.window_manager.operators[-1].properties
    blenders = {"rna_type", *bpy.types.Operator.bl_rna.properties.keys()}
    others = {}
    for shown in operator.get_rna_type().properties:
        if shown.is_hidden or shown.identifier in blenders:
            continue
        if shown.identifier in of_case:
            others[shown.identifier] = of_case[shown.identifier]
        elif shown.type != "STRING":  # names are of something that is there
            others[shown.identifier] = other_value(shown, getattr(last, shown.identifier))
    return others


def other_value(shown, value):
    if shown.type == "BOOLEAN":
        return not value
    if shown.type == "ENUM":
        return next(item for item in reversed(shown.enum_items.keys()) if item != value)
    if getattr(shown, "is_array", False):
        return tuple(one + 1.0 for one in value)
    step = 1 if shown.type == "INT" else 0.25
    return value + step if value + step <= shown.hard_max else value - step


@dataclass
class Case:
    """An operator, what it needs in the scene, and with what it is called."""

    name: str
    prepare: object
    options: dict = field(default_factory=dict)  # of which each is a fixture's name
    values: dict = field(default_factory=dict)
    others: dict = field(default_factory=dict)  # that its settings are changed to


def with_face(fixture, of="performance_file", **options) -> None:
    """A face that was baked before, seen by a camera that has a place of its own."""
    scene = bpy.context.scene
    scene.mimetic.performance_path = str(fixture(of))
    assert bpy.ops.mimetic.bake(**options) == {"FINISHED"}
    scene.mimetic.camera.matrix_world = STANDS


def with_plain_face(fixture) -> None:
    """For what reads its curves alone."""
    with_face(fixture, "sheet_file", use_contact=False, use_texture=False)


def with_takes(fixture) -> None:
    """A face with two takes, of which the second plays; both were lost for a while."""
    with_plain_face(fixture)
    options = {"use_contact": False, "use_texture": False}
    assert bpy.ops.mimetic.bake(exaggeration=0.5, **options) == {"FINISHED"}
    for row in bpy.context.scene.mimetic.face.mimetic.takes:
        lost = row.lost.add()
        lost.first, lost.last = 5, 7


def with_marks(fixture) -> None:
    with_takes(fixture)
    assert bpy.ops.mimetic.mark_lost() == {"FINISHED"}


def with_bound_head(fixture) -> None:
    """A head with sliders that is not the scene's own face."""
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    head = bpy.context.active_object
    head.matrix_world = STANDS
    bpy.context.scene.mimetic.performance_path = fixture("acted")[1]


def with_sliders(fixture) -> None:
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    bpy.context.active_object.matrix_world = STANDS


def with_looks(fixture) -> None:
    """To be taught, the first one chosen, and sliders for it."""
    with_sliders(fixture)
    bpy.context.scene.mimetic.face = bpy.context.active_object
    assert bpy.ops.mimetic.add_usual_looks() == {"FINISHED"}


def with_control_object(fixture, of="sheet_file") -> None:
    """A face that a control object drives by a take of its own."""
    bpy.context.scene.mimetic.performance_path = str(fixture(of))
    assert bpy.ops.mimetic.bake(to="CONTROLS") == {"FINISHED"}


def with_own_head_and_control_object(fixture) -> None:
    with_control_object(fixture, "performance_file")


def with_captured(fixture) -> None:
    """A clip with its take, at a captured frame."""
    fixture("captured")


def with_correction(fixture) -> None:
    fixture("captured")
    assert bpy.ops.mimetic.correct_value(value_name="jaw_open", value=0.4) == {"FINISHED"}


def with_corrections(fixture) -> None:
    with_correction(fixture)
    assert bpy.ops.mimetic.correct_value(frame=20, value_name="jaw_open", value=0.4) == {"FINISHED"}


def with_own_head(fixture) -> None:
    points, faces, _ = fixture("parts")
    new_head(points, faces.tolist())


def with_landmarks(fixture) -> None:
    with_own_head(fixture)
    from mimetic.template.face_template import load_template

    head, parts = bpy.context.active_object, fixture("parts")
    put_landmarks(head, parts)
    template = load_template()
    points, faces = _piece(parts, template.part_vertices("eye.L"))
    mesh = bpy.data.meshes.new("eye")
    mesh.from_pydata(points, [], faces)
    eye = bpy.data.objects.new("eye", mesh)
    bpy.context.scene.collection.objects.link(eye)
    eye.parent = head


def with_rig(fixture) -> None:
    scene, rig = bpy.context.scene, fixture("rig")  # noqa: F811
    rig.matrix_world = STANDS @ Matrix.Scale(2, 4)
    scene.mimetic.performance_path = str(fixture("sheet_file"))
    scene.mimetic.head.target = rig


def with_moving_rig(fixture) -> None:
    with_rig(fixture)
    bpy.context.scene.mimetic.head.use_translation = True


def with_empty(fixture) -> None:
    """Held by a parent and as filmed by a camera."""
    with_plain_face(fixture)
    scene = bpy.context.scene
    parent, target = (bpy.data.objects.new(name, None) for name in ("parent", "target"))
    for added in (parent, target):
        scene.collection.objects.link(added)
    parent.matrix_world = STANDS
    target.parent = parent
    target.location = (0.1, 0.2, 0.3)
    scene.mimetic.head.target = target
    scene.mimetic.head.mode = "ABSOLUTE"


def with_clip(fixture) -> None:
    bpy.ops.mimetic.load_clip(filepath=str(fixture("footage")))
    bpy.ops.mimetic.load_performance(filepath=str(fixture("sheet_file")))
    bpy.context.scene.frame_set(7)


def with_dragged_landmark(fixture) -> None:
    clip = fixture("found")
    drag(clip, "mouth_corner.L", 5)
    select(clip, "mouth_corner.L", "lip_upper")


def with_pin(fixture) -> None:
    with_dragged_landmark(fixture)
    bpy.ops.mimetic.follow_pins()


def with_expression(fixture) -> None:
    fixture("face")
    fixture("smile")


def with_strips(fixture) -> None:
    with_expression(fixture)
    for frame in (1, 20):
        bpy.context.scene.frame_set(frame)
        bpy.ops.mimetic.sequence_expression(action="smile")


def with_character(fixture) -> None:
    """A head with shape keys of its maker's, and a performance."""
    fixture("character")
    bpy.context.scene.mimetic.performance_path = str(fixture("played"))


def with_controls(fixture) -> None:
    with_character(fixture)
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    bpy.context.active_object.mimetic.controls["mouthSmileLeft"].gain = 1.5


@pytest.fixture
def preset(tmp_path):
    path = tmp_path / "hero.json"
    row = {"control": "jawOpen", "gain": 0.5, "highest": 0.3}
    path.write_text(json.dumps({"format": "mimetic controls 1", "controls": [row]}))
    return path


@pytest.fixture
def library_folder(tmp_path):
    from mimetic.library.folder import Library

    library = Library(tmp_path / "library")
    library.check_new("brows")
    library.keep("brows", bump(BROWS), np.zeros((8, 8, 4), np.uint8))
    return library.folder


MOTION = {"kind": "MOTION", "frame_first": 1, "frame_last": 20}
CASES = [
    Case("bake", with_face),
    Case("bake", with_bound_head),
    Case("bake", with_own_head_and_control_object),
    Case("add_control_object", with_sliders),
    Case("remove_control_object", with_control_object),
    Case("bake_head", with_rig),
    Case("bake_head", with_moving_rig),
    Case("bake_head", with_empty),
    Case("find_head_bones", with_rig),
    Case("set_rest_frame", with_clip),
    Case("hold_head_still", with_clip),
    Case("load_clip", lambda fixture: None, {"filepath": "footage"}),
    Case("load_performance", lambda fixture: None, {"filepath": "performance_file"}),
    Case("pin", with_dragged_landmark),
    Case("unpin", with_pin),
    Case("follow_pins", with_dragged_landmark),
    Case("correct_value", with_captured, values={"value_name": "jaw_open", "value": 0.4}),
    Case("correct_pose", with_captured, values={"turn": (0.0, 5.0, 0.0)}),
    Case("drag_pose", with_captured, values={"shift": (0.01, 0.0, 0.0)}),
    Case("pin_skin", with_captured, values={"grab": (200.0, 160.0), "to": (205.0, 160.0)}),
    Case("delete_correction", with_corrections, others={"frame": 20}),
    Case("add_landmarks", with_own_head),
    Case("attach_muscles", with_landmarks),
    Case("add_arkit_shapes", with_landmarks),
    Case("add_face", lambda fixture: None),
    Case("add_look", lambda fixture: None, values={"look": "OWN"}, others={"look": "smile"}),
    Case("remove_look", with_looks),
    Case("take_sliders", with_looks),
    Case("rest_face", with_face),
    Case("reduce_keys", with_plain_face),
    Case("play_take", with_takes, values={"take": "take"}),
    Case("remove_take", with_takes, values={"take": "take"}),
    Case("compare_take", with_takes, values={"take": "take"}),
    Case("blend_takes", with_takes, values={"take": "take"}),
    Case("mark_lost", with_takes),
    Case("unmark_lost", with_marks),
    Case("smooth_curves", with_plain_face),
    Case("exaggerate_curves", with_control_object, values={"factor": 1.5}),
    Case("offset_curves", with_plain_face, values={"by": "NEUTRAL"}),
    Case("mirror_curves", with_control_object),
    Case("retime_curves", with_plain_face, values={"factor": 2.0, "frames_later": 3.0}),
    Case("fit_controls", with_controls),
    Case("bake_controls", with_controls),
    Case("mirror_controls", with_controls),
    Case("load_controls", with_controls, {"filepath": "preset"}),
    Case("load_expressions", lambda fixture: None, {"directory": "library_folder"}),
    Case("apply_expression", with_expression, values={"action": "smile", "share": 0.5}),
    Case("mirror_expression", with_expression, values={"action": "smile"}),
    Case("keep_expression", with_plain_face, values={"name": "kept"}, others=MOTION),
    Case("sequence_expression", with_expression, values={"action": "smile"}),
    Case("compose_expressions", with_strips, values={"name": "both"}),
]


@pytest.mark.oldest_and_newest
@pytest.mark.parametrize("case", CASES, ids=[f"{c.name}-{c.prepare.__name__}" for c in CASES])
def test_the_redo_panel_gives_what_a_call_does(extension, request, case):
    """Left as it is what came at first; with every setting changed what a call with these gives;
    and an undo leaves nothing of either."""
    case.prepare(request.getfixturevalue)
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    before = state(extension)
    options = {name: str(request.getfixturevalue(of)) for name, of in case.options.items()}
    options |= case.values
    operator = getattr(bpy.ops.mimetic, case.name)
    assert operator("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    at_first = state(extension)
    redo()
    assert_same(at_first, state(extension))
    others = other_values(operator, case.others)
    if others:
        redo(**others)
        changed = state(extension)
        with pytest.raises(AssertionError):
            assert_same(at_first, changed)
    in_window(bpy.ops.ed.undo)
    assert_same(before, state(extension))
    if others:
        assert operator("EXEC_DEFAULT", True, **(options | others)) == {"FINISHED"}
        assert_same(changed, state(extension))


def test_all_operators_with_a_redo_panel_are_tried(extension):
    names = {
        operator.bl_idname.partition(".")[2]
        for operator in extension("operators").CLASSES
        if "REGISTER" in getattr(operator, "bl_options", ())
    }
    assert names == {case.name for case in CASES}


def test_detail_ticked_in_the_redo_panel_leaves_the_face_in_the_shot(extension, performance_file):
    with_face(lambda name: performance_file)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.bake("EXEC_DEFAULT", True) == {"FINISHED"}
    before = curves_of(extension, bpy.context.scene.mimetic.face)
    redo(use_detail=True, subdivision=2)
    assert_same(before, curves_of(extension, bpy.context.scene.mimetic.face))
    assert bpy.context.scene.mimetic.face.modifiers["Subdivision"].levels == 2


def test_a_hidden_camera_stands_where_it_was_put(extension):
    """Blender evaluates nothing that is switched off in the view layer."""
    scene = bpy.context.scene
    parent, camera = (bpy.data.objects.new(name, None) for name in ("dolly", "camera"))
    for added in (parent, camera):
        scene.collection.objects.link(added)
        added.hide_viewport = True
    camera.parent = parent
    parent.location, camera.location = (1, 2, 3), (0, 0, 4)
    place = extension("world").matrix(camera).translation
    np.testing.assert_allclose(place, (1, 2, 7), atol=1e-6)
