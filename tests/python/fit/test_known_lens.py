# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from drawn_face import draw
from mimetic import InvalidInput, _core
from mimetic.commands.cli import main
from mimetic.fit.fitting import FaceFit, NoFace, find_face
from mimetic.fit.known_lens import KnownLens, camera_with, is_fitted_with
from mimetic.solve import clip_capture
from mimetic.template.face_template import load_template

from evaluation.synthetic.footage import encode
from evaluation.synthetic.recipes import TEST

SIZE = (480, 400)
LONG = KnownLens(75.0, 36.0)  # 1000 pixels of such a picture
AWAY = 1.0  # metres


def drawn_from_afar(template) -> np.ndarray:
    pose = np.diag([1.0, -1, -1, 1])
    pose[:3, 3] = 0.01, -0.01, AWAY
    camera = _core.Camera(1000, 1000, 239.5, 199.5, *SIZE)
    return draw(template, template.vertices, pose, camera)


def test_a_head_is_as_far_away_as_its_lens_says():
    template = load_template()
    image = drawn_from_afar(template)
    known = find_face(image, camera=camera_with(LONG, SIZE), template=template)
    unknown = find_face(image, template=template)
    assert known.head_pose[2, 3] == pytest.approx(AWAY, rel=0.03)
    assert unknown.head_pose[2, 3] < 0.65 * AWAY  # as near as 1.2 picture widths make it


def test_a_face_that_fills_its_picture_was_filmed_with_a_longer_lens():
    template = load_template()
    part = np.ascontiguousarray(drawn_from_afar(template)[133:241, 198:302])
    size = (part.shape[1], part.shape[0])
    with pytest.raises(NoFace, match="does not fit a head"):
        find_face(part, camera=camera_with(None, size), template=template)
    fit = find_face(part, template=template)
    assert fit.intrinsics[0, 0] == pytest.approx(3 * size[0])
    assert is_fitted_with(None, fit) and not is_fitted_with(LONG, fit)


@pytest.mark.parametrize("frame", [None, 3])
def test_so_was_a_clip_of_such_faces(tmp_path, frame):
    part = drawn_from_afar(load_template())[133:241, 198:302]
    path = tmp_path / "part.mp4"
    encode(np.stack([part] * 6), path, TEST)
    fit = clip_capture.find_face(path, frame=frame)
    assert fit.intrinsics[0, 0] == pytest.approx(3 * part.shape[1])


def test_a_clips_face_is_found_and_followed_with_the_lens_that_is_known(
    rendered_clip, fit_of_frame_3
):
    fit = clip_capture.find_face(rendered_clip.footage, frame=3, lens=LONG)
    assert fit.intrinsics[0, 0] == pytest.approx(320 * 75 / 36)
    assert is_fitted_with(LONG, fit) and not is_fitted_with(None, fit)
    performance = clip_capture.capture(rendered_clip.footage, frames=(3, 4), lens=LONG)
    assert is_fitted_with(LONG, performance)
    assert is_fitted_with(None, fit_of_frame_3)


@pytest.mark.parametrize(
    ("focal", "sensor", "expected"),
    [
        (0.0, 36.0, "focal length 0 mm: it must be above 0"),
        (50.0, -1.0, "sensor -1 mm: it must be above 0"),
        (5.0, 36.0, "on a sensor 36 mm wide it must be 7.2 to 2160"),
        (5000.0, 36.0, "on a sensor 36 mm wide it must be 7.2 to 2160"),
        (float("nan"), 36.0, "focal length nan mm"),
    ],
)
def test_a_lens_that_cannot_be_is_named_with_its_limits(focal, sensor, expected):
    with pytest.raises(InvalidInput, match=expected):
        KnownLens(focal, sensor)


def test_the_command_line_says_the_lens(rendered_clip, tmp_path, capsys):
    words = ["fit", str(rendered_clip.footage), "--frame", "3", "--out", str(tmp_path / "fit")]
    assert main([*words, "--focal", "50", "--sensor", "24"]) == 0
    fit = FaceFit.load(tmp_path / "fit" / "fit.json")
    assert fit.intrinsics[0, 0] == pytest.approx(320 * 50 / 24)
    assert main([*words, "--sensor", "24"]) == 2
    assert "--sensor 24 is of a focal length: give --focal MM too" in capsys.readouterr().err
    words = ["capture", str(rendered_clip.footage), "--out", str(tmp_path / "out")]
    path = str(tmp_path / "fit" / "fit.json")
    assert main([*words, "--fit", path, "--focal", "50"]) == 2
    assert "--fit has the lens that it was found with" in capsys.readouterr().err


def test_a_calibration_finds_its_face_with_the_lens(rendered_clip, tmp_path, capsys, monkeypatch):
    lenses = []

    def find_face(*_, lens, **__):
        lenses.append(lens)
        raise NoFace("it is looked for elsewhere")

    monkeypatch.setattr("mimetic.solve.clip_capture.find_face", find_face)
    words = ["calibrate", str(rendered_clip.footage), "--out", str(tmp_path / "fit.json")]
    assert main([*words, "--focal", "50", "--sensor", "24"]) == 2
    assert lenses == [KnownLens(50.0, 24.0)]
    assert main([*words, "--fit", str(tmp_path / "old.json"), "--focal", "50"]) == 2
    assert "--fit has the lens that it was found with" in capsys.readouterr().err
