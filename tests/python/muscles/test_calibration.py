# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's skin and muscles are found from what was seen, kept, and used."""

import json

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.commands import cli
from mimetic.commands.calibrate import described
from mimetic.fit.face_fit import FaceFit
from mimetic.muscles.anatomy import AttachedSkin, attach_skin, modes_of, muscle_names
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.calibration import REGIONS, Calibration
from mimetic.skin.mesh import multiply
from mimetic.solve import calibrate
from mimetic.template.face_template import load_template

INTRINSICS = np.array([[600, 0, 239.5], [0, 600, 239.5], [0, 0, 1.0]])
CAMERA = _core.Camera(600, 600, 239.5, 239.5, 480, 480)
POSE = np.diag([1.0, -1.0, -1.0, 1.0])
POSE[2, 3] = 0.6
NOISE_PX = 0.05


@pytest.fixture(scope="module")
def mesh():
    template = load_template()
    return attach_skin(template.vertices, template).mesh


def seen(mesh, anatomy, frame, **activations):
    """What a camera shows of a face, and what a tracker that assumes the usual skin makes of it."""
    rng = np.random.default_rng(frame)
    values = np.zeros(len(muscle_names()) + len(ARTICULATORS))
    for name, value in activations.items():
        for side in ("L", "R"):
            values[muscle_names().index(f"{name}.{side}")] = value
    in_front = mesh.vertices[mesh.triangles][:, :, 2].min(axis=1) > 0.03
    shown = (mesh.triangle_part == "skin") & in_front
    vertices = mesh.triangles[rng.choice(np.flatnonzero(shown), 250, replace=False)]
    skin = mesh.neutral[: int(mesh.template.num_skin_vertices)]
    moved = np.tensordot(values[:36], anatomy.muscle_modes[:, : len(skin)], axes=1)
    points = multiply(mesh.stencils, skin + moved)[vertices].mean(axis=1) @ POSE[:3, :3].T
    points += POSE[:3, 3]
    pixels = 600 * points[:, :2] / points[:, 2:] + 239.5
    pixels += rng.normal(0, NOISE_PX, pixels.shape)
    shares = np.full((len(vertices), 3), 1 / 3)
    information = np.tile(np.eye(2) / NOISE_PX**2, (len(vertices), 1, 1))
    return _core.Sighting(frame, POSE, values, vertices, shares, pixels, information)


def test_stiffness_is_found_where_it_shows_and_stays_at_one_elsewhere(mesh, monkeypatch):
    monkeypatch.setattr(calibrate, "MOST_ROUNDS", 1)
    truth = AttachedSkin(mesh, 1.0, Calibration({"cheeks": 2.0, "lips": 2.0}))
    sightings = [
        seen(mesh, modes_of(truth), 3, zygomaticus_major=0.6),
        seen(mesh, modes_of(truth), 9, zygomaticus_major=0.9, zygomaticus_minor=0.4),
    ]
    result = calibrate.estimate(mesh, sightings, CAMERA, POSE)
    stiffness = result.calibration.stiffness
    assert stiffness["cheeks"] > 1.25 and stiffness["lips"] > 1.25  # one round goes to 1.49
    assert "forehead" not in stiffness
    assert result.stiffness_std["forehead"] == pytest.approx(0.5, rel=0.1)
    assert result.stiffness_std["cheeks"] < 0.5 * 0.5
    assert set(result.insertion_std) == set(result.strength_std)
    for name, stds in result.insertion_std.items():
        assert all(0.1 < std < 2.01 for std in stds)  # 2 mm beforehand
        informed = result.calibration.insertion.get(name, (0, 0))
        assert all(std < 1.8 for std, shift in zip(stds, informed, strict=True) if shift)
    assert not any(name.startswith("frontalis") for name in result.calibration.strength)
    assert result.calibration.frames == [3, 9]
    assert result.gain > 10
    assert not result.is_settled and "still moving after" in described(result)


def test_an_insertion_is_followed_as_far_as_it_is(mesh):
    """7 mm from where it is assumed: a round goes no further than 1.6 mm."""
    shifts = {f"zygomaticus_major.{side}": (0.0, 7.0) for side in "LR"}
    truth = modes_of(AttachedSkin(mesh, 1.0, Calibration({}, {}, shifts)))
    sightings = [seen(mesh, truth, 3, zygomaticus_major=0.9)]
    result = calibrate.estimate(mesh, sightings, CAMERA, POSE)
    assert result.is_settled and "still moving" not in described(result)
    for name in shifts:
        np.testing.assert_allclose(result.calibration.insertion[name], (0, 7), atol=0.6)


def test_every_number_is_said_with_its_deviation():
    found = Calibration(
        {"cheeks": 2.0}, {"mentalis.L": 1.0}, {"mentalis.L": (2.0, 0.0), "mentalis.R": (-1.0, 0.5)}
    )
    unknown = dict.fromkeys(REGIONS, 0.5)
    shifts = {"mentalis.L": (0.5, 1.95), "mentalis.R": (0.25, 1.2)}
    text = described(calibrate.CalibrationResult(found, unknown, {"mentalis.L": 0.2}, shifts, 3.0))
    lines = [" ".join(line.split()) for line in text.splitlines()]
    assert "mentalis.L +2.0 +1.5 to +2.5 0 not seen well enough" in lines
    assert "mentalis.R -1.0 -1.2 to -0.8 +0.5 -0.7 to +1.7" in lines
    assert "mentalis.L 1.00 0.82 to 1.22" in lines


def test_a_face_at_rest_tells_nothing(mesh):
    anatomy = modes_of(AttachedSkin(mesh, 1.0))
    still = [seen(mesh, anatomy, frame, zygomaticus_major=0.02) for frame in (1, 2)]
    with pytest.raises(calibrate.NothingSeen, match="no expression was seen"):
        calibrate.choose(still, 39)


def test_modes_follow_strength_and_insertion(mesh):
    usual = modes_of(AttachedSkin(mesh, 1.0))
    changed = Calibration({}, {"zygomaticus_major.L": 1.5}, {"zygomaticus_major.R": (2.0, 0.0)})
    other = modes_of(AttachedSkin(mesh, 1.0, changed))
    left, right = (muscle_names().index(f"zygomaticus_major.{side}") for side in "LR")
    np.testing.assert_allclose(other.muscle_modes[left], 1.5 * usual.muscle_modes[left])
    apart = np.abs(other.muscle_modes - usual.muscle_modes).max(axis=(1, 2))
    assert apart[right] > 1e-3
    assert np.delete(apart, [left, right]).max() == 0


@pytest.fixture
def fit():
    known = Calibration({"cheeks": 1.8}, {"mentalis.L": 0.9}, {"mentalis.L": (1.0, -0.5)}, [4, 9])
    return FaceFit(4, (480, 480), INTRINSICS, POSE, {}, calibration=known)


def test_a_fit_keeps_its_calibration_and_older_fits_have_none(tmp_path, fit):
    path = tmp_path / "fit.json"
    fit.save(path)
    assert FaceFit.load(path).calibration == fit.calibration
    assert "cheeks 1.80" in fit.calibration.notes()[0]
    document = json.loads(path.read_text()) | {"schema": 2}
    for key in ("calibration", "relief", "depth", "depth_std", "lines", "rest", "still_cover"):
        del document[key]
    path.write_text(json.dumps(document))
    assert FaceFit.load(path).calibration == Calibration()
    assert Calibration().notes() == []


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ([], "must be an object"),
        ({"softness": {}}, "unknown keys: softness"),
        ({"stiffness": {"ears": 1}}, "names ears"),
        ({"stiffness": {"cheeks": 0}}, "stiffness cheeks is 0"),
        ({"stiffness": {"cheeks": None}}, "stiffness cheeks"),
        ({"stiffness": [1]}, "stiffness must be an object"),
        ({"strength": {"mentalis.L": 1e9}}, "strength mentalis.L"),
        ({"strength": {str(i): 1 for i in range(2000)}}, "at most 1000"),
        ({"insertion": {"mentalis.L": [1]}}, "insertion mentalis.L"),
        ({"insertion": {"mentalis.L": [30, 1]}}, "moved by 30 mm"),
        ({"frames": [0]}, "frames must be"),
        ({"frames": 3}, "frames must be"),
    ],
)
def test_a_wrong_calibration_is_refused_by_name(tmp_path, fit, changed, text):
    path = tmp_path / "fit.json"
    fit.save(path)
    document = json.loads(path.read_text())
    path.write_text(json.dumps(document | {"calibration": changed}))
    with pytest.raises(InvalidInput, match=text) as refused:
        FaceFit.load(path)
    assert str(path) in str(refused.value)


def test_muscles_that_there_are_not_are_named(mesh):
    with pytest.raises(InvalidInput, match="muscles that there are not: levator"):
        modes_of(AttachedSkin(mesh, 1.0, Calibration({}, {"levator": 1.2})))


def test_the_command_refuses_what_cannot_be_calibrated(tmp_path, capsys, rendered_clip):
    clip, out = str(rendered_clip.footage), str(tmp_path / "fit.json")
    assert cli.main(["calibrate", clip, "--out", out, "--frames", "1:5"]) == 2
    assert "1:5 are 5" in capsys.readouterr().err
    assert cli.main(["calibrate", clip, "--out", str(tmp_path)]) == 2
    assert "give the name of a file" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
