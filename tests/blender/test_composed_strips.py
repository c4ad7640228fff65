# SPDX-License-Identifier: GPL-3.0-or-later
"""A composition plays as its strips did, whatever was done to them in the NLA."""

import bpy
import numpy as np
import pytest
from test_expressions import BROWS, SMILE, brows, bump, face, played, smile  # noqa: F401

pytestmark = pytest.mark.oldest_and_newest

LONG = {
    "Cyrillic": "Улыбка до ушей, прищур, медленно, потом голова, дубль 3",
    "Chinese": "满面笑容眯着眼睛慢慢转向镜头然后再看左边点头",
    "accents": "Sourire très large, les yeux plissés, tête penchée vers la gauché é",
    "letters": "Smile, wide, eyes narrowed, head tilted to the left, slow release, take 3",
}


def cut(strip, first=0.0, last=1.0) -> None:
    length = strip.action_frame_end
    strip.action_frame_end = round(last * length)
    strip.action_frame_start = round(first * length)


def fade(strip) -> None:
    strip.blend_in, strip.blend_out = 8, 11


def key(strip, name: str, **values: float) -> None:
    """Keys of the strip's own curve by frames: f7=.2."""
    setattr(strip, f"use_animated_{name.removeprefix('strip_')}", True)
    curve = strip.fcurves.find(name)
    for frame, value in values.items():
        curve.keyframe_points.insert(float(frame[1:]), value)


def turn(strip) -> None:
    strip.use_reverse = True


def repeat(strip, times=2.0, scale=1.0) -> None:
    strip.repeat, strip.scale = times, scale


CHANGES = {
    "as it is": lambda strip: None,
    "reversed": turn,
    "cut off": lambda strip: cut(strip, last=0.5),
    "begun late": lambda strip: cut(strip, first=0.6),
    "repeated": repeat,
    "repeated in part": lambda strip: repeat(strip, 1.6, 1.2),
    "a part repeated": lambda strip: (cut(strip, 0.3, 0.7), repeat(strip, 3.0, 1.2)),
    "a part repeated, reversed": lambda strip: (
        cut(strip, 0.3, 0.7),
        repeat(strip, 2),
        turn(strip),
    ),
    "reversed, repeated in part": lambda strip: (turn(strip), repeat(strip, 2.5, 0.7)),
    "faded": fade,
    "faded, cut off": lambda strip: (cut(strip, last=0.7), fade(strip)),
    "of an influence": lambda strip: key(strip, "influence", f7=0.1, f20=1.0, f30=0.3),
    "of a time": lambda strip: key(strip, "strip_time", f7=0.0, f20=28.0, f37=5.0),
    "of half frames": lambda strip: setattr(strip, "frame_start_ui", 9.5),
}


def sequenced(scene, face, name: str, frame: int):  # noqa: F811
    """The strip of an expression that is added in a frame later than those of others."""
    scene.frame_set(frame)
    assert bpy.ops.mimetic.sequence_expression(action=name) == {"FINISHED"}
    tracks = face.data.shape_keys.animation_data.nla_tracks
    strips = [strip for track in tracks if track.name.startswith("Expr") for strip in track.strips]
    return next(strip for strip in strips if strip.frame_start == frame - 6)


@pytest.mark.parametrize("what", CHANGES)
def test_it_plays_as_the_strip_did(scene, face, smile, what):  # noqa: F811
    strip = sequenced(scene, face, "smile", 13)
    CHANGES[what](strip)
    frames = range(1, 130)
    before = played(scene, face, frames)
    assert bpy.ops.mimetic.compose_expressions() == {"FINISHED"}
    after = played(scene, face, frames)
    for name, peak in SMILE.items():
        assert before[name].max() > 0.3 * peak
        np.testing.assert_allclose(after[name], before[name], atol=1e-4, err_msg=name)


def test_what_is_cut_off_ends_there_while_others_go_on(scene, face, smile, brows):  # noqa: F811
    first = sequenced(scene, face, "smile", 7)
    cut(first, last=0.5)
    second = sequenced(scene, face, "smile", 57)
    cut(second, first=0.6)
    above = sequenced(scene, face, "brows", 17)
    fade(above)
    frames = range(1, 90)
    before = played(scene, face, frames)
    assert bpy.ops.mimetic.compose_expressions() == {"FINISHED"}
    after = played(scene, face, frames)
    for name in (*SMILE, *BROWS):
        np.testing.assert_allclose(after[name], before[name], atol=1e-4, err_msg=name)
    assert after["zygomaticus_major.L"][16] == 0 < 0.3 < after["zygomaticus_major.L"][15]


@pytest.mark.parametrize("language", LONG)
def test_names_as_long_as_blender_has_them_compose(extension, scene, face, language):  # noqa: F811
    new_asset = extension("scene_out").expressions.new_asset
    name = new_asset(LONG[language], bump(SMILE), 30.0).name  # cut before Blender 5.0
    for frame in (7, 17):
        strip = sequenced(scene, face, name, frame)
        assert name.startswith(strip.name.removesuffix(".001")) and len(strip.name) > 15
    assert bpy.ops.mimetic.compose_expressions() == {"FINISHED"}


@pytest.mark.parametrize("ending", ["é", "€", "😀"])
def test_a_strips_name_is_cut_at_a_whole_letter(extension, scene, face, ending):  # noqa: F811
    """Wherever within the letter it would be cut."""
    compat = extension("compat")
    tracks = compat.animation_of(face.data.shape_keys).nla_tracks
    action = bpy.data.actions.new("any")
    for count in range(58, 65):
        name = "a" * count + 2 * ending
        track = tracks.new()
        strip = compat.add_strip(track, name, 1.0, action)
        assert name.startswith(strip.name) and 59 < len(strip.name.encode()) < 64
        tracks.remove(track)


def test_a_strip_whose_name_blender_cut_within_a_letter_composes(scene, face, smile):  # noqa: F811
    strip = sequenced(scene, face, "smile", 7)
    (track,) = (
        one for one in face.data.shape_keys.animation_data.nla_tracks if strip in one.strips[:]
    )
    track.strips.new("a" * 62 + "é", 80, smile)
    assert bpy.ops.mimetic.compose_expressions() == {"FINISHED"}
