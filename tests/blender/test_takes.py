# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes: a row a bake, which of them plays, two at once, curves that were edited, lost frames."""

import dataclasses

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from test_bake import evaluated_vertices

pytestmark = pytest.mark.oldest_and_newest

LEFT = "muscle_00.L"
KINDS = ("KEYS", "CONTROLS")


def worse(performance):
    """The same clip captured again: half as strong, and lost for a while."""
    quality = np.ones(40)
    quality[[4, 5, 6, 30]] = 0.1
    activations = 0.5 * performance.activations
    return dataclasses.replace(performance, activations=activations, quality=quality)


@pytest.fixture
def other(sheet):
    return worse(sheet)


def value(scene, face, frame: int, name=LEFT) -> float:
    scene.frame_set(frame)
    keys = face.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.shape_keys
    return keys.key_blocks[name].value


def rows(face) -> list[str]:
    return [row.name for row in face.mimetic.takes]


def playing(extension, face) -> str:
    row = extension("scene_out").take_list.playing(face)
    return row.name if row else ""


def edit(extension, face) -> None:
    """Drags one key, as an animator does."""
    curves = extension("scene_out").face_curves.of(face)
    row = next(row for row in curves if row.shape == LEFT)
    row.curve.keyframe_points[10].co.y += 0.05
    row.curve.update()


def test_a_row_says_what_was_captured_how_well_and_how_it_was_baked(extension, bake, other):
    face = bake(other, use_few_keys=True, tolerance=0.05, exaggeration=1.5)
    (row,) = face.mimetic.takes
    assert (row.name, row.first, row.last, row.num_lost) == ("hero", 1, 40, 4)
    assert row.quality == pytest.approx(1.0)
    assert [(lost.first, lost.last) for lost in row.lost] == [(5, 7), (31, 31)]
    assert row.settings == "few keys within 0.05, exaggerated by 1.5"
    assert row.date.startswith("20")
    assert row.performance == "hero.performance.npz"
    assert result()["take"] == "hero"
    bpy.context.view_layer.objects.active = face
    texts = drawn("MIMETIC_PT_takes")
    assert "MIMETIC_UL_takes" in texts
    assert "4 frames lost" in texts
    assert playing(extension, face) == "hero"


@pytest.mark.parametrize("to", KINDS)
def test_each_take_plays_again_as_it_was_baked(extension, scene, bake, sheet, other, to):
    face = bake(sheet, to=to)
    expected = {"hero": [evaluated_vertices(face, frame) for frame in (3, 20)]}
    bake(other, "again", to=to)
    expected["again"] = [evaluated_vertices(face, frame) for frame in (3, 20)]
    assert rows(face) == ["hero", "again"]
    assert np.abs(expected["hero"][0] - expected["again"][0]).max() > 1e-3
    for name in ("hero", "again", "hero"):
        assert bpy.ops.mimetic.play_take(take=name) == {"FINISHED"}
        assert playing(extension, face) == name
        after = [evaluated_vertices(face, frame) for frame in (3, 20)]
        np.testing.assert_allclose(after, expected[name], atol=1e-5)


@pytest.mark.parametrize("to", KINDS)
def test_what_one_take_alone_moves_is_at_rest_in_others(scene, bake, sheet, other, to):
    """A group's strength, keyed by hand in the first one."""
    face = bake(sheet, to=to)
    group = face.mimetic.groups[0].name
    if to == "KEYS":
        key = face.data.shape_keys.key_blocks[group]
        key.value = 0.5
        key.keyframe_insert("value", frame=1)
    else:
        bone = face.mimetic.control_object.pose.bones[group]
        bone["strength"] = 0.5
        bone.keyframe_insert('["strength"]', frame=1)
    assert value(scene, face, 9, group) == pytest.approx(0.5)
    bake(other, "again", to=to)
    assert value(scene, face, 9, group) == 0
    bpy.ops.mimetic.play_take(take="hero")
    assert value(scene, face, 9, group) == pytest.approx(0.5)
    bpy.ops.mimetic.play_take(take="again")
    assert value(scene, face, 9, group) == 0
    bpy.ops.mimetic.play_take(take="hero")
    bpy.ops.mimetic.blend_takes(take="again", over="hero", influence=0.5)
    assert value(scene, face, 9, group) == pytest.approx(0.5)
    bpy.ops.mimetic.play_take(take="again")
    assert value(scene, face, 9, group) == 0


def test_contact_made_for_another_bake_rests_and_is_told(extension, scene, bake, performance):
    face = bake(performance, use_contact=True)
    entries = [entry for entry in face.mimetic.shapes if entry.group == "Contact"]
    name = entries[0].name
    values = [value(scene, face, frame, name) for frame in range(1, 41)]
    assert np.ptp(values) > 0.01
    bake(worse(performance), "again", use_contact=True)
    assert bpy.ops.mimetic.play_take(take="hero") == {"FINISHED"}
    assert "bake it again" in result()["message"]
    if name in face.data.shape_keys.key_blocks:
        assert np.ptp([value(scene, face, frame, name) for frame in range(1, 41)]) == 0
    assert bpy.ops.mimetic.play_take(take="again") == {"FINISHED"}
    assert "bake it again" not in result()["message"]
    assert not any(c.mute for c in extension("compat").curves(face.data.shape_keys).fcurves)


@pytest.mark.parametrize("to", KINDS)
def test_edited_curves_are_kept_and_the_new_take_plays(extension, scene, bake, sheet, to):
    face = bake(sheet, to=to)
    edit(extension, face)
    before = value(scene, face, 11)
    bake(sheet, "again", to=to)
    assert rows(face) == ["hero", "again"]
    assert playing(extension, face) == "again"
    assert "hero was edited: it is kept in Baked Takes, again plays" in result()["message"]
    assert face.mimetic.takes["hero"].is_edited
    assert abs(value(scene, face, 11) - before) > 0.04
    bpy.ops.mimetic.play_take(take="hero")
    assert value(scene, face, 11) == pytest.approx(before, abs=1e-6)


def test_an_edited_take_plays_on_or_goes_as_the_call_says(extension, scene, bake, sheet):
    face = bake(sheet)
    edit(extension, face)
    before = value(scene, face, 11)
    bake(sheet, "again", edited="KEEP")
    assert playing(extension, face) == "hero"
    assert value(scene, face, 11) == pytest.approx(before, abs=1e-6)
    assert "hero was edited and plays on, again waits" in result()["message"]
    names = {action.name for action in bpy.data.actions}
    bake(sheet, "third", edited="REPLACE")
    assert rows(face) == ["again", "third"]
    assert playing(extension, face) == "third"
    assert "hero is replaced, edits and all" in result()["message"]
    assert {"hero muscles", "hero head"} <= names - {action.name for action in bpy.data.actions}


def test_a_take_nobody_touched_is_replaced_where_asked_alone(extension, bake, sheet, other):
    face = bake(sheet)
    bake(other)
    assert rows(face) == ["hero", "hero.002"]
    bake(other, replace_take=True)
    assert rows(face) == ["hero", "hero.002"]
    assert playing(extension, face) == "hero.002"
    assert "hero.002 is replaced" in result()["message"]


def test_a_take_is_not_edited_by_saving_and_opening(extension, bake, sheet, tmp_path):
    face = bake(sheet, use_few_keys=True)
    name = face.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    face = bpy.data.objects[name]
    for row in extension("scene_out").face_curves.of(face):
        row.curve.update()
    takes = extension("scene_out").take_list
    assert not takes.is_edited(face.mimetic.takes["hero"])
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.offset_curves(amount=0.01) == {"FINISHED"}
    assert takes.is_edited(face.mimetic.takes["hero"])


@pytest.mark.parametrize("to", KINDS)
def test_two_takes_stand_side_by_side_at_the_same_time(extension, scene, bake, sheet, other, to):
    face = bake(sheet, to=to)
    bake(other, "again", to=to)
    alone = {}
    for name in ("hero", "again"):
        bpy.ops.mimetic.play_take(take=name)
        alone[name] = {frame: evaluated_vertices(face, frame) for frame in (3, 20)}
    assert bpy.ops.mimetic.compare_take(take="hero") == {"FINISHED"}
    twin = bpy.data.objects[result()["copy"]]
    assert playing(extension, face) == "again"
    assert playing(extension, twin) == "hero"
    for frame in (3, 20):
        np.testing.assert_allclose(
            evaluated_vertices(face, frame), alone["again"][frame], atol=1e-5
        )
        apart = evaluated_vertices(twin, frame) - alone["hero"][frame]
        assert np.linalg.norm(apart.mean(axis=0)) == pytest.approx(0.25, abs=1e-3)
        np.testing.assert_allclose(apart, np.tile(apart.mean(axis=0), (len(apart), 1)), atol=1e-5)


@pytest.mark.parametrize("to", KINDS)
@pytest.mark.parametrize("scale", [1, 0.01])
def test_a_copy_stands_beside_under_a_parent_that_turns(extension, scene, bake, sheet, to, scale):
    face = bake(sheet, to=to)
    parent = bpy.data.objects.new("Root", None)
    scene.collection.objects.link(parent)
    parent.rotation_euler, parent.scale = (0, 0.3, 1.5), (scale,) * 3
    mover = face.mimetic.control_object or face
    mover.parent = parent
    mover.scale = (1 / scale,) * 3
    expected = evaluated_vertices(face, 3)
    assert bpy.ops.mimetic.compare_take(take="hero") == {"FINISHED"}
    apart = evaluated_vertices(bpy.data.objects[result()["copy"]], 3) - expected
    np.testing.assert_allclose(apart, np.tile([0.25, 0, 0], (len(apart), 1)), atol=1e-4)


@pytest.mark.parametrize("to", KINDS)
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_a_take_is_blended_over_another(extension, scene, bake, sheet, other, to, share):
    face = bake(sheet, to=to)
    bake(other, "again", to=to)
    options = {"take": "again", "over": "hero", "influence": share}
    assert bpy.ops.mimetic.blend_takes(**options) == {"FINISHED"}
    mean = (1 - share) * sheet.activations[:, 0] + share * other.activations[:, 0]
    for frame in (1, 7, 40):
        assert value(scene, face, frame) == pytest.approx(mean[frame - 1], abs=1e-5)
    bpy.ops.mimetic.play_take(take="hero")
    assert value(scene, face, 7) == pytest.approx(sheet.activations[6, 0], abs=1e-5)
    tracks = face.data.shape_keys.animation_data.nla_tracks
    assert not len(tracks)


def test_tracks_of_the_users_own_stay(extension, scene, bake, sheet, other):
    face = bake(sheet)
    animation = face.data.shape_keys.animation_data
    animation.nla_tracks.new().name = "mine"
    bake(other, "again")
    bpy.ops.mimetic.blend_takes(take="hero")
    bpy.ops.mimetic.play_take(take="hero")
    assert [track.name for track in animation.nla_tracks] == ["mine"]


@pytest.mark.parametrize("to", KINDS)
@pytest.mark.parametrize("rate", [(25, 1.0), (24000, 1001.0)])
def test_a_bake_as_strips_plays_the_same(extension, scene, bake, sheet, to, rate):
    scene.render.fps, scene.render.fps_base = round(rate[0] / rate[1]), 1.0
    scene.render.fps_base = scene.render.fps / (rate[0] / rate[1])
    face = bake(sheet, to=to)
    before = {frame: evaluated_vertices(face, frame) for frame in (1, 8, 35)}
    bake(sheet, "strips", to=to, use_strips=True)
    assert playing(extension, face) == "strips"
    for frame, vertices in before.items():
        np.testing.assert_allclose(evaluated_vertices(face, frame), vertices, atol=2e-5)
    bake(sheet, "after", to=to)
    assert rows(face) == ["hero", "strips", "after"]
    assert playing(extension, face) == "after"


def test_lost_frames_are_marked_and_the_users_markers_stay(extension, scene, bake, sheet, other):
    scene.timeline_markers.new("Lost", frame=3)
    bake(sheet)
    bake(other, "again", use_lost_markers=False)
    assert [marker.frame for marker in scene.timeline_markers] == [3]
    assert bpy.ops.mimetic.mark_lost(take="again") == {"FINISHED"}
    assert result()["num_ranges"] == 2
    marks = sorted((marker.frame, marker.name) for marker in scene.timeline_markers)
    lost, back = "Lost (Mimetic)", "Seen Again (Mimetic)"
    assert marks == [(3, "Lost"), (5, lost), (8, back), (31, lost), (32, back)]
    bpy.ops.mimetic.play_take(take="hero")  # never lost
    assert [marker.frame for marker in scene.timeline_markers] == [3]
    bpy.ops.mimetic.mark_lost(take="again")
    assert bpy.ops.mimetic.unmark_lost() == {"FINISHED"}
    assert [marker.frame for marker in scene.timeline_markers] == [3]
    assert bpy.ops.mimetic.unmark_lost() == {"CANCELLED"}


def test_a_bake_marks_lost_frames_of_the_take_that_plays(extension, scene, bake, sheet, other):
    def marked() -> list[int]:
        return [marker.frame for marker in scene.timeline_markers]

    face = bake(other)
    assert sorted(marked()) == [5, 8, 31, 32]
    assert result()["num_ranges"] == 2
    assert "2 lost ranges are marked" in result()["message"]
    edit(extension, face)
    bake(sheet, "again", edited="KEEP")  # the edited one, which has lost frames, plays on
    assert sorted(marked()) == [5, 8, 31, 32]
    bake(sheet, "again")
    assert marked() == []
    bake(other)
    bake(other, use_lost_markers=False)
    assert marked() == []


def test_a_removed_take_leaves_no_actions_and_others_as_they_are(extension, bake, sheet, other):
    face = bake(sheet)
    bake(other, "again")
    action = face.data.shape_keys.animation_data.action
    assert bpy.ops.mimetic.remove_take(take="hero") == {"FINISHED"}
    assert result()["actions"] == ["hero muscles", "hero head"] or sorted(result()["actions"]) == [
        "hero head",
        "hero muscles",
    ]
    assert rows(face) == ["again"]
    assert face.data.shape_keys.animation_data.action == action
    with pytest.raises(RuntimeError, match="no take hero: it has again"):
        bpy.ops.mimetic.play_take(take="hero")


def test_what_cannot_play_is_said_and_changes_nothing(extension, scene, bake, sheet):
    for name in ("play_take", "compare_take", "blend_takes", "remove_take", "mark_lost"):
        with pytest.raises(RuntimeError, match="press Bake first"):
            getattr(bpy.ops.mimetic, name)()
    face = bake(sheet)
    bake(sheet, "bones", to="CONTROLS")
    with pytest.raises(RuntimeError, match="press Remove Control Object first"):
        bpy.ops.mimetic.play_take(take="hero")
    assert playing(extension, face) == "bones"
    with pytest.raises(RuntimeError, match="bones plays already"):
        bpy.ops.mimetic.blend_takes(take="bones")
    bpy.data.actions.remove(face.mimetic.takes["hero"].parts["KEYS"].action)
    bpy.ops.mimetic.remove_control_object()
    with pytest.raises(RuntimeError, match="actions of hero were removed"):
        bpy.ops.mimetic.play_take(take="hero")


def test_two_actors_in_a_scene_have_their_own_takes(extension, scene, bake, sheet):
    marks = {actor: f"1-{actor * 64}" for actor in "ab"}
    actors = [
        dataclasses.replace(sheet, footage=[f"{actor}.mp4", mark]) for actor, mark in marks.items()
    ]
    first = bake(actors[0], "anna")
    second = bake(actors[1], "ben")
    assert first != second
    bake(actors[0], "anna again")
    assert (rows(first), rows(second)) == (["a", "a.002"], ["b"])
    assert playing(extension, second) == "b"
    assert [row.clip for row in first.mimetic.takes] == ["a.mp4", "a.mp4"]


def test_a_character_of_ones_own_has_takes(extension, scene, acted, bake):
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    head = bpy.context.active_object
    scene.mimetic.performance_path = acted[1]
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert bpy.ops.mimetic.bake(exaggeration=0.5) == {"FINISHED"}
    assert rows(head) == ["hero", "hero.002"]
    name = acted[0].muscles[0]
    assert value(scene, head, 12, name) == pytest.approx(
        0.5 * acted[0].activations[11, 0], abs=1e-5
    )
    bpy.ops.mimetic.play_take(take="hero")
    assert value(scene, head, 12, name) == pytest.approx(acted[0].activations[11, 0], abs=1e-5)


@pytest.mark.parametrize("to", KINDS)
def test_lost_ranges_go_along_with_a_take_that_is_retimed(extension, scene, bake, other, to):
    def marked() -> list[int]:
        return sorted(marker.frame for marker in scene.timeline_markers)

    face = bake(other, to=to)
    bpy.context.view_layer.objects.active = face
    assert marked() == [5, 8, 31, 32]
    assert bpy.ops.mimetic.retime_curves(side="LEFT", factor=2.0) == {"FINISHED"}
    assert marked() == [5, 8, 31, 32]
    bpy.ops.mimetic.retime_curves(side="LEFT", factor=0.5)
    assert bpy.ops.mimetic.retime_curves(factor=2.0, frames_later=100.0) == {"FINISHED"}
    assert marked() == [109, 114, 161, 162]
    (row,) = face.mimetic.takes
    assert (row.scene_first, row.scene_last) == (101, 179)
    assert [(lost.first, lost.last) for lost in row.lost] == [(109, 113), (161, 161)]
    bpy.ops.mimetic.unmark_lost()
    bpy.ops.mimetic.retime_curves(frames_later=-100.0)
    assert marked() == []
    bpy.ops.mimetic.mark_lost()
    assert marked() == [9, 14, 61, 62]
