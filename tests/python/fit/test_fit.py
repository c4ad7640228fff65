# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy as np
import pytest
from drawn_face import draw
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic._core import chances_of_rest, rest_scores
from mimetic.fit.fitting import (
    FaceFit,
    NoFace,
    find_face,
    judge_frame,
    landmark_places,
    refit,
)
from mimetic.fit.further_frame import with_frame
from mimetic.template.face_template import load_template

CAMERA = _core.Camera(600, 600, 239.5, 199.5, 480, 400)


@pytest.fixture(scope="module")
def template():
    return load_template()


def pose(yaw, pitch, roll, place=(0.01, -0.01, 0.6)):
    """camera_from_head of a head that faces the camera, then turns; degrees and metres."""
    y, p, r = np.radians([yaw, pitch, roll])
    turn_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    turn_x = np.array([[1, 0, 0], [0, np.cos(p), -np.sin(p)], [0, np.sin(p), np.cos(p)]])
    turn_z = np.array([[np.cos(r), -np.sin(r), 0], [np.sin(r), np.cos(r), 0], [0, 0, 1]])
    camera_from_head = np.eye(4)
    camera_from_head[:3, :3] = turn_z @ turn_x @ turn_y @ np.diag([1, -1, -1])
    camera_from_head[:3, 3] = place
    return camera_from_head


@pytest.fixture(scope="module")
def drawn(template):
    return draw(template, template.vertices, pose(0, 0, 0), CAMERA)


@pytest.fixture(scope="module")
def fitted(template, drawn):
    return find_face(drawn, 7, template=template, camera=CAMERA)


def angle_deg(a, b):
    return np.degrees(np.arccos(np.clip((np.trace(a[:3, :3].T @ b[:3, :3]) - 1) / 2, -1, 1)))


def pixels(vertices, camera_from_head):
    in_camera = vertices @ camera_from_head[:3, :3].T + camera_from_head[:3, 3]
    return in_camera[:, :2] / in_camera[:, 2:] * CAMERA.fx + [CAMERA.cx, CAMERA.cy]


def test_head_lies_on_the_drawn_face(template, fitted):
    truth = pixels(template.vertices, pose(0, 0, 0))
    places = pixels(fitted.neutral_vertices(template), fitted.head_pose)
    ipd = 0.063 * CAMERA.fx / (0.6 - template.eye_centers[0, 2])
    inner = [
        i
        for n, i in zip(template.landmark_names, template.landmark_vertices, strict=True)
        if not n.startswith(("tragus", "zygion", "gonion", "hairline"))
    ]
    error = np.linalg.norm(places - truth, axis=1)[inner] / ipd
    assert np.median(error) < 0.05
    assert error.max() < 0.15


def test_scale_comes_from_the_pupil_distance(template, fitted):
    centers, _ = template.eye_spheres(fitted.neutral_vertices(template))
    assert np.linalg.norm(centers[0] - centers[1]) == pytest.approx(0.063, abs=1e-4)


def test_grey_picture_gives_a_face_too(template, drawn):
    grey = np.rint(drawn @ [0.299, 0.587, 0.114]).astype(np.uint8)
    fit = find_face(grey, template=template, camera=CAMERA)
    assert angle_deg(fit.head_pose, pose(0, 0, 0)) < 8


def test_without_a_camera_the_focal_length_is_a_webcams(template, drawn):
    fit = find_face(drawn, template=template)
    assert fit.intrinsics[0, 0] == pytest.approx(1.2 * 480)
    assert fit.camera.width == 480


def test_frame_at_rest_is_chosen_before_a_talking_a_blinking_and_a_blurred_one(drawn, fitted):
    left, right = (np.array(fitted.features[f"mouth_corner.{side}"]) for side in "RL")
    x, y = np.rint((left + right) / 2).astype(int)
    talking = drawn.copy()
    talking[y - 2 : y + 14, x - 14 : x + 14] = (40, 15, 15)
    blinking = drawn.copy()
    for side in "LR":
        x, y = np.rint(fitted.features[f"pupil.{side}"]).astype(int)
        blinking[y - 8 : y + 8, x - 18 : x + 18] = drawn[y + 40, x]
        blinking[y : y + 2, x - 12 : x + 12] = (60, 40, 35)
    blurred = np.rint(
        np.mean([np.roll(drawn, shift, axis=1) for shift in range(-4, 5)], axis=0)
    ).astype(np.uint8)
    candidates = [judge_frame(image) for image in (drawn, talking, blinking, blurred)]
    faces = [one for one in candidates if one is not None]
    assert faces[0] is candidates[0]
    rest, *worse = chances_of_rest(
        rest_scores([one.signs for one in faces]),
        *(np.array([vars(one)[key] for one in faces]) for key in ("detail", "expression")),
    )
    assert max(worse, default=0.0) < 0.7 * rest


def test_noise_and_plain_pictures_are_no_face(template):
    noise = np.random.default_rng(1).integers(0, 255, (240, 320, 3), dtype=np.uint8)
    for image in (noise, np.full((240, 320, 3), 128, np.uint8)):
        with pytest.raises(NoFace, match="no frontal face in frame 3"):
            find_face(image, 3, template=template)
        assert judge_frame(image) is None


@pytest.mark.parametrize(
    ("image", "text"),
    [
        (np.zeros((10, 10, 3), np.uint8), "10 x 10"),
        (np.zeros((100, 100, 3), np.uint16), "uint16"),
        (np.zeros((100, 100, 2), np.uint8), "shape"),
    ],
)
def test_pictures_that_cannot_be_worked_with_are_refused(template, image, text):
    with pytest.raises(InvalidInput, match=text) as caught:
        find_face(image, template=template)
    assert not isinstance(caught.value, NoFace)


def test_of_two_faces_the_larger_is_taken_and_the_other_can_be_chosen(template, drawn):
    small = drawn[::2, ::2]
    both = np.full((400, 720, 3), 128, np.uint8)
    both[:, :480] = drawn
    both[100 : 100 + small.shape[0], 480:] = small
    first = find_face(both, template=template)
    second = find_face(both, template=template, near=(600, 250))
    assert second.features == find_face(both, template=template, choice=1).features
    assert "2 faces" in first.warnings[0]
    assert first.features["pupil.L"][0] < 480 < second.features["pupil.L"][0]
    (_, view) = with_frame(second, both, 2).views
    assert {f.name: f.position[0] for f in view.measured.features}[
        "pupil.L"
    ] > 480  # who was chosen stays chosen
    with pytest.raises(InvalidInput, match="shows 2"):
        find_face(both, template=template, choice=2)


def test_saved_fit_loads_the_same(tmp_path, template, fitted):
    fitted.save(tmp_path / "fit.json")
    again = FaceFit.load(tmp_path / "fit.json")
    np.testing.assert_array_equal(again.head_pose, fitted.head_pose)
    np.testing.assert_array_equal(
        again.neutral_vertices(template), fitted.neutral_vertices(template)
    )
    assert (again.frame, again.image_size, again.features) == (7, (480, 400), fitted.features)
    assert [path.name for path in tmp_path.iterdir()] == ["fit.json"]


def _changed(key, value):
    def change(document):
        document[key] = value

    return change


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (_changed("schema", 10), "schema 10"),
        (lambda d: d.pop("head_pose"), "lacks head_pose"),
        (_changed("pose", 1), "unknown keys: pose"),
        (_changed("frame", 0), "frame"),
        (_changed("frame", True), "frame"),
        (_changed("image_size", [480]), "image_size"),
        (_changed("image_size", [8, 8]), "image_size"),
        (_changed("intrinsics", [[0, 0, 1], [0, 600, 1], [0, 0, 1]]), "intrinsics"),
        (_changed("intrinsics", "wide"), "intrinsics"),
        (_changed("head_pose", np.diag([1, 1, -1, 1]).tolist()), "rotation"),
        (_changed("head_pose", np.full((4, 4), np.nan).tolist()), "head_pose"),
        (_changed("head_pose", np.eye(4).tolist()), "z > 0"),
        (_changed("identity", {"head_round": None}), "head_round"),
        (_changed("identity", [0.1]), "identity"),
        (_changed("features", {"pupil.L": [1]}), "pupil.L"),
        (_changed("warnings", "two"), "warnings"),
        (_changed("residual", [[1.0]]), "residual"),
        (_changed("views", {}), "views"),
        (lambda d: d["views"][0].pop("box"), "views must be objects"),
        (lambda d: d["views"][0]["curves"].update(jaw=[[1, 2]]), "curve jaw"),
        (lambda d: d["views"][0]["pins"].update(chin=["low"]), "pin chin"),
        (_changed("rest", {"why": "usual"}), "rest must be an object"),
        (_changed("still_cover", {"cell": 4.0}), "still_cover of a face fit must be an object"),
        (
            _changed("still_cover", {"corner": [1, 2], "cell": 0, "rows": ["#"]}),
            "cells of 0 pixels",
        ),
        (_changed("still_cover", {"corner": [1, "2"], "cell": 4, "rows": ["#"]}), "corner"),
        (_changed("still_cover", {"corner": [1, 2], "cell": 4, "rows": ["#.", "#"]}), "one length"),
        (_changed("still_cover", {"corner": [1, 2], "cell": 4, "rows": ["#o"]}), "signs # and"),
        (_changed("still_cover", {"corner": [1, 2], "cell": 4, "rows": [""]}), "1 to 400 rows"),
        (_changed("rest", {"why": "a whim", "seen": 4, "alike": 2}), "why of these"),
        (_changed("rest", {"why": "usual", "seen": 4, "alike": 5}), "alike <= seen"),
        (_changed("rest", {"why": "usual", "seen": True, "alike": 1}), "whole numbers"),
        (lambda d: d["views"].append(d["views"][0]), "each frame once"),
    ],
)
def test_edited_fit_is_refused_with_the_field_named(tmp_path, fitted, change, text):
    path = tmp_path / "fit.json"
    fitted.save(path)
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    with pytest.raises(InvalidInput, match=text) as caught:
        FaceFit.load(path)
    assert str(path) in str(caught.value)


def test_dragged_landmark_is_met_and_its_neighbours_stay(template, fitted):
    before = landmark_places(fitted)
    dragged = (before["mouth_corner.L"][0] + 6, before["mouth_corner.L"][1] + 3)
    pinned = refit(fitted, {"mouth_corner.L": dragged})
    after = landmark_places(pinned)
    assert np.linalg.norm(np.subtract(after["mouth_corner.L"], dragged)) < 0.1
    for name in ("pupil.L", "pupil.R", "ala.R", "chin"):
        assert np.linalg.norm(np.subtract(after[name], before[name])) < 2
    assert pinned.pins == {7: {"mouth_corner.L": dragged}}
    again = refit(pinned, {})
    assert again.pins == {}
    moved = np.linalg.norm(
        again.neutral_vertices(template) - fitted.neutral_vertices(template), axis=1
    )
    assert moved.max() < 0.0005


def test_pins_outlive_the_file(tmp_path, template, fitted):
    pinned = refit(fitted, {"nose_tip": (240.0, 210.0), "chin": (242.0, 300.0)})
    pinned.save(tmp_path / "fit.json")
    again = FaceFit.load(tmp_path / "fit.json")
    assert again.pins == pinned.pins
    assert again.residual == pinned.residual
    np.testing.assert_allclose(
        refit(again, again.pins[7]).neutral_vertices(template),
        refit(pinned, pinned.pins[7]).neutral_vertices(template),
        atol=1e-5,
    )


def test_pins_of_no_landmark_and_on_no_view_are_refused(fitted):
    with pytest.raises(InvalidInput, match="no landmark ear_ring; there are hairline"):
        refit(fitted, {"ear_ring": (1.0, 2.0)})
    with pytest.raises(InvalidInput, match="is not of frame 8"):
        refit(fitted, {}, 8)
    with pytest.raises(InvalidInput, match="pin chin"):
        refit(fitted, {"chin": (np.nan, 2.0)})


def test_fit_of_an_older_file_is_read(tmp_path, template, fitted):
    fitted.save(tmp_path / "fit.json")
    document = json.loads((tmp_path / "fit.json").read_text()) | {"schema": 1}
    for key in (
        "residual",
        "relief",
        "depth",
        "depth_std",
        "lines",
        "views",
        "calibration",
        "rest",
        "still_cover",
    ):
        del document[key]
    (tmp_path / "fit.json").write_text(json.dumps(document))
    fit = FaceFit.load(tmp_path / "fit.json")
    assert fit.identity == {k: v for k, v in fitted.identity.items() if v}
    with pytest.raises(InvalidInput, match="its frames: none"):
        refit(fit, {})


def test_files_that_are_no_fit_are_refused(tmp_path):
    with pytest.raises(UnreadableMedia, match="no such file"):
        FaceFit.load(tmp_path / "missing.json")
    for content in (b"", b"[1]", b"\xff\xfe", b"{" * 1000):
        (tmp_path / "bad.json").write_bytes(content)
        with pytest.raises(InvalidInput, match="not a face fit"):
            FaceFit.load(tmp_path / "bad.json")


def test_unknown_identity_is_named(template, fitted):
    fit = FaceFit(1, fitted.image_size, fitted.intrinsics, fitted.head_pose, {"two_heads": 1.0})
    with pytest.raises(InvalidInput, match="two_heads"):
        fit.neutral_vertices(template)
