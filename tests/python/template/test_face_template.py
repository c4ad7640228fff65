# SPDX-License-Identifier: GPL-3.0-or-later
"""The head as installed: sound as a mesh, symmetric, human in its measures."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import KEYS, load_template

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts" / "build"
sys.path.insert(0, str(SCRIPTS))

from face import checks, topology  # noqa: E402
from face.source import SourceError  # noqa: E402


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture
def arrays():
    with np.load(data_folder() / "face.npz", allow_pickle=False) as archive:
        return dict(archive)


def millimetres(template, a, b):
    ends = template.vertices[[template.landmark(a), template.landmark(b)]]
    return 1000 * np.linalg.norm(ends[0] - ends[1])


def test_all_checks_of_make_face_hold(arrays):
    report = checks.check_template(arrays)
    assert "largest asymmetry" in report


@pytest.mark.parametrize(
    ("break_it", "reason"),
    [
        (lambda a: a["vertices"].__setitem__((0, 0), a["vertices"][0, 0] + 1e-3), "symmetric"),
        (lambda a: a["faces"].__setitem__(5, a["faces"][5][::-1]), "winds alike"),
        (lambda a: a["faces"].__setitem__(5, a["faces"][6]), "winds alike"),
        (lambda a: a["unit_modes"].__setitem__((3, 0, 0), 0.01), "symmetric"),
        (lambda a: a["vertices"].__setitem__(a["faces"][7], a["vertices"][7]), "area"),
        (lambda a: a.__setitem__("faces", a["faces"][:, ::-1].copy()), "faces outward"),
    ],
)
def test_the_checks_find_what_is_broken(arrays, break_it, reason):
    break_it(arrays)
    with pytest.raises(SourceError, match=reason):
        checks.check_template(arrays)


def test_frame_and_scale(template):
    tragi = template.vertices[[template.landmark("tragus.L"), template.landmark("tragus.R")]]
    np.testing.assert_allclose(tragi.mean(0), 0, atol=1e-12)
    assert tragi[0, 0] > 0  # the subject's left is +x
    distance = np.linalg.norm(template.eye_centers[0] - template.eye_centers[1])
    assert distance == pytest.approx(0.063, abs=1e-9)
    assert template.vertices[template.landmark("nose_tip"), 2] > 0.08
    centers, radius = template.eye_spheres(template.vertices)
    np.testing.assert_allclose(centers, template.eye_centers, atol=1e-9)
    assert radius == pytest.approx(template.eye_radius)


# Adult means of both sexes with more than two standard deviations either side, mm; after Farkas,
# Anthropometry of the Head and Face, 1994.
@pytest.mark.parametrize(
    ("start", "end", "low", "high"),
    [
        ("nose_bridge", "menton", 104, 134),
        ("zygion.L", "zygion.R", 122, 150),
        ("gonion.L", "gonion.R", 84, 120),
        ("mouth_corner.L", "mouth_corner.R", 44, 62),
        ("eye_inner.L", "eye_inner.R", 26, 40),
        ("eye_outer.L", "eye_outer.R", 80, 100),
        ("ala.L", "ala.R", 28, 42),
        ("nose_bridge", "nose_base", 44, 62),
        ("lip_upper", "lip_lower", 12, 26),
        ("glabella", "hairline", 44, 75),
    ],
)
def test_measures_are_human(template, start, end, low, high):
    assert low < millimetres(template, start, end) < high


def test_landmarks_stand_in_order(template):
    def height(name):
        return template.vertices[template.landmark(name), 1]

    down = ["hairline", "glabella", "nose_bridge", "nose_tip", "nose_base", "lip_upper"]
    down += ["lip_upper_inner", "lip_lower_inner", "lip_lower", "chin", "menton"]
    heights = [height(name) for name in down]
    assert heights == sorted(heights, reverse=True)
    assert height("brow_middle.L") > height("lid_upper.L") > height("lid_lower.L")
    for name in template.landmark_names:
        if name.endswith(".L"):
            left, right = template.landmark(name), template.landmark(name[:-1] + "R")
            assert template.mirror[left] == right
            assert template.vertices[left, 0] > 0


@pytest.mark.parametrize(
    ("landmark", "region"),
    [
        ("hairline", "scalp forehead"),
        ("nose_tip", "nose"),
        ("nose_bridge", "nasal_bridge"),
        ("lip_upper", "upper_lip"),
        ("lip_lower", "lower_lip"),
        ("lip_upper_inner", "upper_lip"),
        ("lip_lower_inner", "lower_lip"),
        ("chin", "chin"),
        ("lid_upper.L", "eyelid"),
        ("lid_lower.R", "eyelid"),
        ("brow_middle.R", "brow"),
        ("tragus.L", "ear"),
        ("zygion.R", "zygomatic"),
        ("gonion.L", "jaw_line neck"),
    ],
)
def test_landmarks_lie_in_their_regions(template, landmark, region):
    assert template.in_region(*region.split())[template.landmark(landmark)]


def test_every_region_has_vertices_and_is_symmetric(template):
    count = np.bincount(template.region, minlength=len(template.region_names))
    assert count.min() > 20
    mirrored = template.region[template.mirror[: template.num_skin_vertices]]
    np.testing.assert_array_equal(mirrored, template.region)


def test_nothing_pokes_through_the_closed_lips(template):
    slit = template.vertices[template.landmark("lip_upper_inner")]
    teeth = template.vertices[template.part_vertices("teeth_upper", "teeth_lower", "tongue")]
    assert teeth[:, 2].max() < slit[2]


def test_no_gap_between_lids_and_eyeballs(template):
    """The margin's rear edge stays on the eye; the lining behind dips under the eye all round."""
    skin = template.faces[template.part_faces("skin")]
    socket = template.faces[template.part_faces("eye_socket")]
    ring = topology.rings(socket, np.intersect1d(skin, socket), len(template.vertices))
    for side, center in zip((1, -1), template.eye_centers, strict=True):
        own = side * template.vertices[:, 0] > 0
        gap = np.linalg.norm(template.vertices - center, axis=1) - template.eye_radius
        assert gap[own & (ring == 0)].min() > -0.0005
        assert np.median(gap[own & (ring == 0)]) < 0.002
        assert gap[own & (ring == 3)].max() < 0


def test_eyes_and_lashes_unfold_onto_any_picture(template):
    for side, center in zip("LR", template.eye_centers, strict=True):
        on_eye = template.part_faces(f"eye.{side}")
        away = template.vertices[template.faces[on_eye]] - center
        straight = np.arccos(away[..., 2] / np.linalg.norm(away, axis=-1))
        from_middle = np.linalg.norm(template.uv[on_eye] - 0.5, axis=-1)
        np.testing.assert_allclose(from_middle, straight / (2 * np.pi), atol=1e-5)
        lashes = template.part_faces(f"lashes.{side}")
        corner, uv = template.vertices[template.faces[lashes]], template.uv[lashes]
        assert uv.min() == 0
        assert uv.max() == 1
        gap = np.linalg.norm(corner - center, axis=-1)
        assert gap[uv[..., 1] == 0].mean() < gap[uv[..., 1] == 1].mean() - 0.002
        inward = np.abs(corner[..., 0])
        assert inward[uv[..., 0] == 0].mean() < inward[uv[..., 0] == 1].mean() - 0.015


def test_identity_modes_keep_frame_and_scale(template):
    tragi = [template.landmark("tragus.L"), template.landmark("tragus.R")]
    np.testing.assert_allclose(template.identity_modes[:, tragi].mean(1), 0, atol=1e-6)
    person = template.neutral({"sex_male": 1.0, "eye_trans_side": 0.5, "weight": -0.5})
    centers, _ = template.eye_spheres(person)
    assert np.linalg.norm(centers[0] - centers[1]) == pytest.approx(0.063, abs=2e-4)
    assert 60 <= len(template.identity_names) <= 130
    reach = np.linalg.norm(template.identity_modes, axis=2).max(1)
    assert reach.min() > 0.4e-3
    assert reach.max() < 0.06


def test_identity_modes_are_independent(template):
    visible = template.part_vertices("skin")
    modes = template.identity_modes[:, visible].reshape(len(template.identity_names), -1)
    unit = modes / np.linalg.norm(modes, axis=1, keepdims=True)
    likeness = np.abs(unit @ unit.T) - np.eye(len(unit))
    assert likeness.max() < 0.98


def test_units_move_their_own_side(template):
    left = template.unit_modes[template.unit_names.index("mouthSmileLeft")]
    moved = np.linalg.norm(left, axis=1)
    assert (moved @ template.vertices[:, 0]) / moved.sum() > 0.015
    corner = template.landmark("mouth_corner.L")
    assert left[corner, 0] > 0.003
    assert left[corner, 1] > 0.003


def test_unknown_names_are_named(template):
    with pytest.raises(InvalidInput, match="no landmark 'navel'"):
        template.landmark("navel")
    with pytest.raises(InvalidInput, match="no identity mode 'tail'"):
        template.neutral({"tail": 1.0})
    with pytest.raises(InvalidInput, match="finite"):
        template.neutral({"sex_male": float("nan")})


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda a: a.pop("mirror"), "lacks mirror"),
        (lambda a: a.__setitem__("faces", a["faces"][:, :3]), "faces has shape"),
        (lambda a: a.__setitem__("faces", a["faces"].astype(np.float64)), "faces is float64"),
        (lambda a: a["faces"].__setitem__((0, 0), 10**6), "faces must lie in"),
        (lambda a: a["vertices"].__setitem__((0, 0), np.nan), "vertices is not finite"),
        (lambda a: a.__setitem__("part_names", np.array([{}], object)), "Python objects"),
        (lambda a: a.__setitem__("region", a["region"][:-1]), "skin counts"),
    ],
)
def test_a_bad_file_is_refused(tmp_path, arrays, change, reason):
    change(arrays)
    path = tmp_path / "face.npz"
    np.savez(path, **{key: arrays[key] for key in KEYS if key in arrays})
    with pytest.raises(InvalidInput, match=reason):
        load_template(path)


def test_a_missing_or_truncated_file(tmp_path):
    with pytest.raises(UnreadableMedia, match="make_face"):
        load_template(tmp_path / "none.npz")
    whole = (data_folder() / "face.npz").read_bytes()
    (tmp_path / "half.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UnreadableMedia, match="not a face template"):
        load_template(tmp_path / "half.npz")


def test_the_rows_of_teeth_meet_as_they_are_shown(template):
    """Subdivided: between rows that shrink, a clenched smile shows the tongue."""
    mesh = _core.SubdividedMesh(template.faces, len(template.vertices), 2)
    shown = mesh.positions(np.ascontiguousarray(template.vertices))
    rows = []
    for name in ("teeth_upper", "teeth_lower"):
        faces = np.isin(mesh.parent_face, template.part_faces(name))
        points = shown[np.unique(mesh.faces[faces])]
        rows.append(points[(np.abs(points[:, 0]) < 0.008) & (points[:, 2] > 0.08)])
    upper, lower = rows
    assert 0 < lower[:, 1].max() - upper[:, 1].min() < 2e-3
    assert upper[:, 2].max() > lower[:, 2].max()  # it bites before the lower
    lip = template.vertices[template.landmark("lip_upper_inner")]
    assert 0 < lip[1] - upper[:, 1].min() < 3e-3  # seen when lips part
