# SPDX-License-Identifier: GPL-3.0-or-later
"""Kept expressions are assets that go on any face, blended, mirrored and in sequence."""

import subprocess
import sys
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn

pytestmark = pytest.mark.oldest_and_newest

FPS = 30.0


@pytest.fixture
def face(extension, scene):
    """Our own head with its sliders, at 30 frames a second."""
    scene.render.fps, scene.render.fps_base = 30, 1.0
    head = extension("native").canonical_head().make_head()
    obj = extension("scene_out").canonical.add(scene.collection, head, (0, 0, 0), 0)
    extension("scene_out").canonical.select_only(bpy.context.view_layer, obj)
    return obj


def bump(channels, seconds=1.0, onset=0.2):
    """A rise and fall between onset and the end, in every channel."""
    from mimetic.library.expression import Expression

    t = np.arange(round(FPS * seconds) + 1) / FPS
    shape = np.sin(np.pi * np.clip((t - onset) / (seconds - onset), 0, 1)) ** 2
    values = np.outer(shape, list(channels.values()))
    events = np.array([[onset * FPS, 0.5 * FPS, 0.6 * FPS, 0.8]])
    return Expression(
        list(channels), values, 0 * values, FPS, ["lips"], events, ["clip.mp4", "1 to 31"]
    )


SMILE = {"zygomaticus_major.L": 0.8, "zygomaticus_major.R": 0.6, "jaw_side": 0.3}
BROWS = {"frontalis_middle.L": 0.7, "frontalis_middle.R": 0.7}


@pytest.fixture
def smile(extension):
    return extension("scene_out").expressions.new_asset("smile", bump(SMILE), FPS)


@pytest.fixture
def brows(extension):
    return extension("scene_out").expressions.new_asset("brows", bump(BROWS), FPS)


def values(face):
    return {key.name: key.value for key in face.data.shape_keys.key_blocks}


def played(scene, face, frames):
    """Values by name at frames, as they are shown."""
    rows = []
    for frame in frames:
        scene.frame_set(frame)
        rows.append(values(face))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def test_a_library_becomes_assets_with_pictures(extension, scene, face, tmp_path):
    from mimetic.library.folder import Library

    library = Library(tmp_path / "library")
    library.check_new("smile")
    for name, one in (("smile", bump(SMILE)), ("peak", bump(SMILE).still())):
        library.keep(name, one, np.zeros((8, 8, 4), np.uint8))
    assert bpy.ops.mimetic.load_expressions(directory=str(library.folder)) == {"FINISHED"}
    actions = {action.name: action for action in bpy.data.actions if action.asset_data}
    assert sorted(actions) == ["peak", "smile"]
    assert "clip.mp4" in actions["smile"].asset_data.description
    preview = actions["smile"].preview
    assert tuple(preview.image_size) == (256, 256)
    pixels = np.array(preview.image_pixels_float).reshape(256, 256, 4)
    assert pixels[:8, :8, 3].max() == 0 and pixels[118:138, 118:138, 3].min() > 0.99
    # The file opens as an asset library: by name, without loading all
    path = tmp_path / "assets.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    with bpy.data.libraries.load(str(path), assets_only=True) as (there, _):
        assert sorted(there.actions) == ["peak", "smile"]


def test_what_was_made_an_asset_is_the_same_document_again(extension, smile):
    expressions = extension("scene_out").expressions
    again, first = expressions.document_of(smile), bump(SMILE)
    assert again.channels == first.channels
    np.testing.assert_allclose(again.values, first.values, atol=1e-6)
    assert again.onset_seconds == pytest.approx(first.onset_seconds)


def test_an_expression_blends_from_what_the_face_is(scene, face, smile):
    blocks = face.data.shape_keys.key_blocks
    blocks["zygomaticus_major.L"].value = 0.2
    blocks["frontalis_middle.L"].value = 0.5
    assert bpy.ops.mimetic.apply_expression(action="smile", share=0.5) == {"FINISHED"}
    peak = bump(SMILE).values.max(axis=0)
    assert blocks["zygomaticus_major.L"].value == pytest.approx(
        0.2 + 0.5 * (peak[0] - 0.2), abs=1e-3
    )
    assert blocks["frontalis_middle.L"].value == 0.5  # no part of the smile
    bpy.ops.mimetic.apply_expression(action="smile", share=1.0, is_mirrored=True)
    assert blocks["zygomaticus_major.R"].value == pytest.approx(peak[0], abs=1e-3)
    assert blocks["zygomaticus_major.L"].value == pytest.approx(peak[1], abs=1e-3)
    assert blocks["jaw_side"].value == pytest.approx(-peak[2], abs=1e-3)
    assert face.data.shape_keys.animation_data is None


def test_a_blend_that_blender_ends_leaves_the_face_as_it_was(extension, face, smile):
    kind = extension("operators.expressions").MIMETIC_OT_apply_expression
    block, texts = face.data.shape_keys.key_blocks["zygomaticus_major.L"], []
    blending = SimpleNamespace(_face_name=face.name, _start={block.name: 0.2})
    blending._restore = lambda: kind._restore(blending)
    block.value = 0.7
    workspace = SimpleNamespace(status_text_set=texts.append)
    kind.cancel(blending, SimpleNamespace(workspace=workspace))
    assert block.value == pytest.approx(0.2) and texts == [None]


def test_it_is_keyed_where_that_is_wished(extension, scene, face, smile):
    scene.frame_set(12)
    bpy.ops.mimetic.apply_expression(action="smile", use_key=True)
    curves = extension("compat").curves(face.data.shape_keys).fcurves
    assert {c.data_path.split('"')[1] for c in curves} == set(SMILE)
    assert all(tuple(p.co.x for p in c.keyframe_points) == (12,) for c in curves)


def test_mirrored_twice_is_the_same(extension, smile, face):
    bpy.ops.mimetic.mirror_expression(action="smile")
    bpy.ops.mimetic.mirror_expression(action="smile mirrored")
    document_of = extension("scene_out").expressions.document_of
    again = document_of(bpy.data.actions["smile mirrored mirrored"])
    assert again.channels == list(SMILE)
    np.testing.assert_allclose(again.values, bump(SMILE).values, atol=1e-6)


def test_sequenced_expressions_of_different_clips_play_as_one_of_two_seconds(
    scene, face, smile, brows
):
    scene.frame_set(11)
    assert bpy.ops.mimetic.sequence_expression(action="smile") == {"FINISHED"}
    scene.frame_set(14)
    assert bpy.ops.mimetic.sequence_expression(action="brows", strength=0.5) == {"FINISHED"}
    seen = played(scene, face, range(1, 61))
    lips, raised = seen["zygomaticus_major.L"], seen["frontalis_middle.L"]
    # Each begins to move in the frame that was current
    assert lips[:10].max() < 1e-4 < 0.004 < lips[11:14].max()
    assert raised[:13].max() < 1e-4 and raised.max() == pytest.approx(0.35, abs=0.01)
    assert ((lips > 0.2) & (raised > 0.1)).sum() > 5
    assert lips[-10:].max() < 1e-4 and raised[-10:].max() < 1e-4


def test_a_take_under_an_expression_is_pushed_down_and_goes_on(scene, face, smile):
    keys = face.data.shape_keys
    keys.key_blocks["jaw_open"].value = 0.4
    keys.key_blocks["jaw_open"].keyframe_insert("value", frame=1)
    take = keys.animation_data.action
    scene.frame_set(5)
    bpy.ops.mimetic.sequence_expression(action="smile")
    assert keys.animation_data.action is None
    below, rest, above = (t.strips[0].action for t in keys.animation_data.nla_tracks)
    assert (below, above) == (take, smile) and rest.name == "At Rest"
    seen = played(scene, face, (1, 15))
    assert seen["jaw_open"].tolist() == pytest.approx([0.4, 0.4])
    assert seen["zygomaticus_major.L"][1] > 0.2


def test_strips_compose_to_one_expression_that_never_adds_up(extension, scene, face, smile):
    assert not bpy.ops.mimetic.compose_expressions.poll()
    for frame in (7, 17):
        scene.frame_set(frame)
        bpy.ops.mimetic.sequence_expression(action="smile")
    assert bpy.ops.mimetic.compose_expressions(name="two smiles") == {"FINISHED"}
    tracks = face.data.shape_keys.animation_data.nla_tracks
    assert [track.mute for track in tracks] == [False, True, True, False]
    lips = played(scene, face, range(1, 60))["zygomaticus_major.L"]
    assert 0.7 < lips.max() <= 0.8 + 1e-4  # each alone .8; added up they would reach 1
    assert np.abs(np.diff(lips)).max() < 0.15
    made = extension("scene_out").expressions.document_of(bpy.data.actions["two smiles"])
    assert made.seconds == pytest.approx(1.0 + 10 / 30, abs=0.04)


def test_one_strip_and_one_lost_frame_are_told_as_one(face, smile):
    bpy.ops.mimetic.sequence_expression(action="smile")
    bpy.ops.mimetic.compose_expressions(name="Alone")
    assert result()["message"].startswith("1 strip is Alone, from frame ")
    take = face.mimetic.takes.add()
    take.name, take.num_lost = "take", 1
    assert "quality 0.00, 1 frame lost" in drawn("MIMETIC_PT_takes")


def test_a_still_sequences_as_a_motion_and_other_scene_rates_keep_seconds(extension, scene, face):
    expressions = extension("scene_out").expressions
    expressions.new_asset("peak", bump(SMILE).still(), FPS)
    scene.render.fps = 60
    bpy.ops.mimetic.sequence_expression(action="peak")
    (strip,) = face.data.shape_keys.animation_data.nla_tracks[1].strips
    assert strip.frame_end - strip.frame_start == pytest.approx(1.2 * 60, abs=1.5)
    lips = played(scene, face, range(1, 75))["zygomaticus_major.L"]
    assert lips.max() == pytest.approx(bump(SMILE).values[:, 0].max(), abs=1e-3)
    smile = expressions.new_asset("smile", bump(SMILE), FPS)
    scene.frame_set(101)
    bpy.ops.mimetic.sequence_expression(action="smile")
    strip = next(
        s
        for t in face.data.shape_keys.animation_data.nla_tracks
        for s in t.strips
        if s.action == smile
    )
    assert strip.frame_end - strip.frame_start == pytest.approx(60, abs=0.01)


def test_what_the_face_does_is_kept_still_and_in_motion(extension, scene, face, tmp_path):
    assert bpy.ops.mimetic.keep_expression.poll()
    with pytest.raises(RuntimeError, match="no slider is moved"):
        bpy.ops.mimetic.keep_expression(name="nothing")
    key = face.data.shape_keys.key_blocks["frontalis_middle.L"]
    key.value = 0.6
    bpy.ops.mimetic.keep_expression(name="raised")
    assert [c.data_path for c in extension("compat").curves_in(bpy.data.actions["raised"])] == [
        'key_blocks["frontalis_middle.L"].value'
    ]
    with pytest.raises(RuntimeError, match="no curves"):
        bpy.ops.mimetic.keep_expression(name="x", kind="MOTION", frame_first=1, frame_last=20)
    for frame, value in ((1, 0.1), (10, 0.6), (20, 0.1)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    keep = dict(kind="MOTION", frame_first=1, frame_last=20)
    assert bpy.ops.mimetic.keep_expression(name="raise", **keep) == {"FINISHED"}
    document = extension("scene_out").expressions.document_of(bpy.data.actions["raise"])
    assert document.values[[0, -1]].max() < 1e-6 and document.values.max() == pytest.approx(0.5)
    # And written to a folder, which the command line reads
    assert bpy.ops.mimetic.save_expression(action="raise", directory=str(tmp_path)) == {"FINISHED"}
    from mimetic.library.folder import Library

    again = Library(tmp_path).load("raise")
    np.testing.assert_allclose(again.values, document.values, atol=1e-6)
    with pytest.raises(RuntimeError, match="already"):
        bpy.ops.mimetic.save_expression(action="raise", directory=str(tmp_path))


@pytest.mark.parametrize(
    "options",
    [
        {"use_strips": True},
        {"to": "CONTROLS"},
        {"to": "CONTROLS", "use_contact": True},
        {"to": "CONTROLS", "use_strips": True},
    ],
    ids=lambda options: " ".join(options),
)
def test_a_motion_is_kept_of_whatever_moves_the_face(extension, scene, bake, performance, options):
    expressions = extension("scene_out").expressions
    documents = []
    for name, how in (("curves", {}), ("shown", options)):
        bake(performance, name, **how)
        scene.frame_set(7)
        keep = dict(name="kept", kind="MOTION", frame_first=2, frame_last=39)
        assert bpy.ops.mimetic.keep_expression(**keep) == {"FINISHED"}
        assert scene.frame_current == 7
        documents.append(expressions.document_of(scene.mimetic.expression))
    first, second = documents
    assert len(first.channels) > 30 and second.channels == first.channels
    np.testing.assert_allclose(second.values, first.values, atol=2e-4)  # of bones


def test_keys_that_were_renamed_are_found(scene, face, smile):
    blocks = face.data.shape_keys.key_blocks
    blocks["zygomaticus_major.L"].name = "My Smile"
    bpy.ops.mimetic.apply_expression(action="smile")
    assert blocks["My Smile"].value > 0.7
    blocks["My Smile"].value = 0
    scene.frame_set(1)
    bpy.ops.mimetic.sequence_expression(action="smile")
    assert played(scene, face, (12,))["My Smile"][0] > 0.3


def test_buttons_without_use_say_why(extension, scene):
    assert not bpy.ops.mimetic.mirror_expression.poll()
    smile = extension("scene_out").expressions.new_asset("smile", bump(SMILE), FPS)
    with pytest.raises(RuntimeError, match="has no face"):
        bpy.ops.mimetic.apply_expression(action="smile")
    with pytest.raises(RuntimeError, match="Choose an expression"):
        bpy.ops.mimetic.mirror_expression()
    scene.mimetic.expression = smile
    assert bpy.ops.mimetic.mirror_expression() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="is no expression"):
        bpy.ops.mimetic.mirror_expression(action="nothing of this name")


def test_the_command_writes_a_blend_of_assets(tmp_path):
    from mimetic.library.folder import Library

    library = Library(tmp_path / "library")
    out = tmp_path / "assets.blend"
    command = [sys.executable, "-m", "mimetic", "library", "assets", str(library.folder), "--out"]

    def run(name):
        return subprocess.run([*command, name], capture_output=True, text=True, check=False)

    library.check_new("smile")
    assert run(str(out)).returncode == 2  # empty
    library.keep("smile", bump(SMILE), np.zeros((8, 8, 4), np.uint8))
    ran = run(str(out))
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.endswith("1 assets: smile\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["assets.blend", "library"]
    bpy.ops.wm.open_mainfile(filepath=str(out))
    (action,) = bpy.data.actions
    assert action.asset_data and tuple(action.preview.image_size) == (256, 256)
    assert run(str(tmp_path / "assets.glb")).returncode == 2
