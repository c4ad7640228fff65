# SPDX-License-Identifier: GPL-3.0-or-later
"""The playhead while a capture works."""

import bpy
import pytest


@pytest.fixture
def playhead(extension, scene, footage, monkeypatch):
    """Of a clip whose second footage frame is the scene's tenth."""
    part = extension("frame_at_hand")
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    clip = scene.mimetic.clip
    clip.frame_start, clip.frame_offset = 10, 1
    monkeypatch.setattr(part, "_is_on_show", lambda *_: True)  # there is no editor without a window
    standing = part.Playhead(scene)
    return lambda frame: standing.accompany(bpy.context, clip.name, frame)


def test_it_goes_along_with_the_frame_at_hand(scene, playhead, extension):
    assert playhead(5)
    assert not playhead(5)  # nothing is to be drawn anew
    assert scene.frame_current == 13
    assert extension("scene_in").shown_frame(bpy.context) == 5


def test_whoever_scrubs_has_it_until_they_go_back(scene, playhead):
    playhead(5)
    scene.frame_set(20)
    assert not playhead(6)
    assert not playhead(7)
    assert scene.frame_current == 20
    scene.frame_set(13)
    playhead(8)
    assert scene.frame_current == 16


def test_another_scene_stays_where_it_is(scene, playhead):
    other = bpy.data.scenes.new("Other")
    other.frame_set(3)
    with bpy.context.temp_override(scene=other):
        playhead(5)
    assert (other.frame_current, scene.frame_current) == (3, 1)


def test_nothing_moves_where_no_editor_shows_the_clip(scene, footage, extension):
    part = extension("frame_at_hand")
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    part.Playhead(scene).accompany(bpy.context, "no such clip", 5)
    assert scene.frame_current == 1


def test_a_render_that_counts_in_it_is_left_alone(scene, playhead, extension, monkeypatch):
    playhead(5)
    monkeypatch.setattr(extension("playback"), "is_rendering", lambda: True)
    assert not playhead(6)
    assert scene.frame_current == 13


def test_it_goes_along_in_a_scene_that_is_renamed(scene, playhead):
    scene.name = "sh010"
    assert playhead(5) and scene.frame_current == 13
