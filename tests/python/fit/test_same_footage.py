# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit that was made from other footage is refused; a copy in another encoding is the same."""

import pytest
from clips import ffmpeg, make_clip
from mimetic import InvalidInput
from mimetic.fit.face_fit import FaceFit
from mimetic.head.tracking import track_head
from mimetic.solve.clip_capture import capture


@pytest.fixture(scope="module")
def fit(fit_of_frame_3):
    return fit_of_frame_3


def filtered(clip, path, *options):
    ffmpeg("-i", clip, "-frames:v", 8, *options, path)
    return path


@pytest.mark.parametrize("follow", [capture, track_head])
def test_a_face_elsewhere_is_refused(rendered_clip, fit, tmp_path, follow):
    shifted = filtered(
        *(rendered_clip.footage, tmp_path / "b.mp4"),
        *("-vf", "pad=iw+60:ih:60:0,crop=iw-60:ih:0:0", "-crf", 18),
    )
    with pytest.raises(InvalidInput, match=r"of other footage: in frame 3 of b\.mp4"):
        follow(shifted, frames=(1, 6), fit=fit)


def test_a_clip_without_a_face_is_refused(fit, tmp_path):
    clip = make_clip(tmp_path / "c.mp4", size="320x240")
    with pytest.raises(InvalidInput, match=r"in frame 3 of c\.mp4"):
        capture(clip, fit=fit)


def test_a_copy_in_another_encoding_is_the_same_footage(rendered_clip, fit, tmp_path):
    copy = filtered(rendered_clip.footage, tmp_path / "copy.mp4", "-crf", 32)
    assert capture(copy, frames=(2, 4), fit=fit).num_frames == 3


def test_a_fit_of_an_older_file_goes_by_its_features(rendered_clip, fit, tmp_path):
    older = FaceFit(
        fit.frame, fit.image_size, fit.intrinsics, fit.head_pose, fit.identity, fit.features
    )
    with pytest.raises(InvalidInput, match="of other footage"):
        capture(make_clip(tmp_path / "c.mp4", size="320x240"), fit=older)
