# SPDX-License-Identifier: GPL-3.0-or-later
"""Each scene of a clip is captured by itself, and what only looks like a cut is none."""

from dataclasses import replace

import numpy as np
from clips import ffmpeg
from mimetic.media.footage import Footage
from mimetic.solve.clip_capture import capture, find_face
from mimetic.solve.walk import notes_on_cuts


def test_nothing_is_smoothed_across_a_cut(rendered_clip, tmp_path):
    """A closer shot of the same face begins beside the reference frame."""
    plain = "format=yuv420p,setsar=1"
    closer = "crop=iw/1.3:ih/1.3:40:20,scale=320:240,eq=brightness=0.15"
    wide = f"[0:v]trim=end_frame=10,{plain}[a]"
    near = f"[1:v]trim=start_frame=10:end_frame=18,setpts=PTS-STARTPTS,{closer},{plain}[b]"
    ffmpeg(
        *("-i", rendered_clip.footage, "-i", rendered_clip.footage),
        *("-filter_complex", f"{wide};{near};[a][b]concat=n=2"),
        *("-c:v", "ffv1", tmp_path / "cut.mkv"),
    )
    first = find_face(rendered_clip.footage, 10)
    cut = capture(tmp_path / "cut.mkv", frames=(1, 18), fit=first)
    alone = capture(rendered_clip.footage, frames=(1, 10), fit=first)
    np.testing.assert_allclose(cut.head_pose[:10], alone.head_pose, atol=1e-6)
    np.testing.assert_allclose(cut.activations[:10], alone.activations, atol=1e-6)
    assert (cut.quality[-3:] > 0.3).all()
    assert cut.head_pose[-1, 2, 3] < 0.9 * alone.head_pose[-1, 2, 3]
    assert cut.scene_starts.tolist() == [11] and alone.scene_starts is None
    note = "the clip is cut at frame 11: each scene is smoothed by itself"
    assert note in cut.notes and note not in (alone.notes or ())


def test_a_note_names_a_few_of_many_cuts():
    assert notes_on_cuts([]) == []
    for cuts, where in (
        ([37, 31], "frames 31 and 37:"),
        (range(11, 16), "frames 11, 12, 13, 14 and 15:"),
        (range(11, 31), "frames 11, 12, 13, 14, 15 and 15 more:"),
    ):
        (note,) = notes_on_cuts(cuts)
        assert note.startswith(f"the clip is cut at {where}")


def test_a_page_that_scrolls_round_the_webcam_is_no_cut(rendered_clip, fit_of_frame_3, tmp_path):
    page = np.random.default_rng(3).integers(0, 2, (80, 40, 1), np.uint8) * np.uint8(255)
    page = page.repeat(16, axis=0).repeat(16, axis=1).repeat(3, axis=2)
    pictures = []
    for frame, image in Footage(rendered_clip.footage).frames(1, 6):
        pictures.append(page[80 * frame :][:480].copy())
        pictures[-1][240:, 320:] = image
    ffmpeg(
        *("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", "640x480", "-r", "25", "-i", "-"),
        *("-c:v", "ffv1", tmp_path / "screen.mkv"),
        feed=b"".join(picture.tobytes() for picture in pictures),
    )
    in_corner = np.add(fit_of_frame_3.intrinsics, [[0, 0, 320], [0, 0, 240], [0, 0, 0]])
    fit = replace(fit_of_frame_3, image_size=(640, 480), intrinsics=in_corner, features={})
    screen = capture(tmp_path / "screen.mkv", fit=fit)
    assert screen.scene_starts is None
    assert (screen.quality > 0.3).all()
    assert not any("cut" in note for note in screen.notes or ())
