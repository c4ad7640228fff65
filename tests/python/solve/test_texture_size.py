# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage whose face holds what is fine is measured finely, other footage is not."""

from dataclasses import replace

import numpy as np
import pytest
from clips import ffmpeg
from mimetic import InvalidInput, _core
from mimetic.media.footage import Footage
from mimetic.solve.texture_size import COARSE, FINE, fine_contrast, tracker_options
from mimetic.solve.tracking import UNMEASURED
from mimetic.template.face_template import load_template

from evaluation.runs.ablations import Variant

LAST = 30


@pytest.fixture(scope="module")
def fit(fit_of_frame_3):
    return fit_of_frame_3


def another(rendered_clip, path, *options, filters="null"):
    ffmpeg("-i", rendered_clip.footage, "-vf", filters, "-frames:v", LAST, *options, path)
    return path


def of_footage(what, path, fit):
    template = load_template()
    footage = Footage(path)
    neutral = fit.neutral_vertices(template)
    return what(footage.read(fit.frame), footage, fit, neutral, template)


def texture_of(path, fit):
    options = of_footage(tracker_options, path, fit)
    return options.crop_height, options.sample_spacing


def test_a_sharp_clip_is_measured_finely(rendered_clip, fit):
    assert texture_of(rendered_clip.footage, fit) == FINE


def test_a_compressed_clip_is_not(rendered_clip, fit, tmp_path):
    path = another(rendered_clip, tmp_path / "compressed.mp4", "-crf", 34)
    assert texture_of(path, fit) == COARSE


def test_nor_is_one_out_of_focus(rendered_clip, fit, tmp_path):
    path = another(rendered_clip, tmp_path / "soft.mp4", "-crf", 16, filters="gblur=1.5")
    assert texture_of(path, fit) == COARSE


@pytest.mark.parametrize("shown", ["null", "framestep=3,fps=30"])
def test_nor_does_noise_count_as_fine(rendered_clip, fit, tmp_path, shown):
    """New in each frame, or in each that is not shown again."""
    path = another(
        *(rendered_clip, tmp_path / "dark.mp4", "-crf", 4),
        filters=f"gblur=1.5,noise=alls=40:allf=t,{shown}",
    )
    assert texture_of(path, fit) == COARSE


def test_exposure_does_not_matter(rendered_clip, fit, tmp_path):
    as_it_is = of_footage(fine_contrast, rendered_clip.footage, fit)
    darker = another(
        rendered_clip, tmp_path / "dark.mp4", "-crf", 4, filters="lutyuv=y=16+(val-16)/2"
    )
    assert of_footage(fine_contrast, darker, fit) == pytest.approx(as_it_is, rel=0.15)


def test_another_scene_does_not_count(rendered_clip, fit, tmp_path):
    """Noise follows the fit's frame: a face before a cut is judged by itself."""
    blurred = another(rendered_clip, tmp_path / "soft.mp4", "-crf", 16, filters="gblur=1.5")
    cut = another(
        *(rendered_clip, tmp_path / "cut.mp4", "-crf", 16),
        filters="gblur=1.5,geq=lum='if(gt(N,3),255*random(1),lum(X,Y))':cb=128:cr=128",
    )
    alone = of_footage(fine_contrast, blurred, fit)
    assert of_footage(fine_contrast, cut, fit) == pytest.approx(alone, rel=0.2)


@pytest.mark.parametrize(
    ("before", "texture"), [("null", FINE), ("gblur=3:enable='lt(n,2)'", COARSE)]
)
def test_frames_before_the_fits_tell_too(rendered_clip, fit, tmp_path, before, texture):
    """After it a head may turn too fast to be compared; at a clip's end there are no others."""
    path = another(
        *(rendered_clip, tmp_path / "end.mp4", "-crf", 4, "-frames:v", fit.frame),
        filters=before,
    )
    assert texture_of(path, fit) == texture


def test_a_single_frame_is_judged_alone(rendered_clip, fit, tmp_path):
    path = another(rendered_clip, tmp_path / "one.mp4", "-crf", 16, "-frames:v", 1)
    fit = replace(fit, frame=1, views=[])
    template = load_template()
    skin = fit.neutral_vertices(template)[: template.num_skin_vertices]
    measured = skin[~template.in_region(*UNMEASURED)]
    points = measured @ fit.head_pose[:3, :3].T + fit.head_pose[:3, 3]
    image = Footage(path).read(1)
    assert of_footage(fine_contrast, path, fit) == pytest.approx(
        _core.fine_contrast(image, image, fit.camera, points, FINE[0])
    )


def test_a_variant_changes_what_it_names_alone(rendered_clip, fit):
    options = of_footage(tracker_options, rendered_clip.footage, fit)
    changed = Variant({"sample_spacing": 9}).tracker_options(options)
    assert (changed.crop_height, changed.sample_spacing) == (FINE[0], 9)


def test_wrong_input_is_refused(fit):
    image = np.zeros((fit.image_size[1], fit.image_size[0], 3), np.uint8)
    small = np.zeros((48, 48, 3), np.uint8)
    in_front = np.array([[0, 0, 1.0], [0.1, 0.1, 1]])
    with pytest.raises(InvalidInput, match="point 0 of the face is not in front"):
        _core.fine_contrast(image, image, fit.camera, -in_front, 300)
    with pytest.raises(InvalidInput, match="size that the camera has"):
        _core.fine_contrast(small, image, fit.camera, in_front, 300)
    with pytest.raises(InvalidInput, match="size that the camera has"):
        _core.fine_contrast(image, small, fit.camera, in_front, 300)
    with pytest.raises(InvalidInput, match="most_height"):
        _core.fine_contrast(image, image, fit.camera, in_front, 0)
    with pytest.raises(TypeError):
        _core.fine_contrast(image, image[..., 0].astype(float), fit.camera, in_front, 300)
