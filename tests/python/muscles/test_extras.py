# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.character.shapes import shapes_of_extras
from mimetic.muscles import anatomy
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.muscles.extras import attach_extras, extras_table
from mimetic.skin.mesh import find_place, multiply
from mimetic.template.face_template import load_template

SYMMETRY = np.array([-1.0, 1.0, 1.0])
# Where value 1 takes the place at which an entry is measured, left side: outwards, up, forwards.
DIRECTIONS = {
    "oris_protrude_upper": (0, 0, 1),
    "oris_protrude_lower": (0, 0, 1),
    "oris_close_upper": (0, -1, 0),
    "oris_close_lower": (0, 1, 0),
    "lip_roll_upper": (0, 0, 1),
    "lip_roll_lower": (0, 0, 1),
    "air_cheek": (1, 0, 1),
    "air_lips": (0, 0, 1),
}
LOADED = [row for row in extras_table() if row["type"] != "gaze"]


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def skin(template):
    return anatomy.attach_skin(template.vertices, template)


@pytest.fixture(scope="module")
def extras(skin):
    return attach_extras(skin)


def mode(extras, name):
    return extras.modes[extras.names.index(name)]


def test_each_entry_has_its_modes_limits_and_slider(template, extras):
    assert len(extras.names) == len(set(extras.names)) == 17
    assert extras.modes.shape == (17, *template.vertices.shape)
    assert np.isfinite(extras.modes).all()
    assert (extras.limits[:, 0] <= 0).all()
    assert (extras.limits[:, 1] == 1).all()
    shapes = shapes_of_extras(extras)
    assert [shape.name for shape in shapes] == list(extras.names)
    assert {shape.group for shape in shapes} == {"Lips and Air", "Gaze"}


@pytest.mark.parametrize("row", LOADED, ids=lambda row: row["name"])
def test_skin_goes_as_far_as_said_and_the_right_way(skin, extras, row):
    name = row["name"] + (".L" if row.get("paired") else "")
    place = find_place(skin.mesh, *row["measured_at"], 0, "L")
    count = int(skin.mesh.template.num_skin_vertices)
    moved = multiply(skin.mesh.stencils, mode(extras, name)[:count])[place.vertex]
    assert np.linalg.norm(moved) == pytest.approx(1e-3 * row["excursion_mm"], rel=1e-6)
    direction = np.array(DIRECTIONS[row["name"]])
    tested = direction != 0
    assert (direction * moved)[tested].min() > 0.4 * np.linalg.norm(moved)


def test_left_and_right_mirror(template, extras):
    for name in extras.names:
        other = name[:-1] + "R" if name.endswith(".L") else name
        if not name.endswith(".R"):
            mirrored = mode(extras, other)[template.mirror] * SYMMETRY
            np.testing.assert_allclose(mirrored, mode(extras, name), atol=1e-9, err_msg=name)


def test_a_rolled_lip_turns(skin, extras):
    """Free edge forward, outer border back, about the lip's own length."""
    mesh = skin.mesh
    for lip in ("upper", "lower"):
        moved = mode(extras, f"lip_roll_{lip}")
        inner, outer = (mesh.landmark(f"lip_{lip}{end}") for end in ("_inner", ""))
        assert moved[inner, 2] - moved[outer, 2] > 0.002


def test_an_eye_turns_as_a_whole_and_stays_round(template, extras):
    eye = template.part_vertices("eye.L")
    (centre, _), radius = template.eye_spheres(template.vertices)
    front = eye[np.argmax(template.vertices[eye, 2])]
    ways = {"look_up": (1, 1), "look_down": (1, -1), "look_in": (0, -1), "look_out": (0, 1)}
    for name, (axis, sign) in ways.items():
        moved = mode(extras, f"{name}.L")
        turned = template.vertices[eye] + moved[eye]
        before = np.linalg.norm(template.vertices[eye] - centre, axis=1)
        # 0.3 mm: the eye turns about its own centre, this one is that of the nearest sphere
        np.testing.assert_allclose(np.linalg.norm(turned - centre, axis=1), before, atol=3e-4)
        assert sign * moved[front, axis] > 0.4 * radius
        others = np.delete(moved, eye, axis=0)
        assert others.any() == (name in ("look_up", "look_down"))


def test_lids_follow_the_eye_up_and_down(skin, template, extras):
    """The upper lid's middle turns 0.8 times as far, so that it keeps to the iris."""
    frame = eye_frames(skin.mesh)[0]
    lids = EyeLids(frame)
    for name, degrees, sign in (("look_up", 25, 1), ("look_down", 30, -1)):
        for margin, share in ((lids.upper, 0.8), (lids.lower, 0.3)):
            moved = mode(extras, f"{name}.L")[margin]
            _, before, _ = frame.polar(template.vertices[margin])
            _, after, _ = frame.polar(template.vertices[margin] + moved)
            turned = np.degrees(sign * (after - before))
            assert turned.min() > -0.1
            assert turned.max() == pytest.approx(share * degrees, rel=0.02)
    brow = skin.mesh.in_region("forehead")
    assert np.abs(mode(extras, "look_up.L")[: len(brow)][brow]).max() < 1e-12


def test_a_small_head_has_small_motions(template, extras):
    small = attach_extras(anatomy.attach_skin(0.8 * template.vertices, template))
    for name, own, usual in zip(extras.names, small.modes, extras.modes, strict=True):
        # 1 %: pre-stress does not go with the size
        assert np.linalg.norm(own) == pytest.approx(0.8 * np.linalg.norm(usual), rel=0.01), name
        cosine = (own * usual).sum() / np.linalg.norm(own) / np.linalg.norm(usual)
        assert cosine > 0.99, name
