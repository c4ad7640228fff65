# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks in the clip editor: dragged, pinned, let go of; the fit follows."""

import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.newest

FRAME, OTHER = 3, 20
NAME = "mouth_corner.L"


@pytest.fixture
def found(extension, scene, clip_path, found_fit):
    bpy.ops.mimetic.load_clip(filepath=str(clip_path))
    extension("scene_out").face_fit.store(scene.mimetic.clip, found_fit)
    scene.frame_set(FRAME)
    return scene.mimetic.clip


def tracks(clip):
    return clip.tracking.objects["Face"].tracks


def place(clip, name: str, frame: int = FRAME) -> np.ndarray:
    """Pixel of a landmark's marker."""
    co = tracks(clip)[name].markers.find_frame(frame, exact=True).co
    return np.array([co[0] * 400 - 0.5, (1 - co[1]) * 300 - 0.5])


def drag(clip, name: str, right: float, down: float = 0.0, frame: int = FRAME) -> None:
    """As the mouse does, pixels."""
    marker = tracks(clip)[name].markers.find_frame(frame, exact=True)
    marker.co = (marker.co[0] + right / 400, marker.co[1] - down / 300)


def select(clip, *names: str) -> None:
    for track in tracks(clip):
        track.select = track.name in names


def test_a_tracking_object_of_the_users_that_is_called_so_stays(
    extension, scene, clip_path, found_fit
):
    bpy.ops.mimetic.load_clip(filepath=str(clip_path))
    clip = scene.mimetic.clip
    clip.tracking.objects.new("Face").tracks.new(name="chin", frame=1)
    for _ in range(2):
        extension("scene_out").face_fit.store(clip, found_fit)
        assert tracks(clip).keys() == ["chin"]
        assert len(clip.tracking.objects) == 3
    assert NAME in extension("scene_out").landmarks.tracks_of(clip)
    assert extension("scene_in").shows_landmarks(clip)


def test_a_dragged_landmark_is_pinned_and_the_face_follows(extension, found):
    from mimetic.fit import fitting

    stored = extension("scene_out").face_fit.of_clip
    before = stored(found)
    upper = place(found, "lip_upper")
    drag(found, NAME, 6, -3)
    dragged = place(found, NAME)
    start = time.perf_counter()
    assert bpy.ops.mimetic.follow_pins() == {"FINISHED"}
    print(f"pin followed in {1000 * (time.perf_counter() - start):.0f} ms")
    after = stored(found)
    np.testing.assert_allclose(after.pins[FRAME][NAME], dragged, atol=1e-3)
    fitted = fitting.landmark_places(after)
    np.testing.assert_allclose(fitted[NAME], dragged, atol=0.5)  # the mesh goes there
    np.testing.assert_allclose(place(found, NAME), dragged, atol=1e-3)
    assert np.linalg.norm(place(found, "lip_upper") - upper) > 0.05  # and its surroundings along
    assert tracks(found)[NAME].use_custom_color
    assert before.pins == {}  # the fit before is as it was
    assert extension("pins").follow(found) == []  # nothing is left to follow


def test_pins_hold_while_others_are_dragged_and_are_let_go_of(extension, found):
    stored = extension("scene_out").face_fit.of_clip
    free = place(found, NAME)
    drag(found, NAME, 6)
    bpy.ops.mimetic.follow_pins()
    pinned = place(found, NAME)
    drag(found, "brow_inner.R", 0, -5)
    bpy.ops.mimetic.follow_pins()
    assert set(stored(found).pins[FRAME]) == {NAME, "brow_inner.R"}
    np.testing.assert_allclose(place(found, NAME), pinned, atol=1e-3)
    select(found, NAME, "brow_inner.R")
    assert bpy.ops.mimetic.unpin() == {"FINISHED"}
    assert stored(found).pins == {}
    assert np.linalg.norm(place(found, NAME) - free) < 1
    assert not any(track.use_custom_color for track in tracks(found))


def test_a_landmark_is_pinned_where_it_is(extension, found):
    at = place(found, "chin")
    select(found, "chin")
    assert bpy.ops.mimetic.pin() == {"FINISHED"}
    pins = extension("scene_out").face_fit.of_clip(found).pins
    np.testing.assert_allclose(pins[FRAME]["chin"], at, atol=1e-3)


def test_landmarks_of_another_frame_can_be_pinned_too(extension, found):
    drag(found, NAME, 5)
    bpy.ops.mimetic.follow_pins()
    bpy.context.scene.frame_set(OTHER)
    select(found, NAME)
    assert not bpy.ops.mimetic.pin.poll()
    assert bpy.ops.mimetic.show_landmarks() == {"FINISHED"}
    drag(found, "chin", 0, 4, OTHER)
    assert bpy.ops.mimetic.follow_pins() == {"FINISHED"}
    fit = extension("scene_out").face_fit.of_clip(found)
    assert {frame: set(pins) for frame, pins in fit.pins.items()} == {
        FRAME: {NAME},
        OTHER: {"chin"},
    }
    assert fit.frame == FRAME


def test_pins_live_in_the_file_and_capture_starts_from_them(extension, found, tmp_path):
    drag(found, NAME, 6)
    bpy.ops.mimetic.follow_pins()
    at = place(found, NAME)
    path = tmp_path / "pinned.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    clip = scene.mimetic.clip
    np.testing.assert_allclose(place(clip, NAME), at, atol=1e-3)
    fit = extension("scene_out").face_fit.of_clip(clip)
    np.testing.assert_allclose(fit.pins[FRAME][NAME], at, atol=1e-3)
    assert extension("pins").follow(clip) == []
    settings = scene.mimetic
    settings.use_frame_range, settings.frame_first, settings.frame_last = True, FRAME, FRAME + 1
    bpy.ops.mimetic.capture(filepath=str(tmp_path / "take.npz"))
    from mimetic.performance.document import Performance
    from mimetic.template.face_template import load_template

    captured = Performance.load(tmp_path / "take.npz")
    is_skin = captured.eye_of_vertex == 0  # eyes look ahead in the neutral, not as in the fit
    neutral = fit.neutral_vertices(load_template())
    np.testing.assert_allclose(captured.neutral_vertices[is_skin], neutral[is_skin], atol=1e-9)


def test_the_buttons_say_why_they_are_grey(extension, found):
    scene = bpy.context.scene
    entry = extension("clips").find(found)
    kept, entry.face_fit = entry.face_fit, ""
    why = extension("scene_in").no_landmarks
    assert "Press Find Face" in why(bpy.context, True)
    entry.face_fit = kept
    select(found)
    assert "Select" in why(bpy.context, True)
    select(found, NAME)
    assert why(bpy.context, True) == ""
    scene.frame_set(FRAME + 5)
    assert "Landmarks Here" in why(bpy.context, True)


@pytest.fixture
def hand(extension, monkeypatch):
    """Begins and ends drags as Blender's modal operators do, which only a window has; each `look`
    is a call of the timer's."""
    pins, at_work = extension("pins"), []
    monkeypatch.setattr(pins, "_at_work", lambda: at_work)
    pins._forget()
    pins.watch()
    yield SimpleNamespace(
        begin=lambda name="CLIP_OT_slide_marker": at_work.append(name),
        end=at_work.clear,
        look=pins.watch,
    )
    pins._forget()


def all_markers(extension, clip) -> np.ndarray:
    return np.frombuffer(extension("scene_out").landmarks.state(clip), np.float32)


@pytest.mark.parametrize("is_pinned", [False, True])
def test_a_drag_that_is_cancelled_pins_nothing_and_fits_nothing(extension, found, hand, is_pinned):
    content = extension("scene_out").face_fit.content
    if is_pinned:
        bpy.context.scene.frame_set(OTHER)
        bpy.ops.mimetic.show_landmarks()  # which move along in that frame
        bpy.context.scene.frame_set(FRAME)
        drag(found, NAME, 4)
        bpy.ops.mimetic.follow_pins()
        hand.look()
    before, markers = content(found), all_markers(extension, found).copy()
    marker = tracks(found)[NAME].markers.find_frame(FRAME, exact=True)
    begun_at = tuple(marker.co)
    hand.begin()
    drag(found, NAME, 6, -3)  # on before the timer looks for the first time
    hand.look()
    assert content(found) != before
    drag(found, NAME, 6)
    hand.look()
    assert np.abs(all_markers(extension, found) - markers).max() > 0.01
    marker.co = begun_at  # as Esc has it, for what was dragged alone
    hand.end()
    hand.look()
    assert content(found) == before
    np.testing.assert_allclose(all_markers(extension, found), markers, atol=1e-6)
    assert tracks(found)[NAME].use_custom_color == is_pinned
    assert extension("pins").follow(found) == []
    hand.look()
    assert content(found) == before


def test_a_drag_that_ends_elsewhere_pins(extension, found, hand):
    hand.begin("TRANSFORM_OT_translate")
    hand.look()
    drag(found, NAME, 6, -3)
    hand.look()
    drag(found, NAME, 1)
    hand.end()
    dragged = place(found, NAME)
    hand.look()
    pins = extension("scene_out").face_fit.of_clip(found).pins
    np.testing.assert_allclose(pins[FRAME][NAME], dragged, atol=1e-3)


def test_a_drag_in_any_window_counts(extension, monkeypatch):
    pins = extension("pins")
    windows = [
        SimpleNamespace(modal_operators=[SimpleNamespace(bl_idname=name)])
        for name in ("MIMETIC_OT_drag_pose", "CLIP_OT_slide_marker")
    ]
    context = SimpleNamespace(window_manager=SimpleNamespace(windows=windows))
    monkeypatch.setattr(pins, "bpy", SimpleNamespace(context=context))
    assert pins._is_dragging() and pins._is_busy()
    windows.pop()
    assert pins._is_busy() and not pins._is_dragging()


def test_landmarks_wait_while_the_clips_offset_is_another(extension, scene, found):
    """Their markers lie on other pictures then: nobody dragged them there."""
    face_fit = extension("scene_out").face_fit
    stored, content = face_fit.of_clip, face_fit.content
    scene.frame_set(OTHER)
    assert bpy.ops.mimetic.show_landmarks() == {"FINISHED"}
    drag(found, NAME, 6, frame=OTHER)
    assert bpy.ops.mimetic.follow_pins() == {"FINISHED"}
    before = content(found)
    for offset in (OTHER - FRAME, 1, -1, 50):
        found.frame_offset = offset
        scene.frame_set(FRAME)
        select(found, NAME)
        for button in ("follow_pins", "pin", "unpin"):
            assert not getattr(bpy.ops.mimetic, button).poll()
        assert extension("scene_in").no_landmarks(bpy.context, False).endswith("Landmarks Here")
        assert extension("pins")._shown_clips(scene) == []
        assert extension("pins").follow(found) == []
        assert content(found) == before
    found.frame_offset = 0
    assert bpy.ops.mimetic.follow_pins() == {"FINISHED"}
    assert content(found) == before

    found.frame_offset = 2
    scene.frame_set(OTHER - 2)
    assert bpy.ops.mimetic.show_landmarks() == {"FINISHED"}
    assert set(stored(found).pins[OTHER]) == {NAME}
    assert extension("pins").follow(found) == []
    drag(found, "chin", 0, 4, FRAME - 2)
    assert extension("pins").follow(found) == ["chin"]
    assert {frame: set(pins) for frame, pins in stored(found).pins.items()} == {
        FRAME: {"chin"},
        OTHER: {NAME},
    }


def test_markers_that_are_switched_off_are_no_drags(extension, found):
    fit = extension("scene_out").face_fit.of_clip(found)
    drag(found, NAME, 6)
    tracks(found)[NAME].markers.find_frame(FRAME, exact=True).mute = True
    assert extension("scene_out").landmarks.find_moves(found, fit) == {}


def test_landmarks_of_a_file_of_before_lie_by_the_offset_that_it_has(
    extension, found, found_fit, tmp_path
):
    found.frame_offset = 1
    extension("scene_out").face_fit.store(found, found_fit)
    found.mimetic.property_unset("landmark_offset")
    path = str(tmp_path / "before.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    clip = bpy.context.scene.mimetic.clip
    assert extension("scene_in").shows_landmarks(clip)
    clip.frame_offset = 0
    assert not extension("scene_in").shows_landmarks(clip)
