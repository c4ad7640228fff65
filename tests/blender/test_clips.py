# SPDX-License-Identifier: GPL-3.0-or-later
"""Face, pins, calibration and take belong to a clip: to the content of its file."""

import dataclasses
import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitted_view import FittedView
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.muscles.calibration import Calibration
from panel_texts import drawn

PANEL = "MIMETIC_PT_capture_view"


def write_clip(path: Path, shade: int) -> Path:
    """Eight frames of stripes of the size of the performance's pictures."""
    from imageio_ffmpeg import write_frames

    writer = write_frames(str(path), (400, 300), fps=25, macro_block_size=1, quality=6)
    writer.send(None)
    column = np.arange(400)
    for i in range(8):
        stripes = np.stack([column + 5 * i, column + shade, column - i], axis=1) % 256
        writer.send(np.broadcast_to(stripes, (300, 400, 3)).astype(np.uint8).tobytes())
    writer.close()
    return path


@pytest.fixture(scope="module")
def films(tmp_path_factory) -> tuple[Path, Path]:
    """Of two actors, in pictures of one size."""
    folder = tmp_path_factory.mktemp("films")
    return write_clip(folder / "anna.mp4", 0), write_clip(folder / "bert.mp4", 90)


def make_fit(performance, frame: int) -> FaceFit:
    """A person as found in a frame."""
    nothing = _core.FaceFeatures([], [], np.array([100.0, 80, 200, 160]), 1.0)
    return FaceFit(
        frame=frame,
        image_size=(400, 300),
        intrinsics=np.array([[520.0, 0, 203.5], [0, 520, 141.25], [0, 0, 1]]),
        head_pose=performance.head_pose[0],
        identity={},
        views=[FittedView(frame, performance.head_pose[0], nothing)],
    )


@pytest.fixture(scope="module")
def a_fit(performance) -> FaceFit:
    return make_fit(performance, 1)


@pytest.fixture(scope="module")
def other_fit(performance) -> FaceFit:
    return make_fit(performance, 2)


@pytest.fixture
def load(scene):
    def load_clip(path: Path):
        assert bpy.ops.mimetic.load_clip(filepath=str(path)) == {"FINISHED"}
        return scene.mimetic.clip

    return load_clip


def take_of(performance, film: Path, path: Path, num_frames: int = 8) -> Path:
    """A performance captured from a film, as a file."""
    cut = {
        field.name: getattr(performance, field.name)[:num_frames]
        for field in dataclasses.fields(performance)
        if np.shape(getattr(performance, field.name))[:1] == (performance.num_frames,)
    }
    identity = [film.name, fingerprint(film)]
    dataclasses.replace(performance, **cut, footage=identity).save(path)
    return path


def texture() -> np.ndarray:
    images = [image for image in bpy.data.images if image.name.startswith("Face Skin")]
    pixels = np.empty(images[-1].size[0] * images[-1].size[1] * 4, dtype=np.float32)
    images[-1].pixels.foreach_get(pixels)
    return pixels


def test_each_clip_has_its_own_person(extension, scene, load, films, a_fit, other_fit):
    face_fit, scene_in = extension("scene_out").face_fit, extension("scene_in")
    anna, bert = load(films[0]), load(films[1])
    calibrated = dataclasses.replace(a_fit, calibration=Calibration(strength={"mentalis.L": 1.2}))
    calibrated.calibration.frames.append(3)
    face_fit.store(anna, calibrated)
    assert scene.mimetic.clip == bert
    assert face_fit.of_clip(bert) is None
    assert not face_fit.is_calibrated(bert)
    assert not bpy.ops.mimetic.calibrate.poll()
    assert "Press Find Face" in scene_in.no_landmarks(bpy.context, False)
    assert "bert.mp4: face not found yet" in drawn(PANEL)
    face_fit.store(bert, other_fit)
    assert (face_fit.of_clip(anna).frame, face_fit.of_clip(bert).frame) == (1, 2)
    scene.mimetic.clip = anna
    assert bpy.ops.mimetic.calibrate.poll()
    assert "anna.mp4: face of frame 1, calibrated" in drawn(PANEL)
    scene.mimetic.clip = bert
    assert "bert.mp4: face of frame 2" in drawn(PANEL)


def test_capture_of_another_clip_does_not_start_from_this_face(
    extension, scene, load, films, a_fit
):
    """What its work is given: the face found in the clip itself, so none here."""
    operator = extension("operators.capture").MIMETIC_OT_capture
    unset = {"filepath": "", "frame_first": 0, "frame_last": 0}
    nothing_given = SimpleNamespace(is_property_set=lambda _name: False)
    given = {"option": lambda self, context: None, "properties": nothing_given}
    reader = type("Reader", (), {**unset, **given})()
    extension("scene_out").face_fit.store(load(films[0]), a_fit)
    footage, what, *_ = operator.read(reader, bpy.context)
    assert (Path(footage.path), what["fit"].frame) == (films[0], 1)
    load(films[1])
    footage, what, *_ = operator.read(reader, bpy.context)
    assert (Path(footage.path), what["fit"]) == (films[1], None)


def test_a_take_stays_with_its_clip(extension, scene, load, films, performance, tmp_path):
    anna, bert = load(films[0]), load(films[1])
    take = take_of(performance, films[0], tmp_path / "take.npz")
    assert bpy.ops.mimetic.load_performance(filepath=str(take)) == {"FINISHED"}
    assert scene.mimetic.clip == anna  # whose take it is, and not bert, who was on show
    scene.render.fps = 25
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    baked = texture()
    face = scene.mimetic.face
    assert face.data.shape_keys.animation_data.action.name == "anna muscles"
    assert scene.camera.data.background_images[0].clip == anna
    scene.mimetic.clip = bert
    assert not bpy.ops.mimetic.bake.poll()
    assert "bert.mp4 has no performance" in extension("scene_in").no_performance(bpy.context)
    assert not bpy.ops.mimetic.hold_head_still.poll()

    of_bert = take_of(performance, films[1], tmp_path / "other.npz")
    bpy.ops.mimetic.load_performance(filepath=str(of_bert))
    bpy.ops.mimetic.bake()
    assert scene.mimetic.face != face  # one actor's face is not made the other's
    assert not np.array_equal(texture(), baked)
    scene.mimetic.clip = anna
    bpy.ops.mimetic.bake()
    assert scene.mimetic.face == face
    np.testing.assert_array_equal(texture(), baked)


def test_a_take_of_a_clip_that_is_not_here_is_refused(
    extension, scene, load, films, performance, tmp_path
):
    """It gets neither the colours nor the name of the clip on show; without a clip it bakes."""
    away = tmp_path / "away"
    away.mkdir()
    shutil.copy(films[1], away / "bert.mp4")
    shutil.copy(films[0], tmp_path / "elsewhere.mp4")
    clip = load(away / "bert.mp4")
    folder = tmp_path / "takes"
    folder.mkdir()
    take = take_of(performance, films[0], folder / "take.npz")
    with pytest.raises(RuntimeError, match=r"captured from anna\.mp4, not from bert\.mp4: load"):
        bpy.ops.mimetic.load_performance(filepath=str(take))
    assert extension("takes").of_clip(scene, clip) is None
    scene.mimetic.clip = None
    assert bpy.ops.mimetic.load_performance(filepath=str(take)) == {"FINISHED"}
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert "anna muscles" in bpy.data.actions
    # The clip found later takes over what was loaded for it
    clip = load(tmp_path / "elsewhere.mp4")
    assert extension("takes").of_clip(scene, clip) is not None
    assert scene.mimetic.performance_path == ""


def test_a_takes_film_beside_it_is_found_whatever_its_name(scene, films, performance, tmp_path):
    shutil.copy(films[0], tmp_path / "renamed.mp4")
    take = take_of(performance, films[0], tmp_path / "take.npz")
    assert bpy.ops.mimetic.load_performance(filepath=str(take)) == {"FINISHED"}
    assert Path(bpy.path.abspath(scene.mimetic.clip.filepath)).name == "renamed.mp4"


def test_a_take_whose_file_became_another_clips_is_refused(
    scene, load, films, performance, tmp_path
):
    load(films[0])
    take = take_of(performance, films[0], tmp_path / "take.npz")
    bpy.ops.mimetic.load_performance(filepath=str(take))
    take_of(performance, films[1], take)
    before = len(bpy.data.objects)
    for bake in (bpy.ops.mimetic.bake, bpy.ops.mimetic.hold_head_still):
        with pytest.raises(RuntimeError, match=r"captured from bert\.mp4, which is not what anna"):
            bake()
    assert len(bpy.data.objects) == before
    assert scene.mimetic.face is None


def test_another_film_in_the_files_place_is_noticed(
    extension, load, films, a_fit, other_fit, tmp_path, performance
):
    path = tmp_path / "clip.mp4"
    shutil.copy(films[0], path)
    clip = load(path)
    clips, face_fit = extension("clips"), extension("scene_out").face_fit
    face_fit.store(clip, a_fit)
    take = take_of(performance, films[0], tmp_path / "take.npz")
    bpy.ops.mimetic.load_performance(filepath=str(take))
    assert clips.change_of(clip) == ""
    shutil.copy(films[1], path)
    assert face_fit.of_clip(clip) is None
    assert not bpy.ops.mimetic.bake.poll()
    assert "now has another content" in clips.change_of(clip)
    assert not extension("scene_in").shows_landmarks(clip)
    face_fit.store(clip, other_fit)
    assert clips.change_of(clip) == ""
    shutil.copy(films[0], path)  # and what was known of the first is back with it
    assert face_fit.of_clip(clip).frame == 1
    assert bpy.ops.mimetic.bake.poll()
    # but the tracks are the second's: they must not be read as pins of the first
    reason = extension("scene_in").no_landmarks(bpy.context, False)
    assert "Landmarks Here" in reason


def test_a_moved_or_renamed_film_is_the_same_clip(extension, load, films, a_fit, tmp_path):
    first = tmp_path / "first.mp4"
    shutil.copy(films[0], first)
    clip = load(first)
    extension("scene_out").face_fit.store(clip, a_fit)
    (tmp_path / "other").mkdir()
    second = tmp_path / "other" / "second.mp4"
    os.rename(first, second)
    assert not bpy.ops.mimetic.find_face.poll()
    assert "is missing" in extension("scene_in").no_footage(bpy.context)
    assert extension("scene_out").face_fit.of_clip(clip).frame == 1
    assert load(second) == clip
    assert len(bpy.data.movieclips) == 1
    assert Path(bpy.path.abspath(clip.filepath)) == second
    assert extension("scene_out").face_fit.of_clip(clip).frame == 1


def test_a_clip_opened_by_blender_itself_is_known_by_its_content(
    extension, scene, load, films, a_fit, tmp_path
):
    extension("scene_out").face_fit.store(load(films[0]), a_fit)
    copy = tmp_path / "copy.mp4"
    shutil.copy(films[0], copy)
    scene.mimetic.clip = bpy.data.movieclips.load(str(copy))
    assert extension("scene_out").face_fit.of_clip(scene.mimetic.clip).frame == 1
    reason = extension("scene_in").no_landmarks(bpy.context, False)
    assert "Landmarks Here" in reason  # the tracks are in the other


def test_what_is_kept_of_a_clip_that_nothing_shows_is_saved(
    extension, scene, load, films, a_fit, tmp_path
):
    extension("scene_out").face_fit.store(load(films[0]), a_fit)
    load(films[1])
    blend = str(tmp_path / "two.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.wm.open_mainfile(filepath=blend)
    assert extension("scene_out").face_fit.of_clip(bpy.data.movieclips["anna.mp4"]).frame == 1


def test_a_file_of_an_earlier_version_gives_its_fit_to_its_clip(
    extension, scene, films, a_fit, performance, tmp_path
):
    """There one fit and one path were kept with the scene."""
    path = tmp_path / "fit.json"
    a_fit.save(path)
    clip = bpy.data.movieclips.load(str(films[0]))
    scene.mimetic.clip = clip
    scene.mimetic.face_fit = path.read_text(encoding="utf-8")
    scene.mimetic.performance_path = str(take_of(performance, films[0], tmp_path / "take.npz"))
    clip.tracking.objects.new("Face")
    for handlers, handler in extension("takes").HANDLERS:
        handlers.remove(handler)  # as that version saved it
    blend = str(tmp_path / "old.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    for handlers, handler in extension("takes").HANDLERS:
        handlers.append(handler)
    bpy.ops.wm.open_mainfile(filepath=blend)
    settings = bpy.context.scene.mimetic
    assert (settings.face_fit, settings.performance_path) == ("", "")
    assert extension("scene_out").face_fit.of_clip(settings.clip).frame == 1
    assert extension("scene_in").shows_landmarks(settings.clip)
    assert bpy.ops.mimetic.bake.poll()


def test_what_a_linked_clip_has_is_copied_before_it_is_changed(
    extension, scene, films, performance, tmp_path
):
    """Blender forgets on saving what is written to linked data."""
    take = take_of(performance, films[0], tmp_path / "take.npz")
    bpy.ops.mimetic.load_clip(filepath=str(films[0]))
    bpy.ops.mimetic.load_performance(filepath=str(take))
    library = tmp_path / "assets" / "library.blend"
    library.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (there, here):
        here.movieclips = there.movieclips
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.mimetic.load_clip(filepath=str(films[0]))
    clip = bpy.context.scene.mimetic.clip
    assert clip.library is None
    takes, captured = extension("takes"), extension("captured_takes")
    assert takes.find(takes.of_clip(bpy.context.scene, clip)) == str(take)  # the linked one's
    extension("corrections").keep(clip, ())
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    clip = bpy.context.scene.mimetic.clip
    (record,) = clip.mimetic.footage
    assert takes.find(record) == str(take)
    assert [takes.find(row) for row in captured.of_clip(clip)] == [str(take)]
