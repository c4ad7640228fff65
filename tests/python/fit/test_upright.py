# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage filmed sideways that does not say so is refused, with the way to turn it."""

import numpy as np
import pytest
from clips import ffmpeg, make_clip
from mimetic.fit import fitting, upright
from mimetic.fit.fitting import NoFace
from mimetic.fit.upright import turns_to_upright
from mimetic.media.footage import Footage
from mimetic.solve.clip_capture import find_face

FILTERS = {1: "transpose=clock", 2: "hflip,vflip", 3: "transpose=cclock"}


def filtered(clip, path, filters, *output):
    ffmpeg("-i", clip, "-vf", filters, "-frames:v", 12, "-crf", 18, *output, path)
    return path


@pytest.mark.parametrize(("turns", "where"), [(1, "to the right"), (2, "down"), (3, "to the left")])
def test_a_turned_clip_is_refused_and_the_advice_mends_it(rendered_clip, tmp_path, turns, where):
    turned = filtered(rendered_clip.footage, tmp_path / "turned.mp4", FILTERS[turns])
    with pytest.raises(
        NoFace, match=f"the head points {where} in frame 3, and the file does not turn it"
    ) as refused:
        find_face(turned, frame=3)
    advice = str(refused.value).split("-vf ")[1].split()[0]
    mended = filtered(turned, tmp_path / "mended.mp4", advice)
    pictures = np.stack([Footage(rendered_clip.footage).read(3), Footage(mended).read(3)])
    assert np.abs(np.diff(pictures.astype(int), axis=0)).mean() < 4
    assert turns_to_upright(pictures[1]) == 0


def test_where_no_face_is_found_the_search_tells_of_a_turned_one(rendered_clip, tmp_path):
    turned = filtered(rendered_clip.footage, tmp_path / "turned clip.mp4", FILTERS[1])
    with pytest.raises(NoFace, match=r"-i '.*turned clip\.mp4' -vf transpose=cclock"):
        find_face(turned)


def test_rotation_that_the_file_tells_is_followed(rendered_clip, fit_of_frame_3, tmp_path):
    turned = filtered(rendered_clip.footage, tmp_path / "turned.mp4", FILTERS[1])
    path = tmp_path / "told.mp4"
    ffmpeg("-display_rotation", "90", "-i", turned, "-c", "copy", path)
    expected = fit_of_frame_3.head_pose
    np.testing.assert_allclose(
        find_face(path, frame=3).head_pose[:3, :3], expected[:3, :3], atol=0.03
    )


def test_a_rotation_that_is_wrong_is_told(rendered_clip, tmp_path):
    path = tmp_path / "told.mp4"
    ffmpeg("-display_rotation", "90", "-i", rendered_clip.footage, "-c", "copy", path)
    with pytest.raises(NoFace, match="and the file turns it by 90 degrees: set it upright"):
        find_face(path, frame=3)


def test_a_picture_without_any_face_is_not_called_turned(tmp_path):
    image = Footage(make_clip(tmp_path / "a.mp4", size="320x240")).read(1)
    assert turns_to_upright(image) == 0


def test_a_head_that_networks_are_sure_of_is_not_looked_for_turned(rendered_clip, monkeypatch):
    footage = Footage(rendered_clip.footage)
    image = footage.read(3)
    fit = fitting.find_face(image, 3)
    searched = []
    monkeypatch.setattr(upright, "turns_to_upright", lambda image: searched.append(image) or 0)
    upright.check_upright(footage, 3, image, fit)
    assert not searched
    on_its_head = np.ascontiguousarray(image[::-1, ::-1])
    upright.check_upright(footage, 3, on_its_head, fit)
    assert len(searched) == 1
