# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import _core
from mimetic.muscles import anatomy
from mimetic.muscles.articulators import eye_frames
from mimetic.muscles.contact import attach_contact
from mimetic.muscles.extras import attach_extras
from mimetic.skin.mesh import multiply
from mimetic.template.face_template import load_template

from evaluation.anatomy.anatomy_sheet import expression
from evaluation.anatomy.contact_table import before_teeth, faces_at
from evaluation.anatomy.unit_muscles import EXPRESSIONS

SYMMETRY = np.array([-1.0, 1.0, 1.0])
LIDS = [f"lid_{lid}.{side}" for lid in ("upper", "lower") for side in "LR"]


@pytest.fixture(scope="module")
def skin():
    template = load_template()
    return anatomy.attach_skin(template.vertices, template)


@pytest.fixture(scope="module")
def modes(skin):
    anatomical, extras = anatomy.modes_of(skin), attach_extras(skin)
    modes = dict(zip(anatomical.muscle_names, anatomical.muscle_modes, strict=True))
    modes |= dict(zip(anatomical.articulator_names, anatomical.articulator_modes, strict=True))
    return modes | dict(zip(extras.names, extras.modes, strict=True))


@pytest.fixture(scope="module")
def contact(skin):
    return attach_contact(skin)


@pytest.fixture(scope="module")
def clearance(skin):
    """Smallest distance of the left lids' outer skin off the eyeball, of a displacement V x 3."""
    mesh, template = skin.mesh, skin.mesh.template
    centre = eye_frames(mesh)[0].centre
    body = _core.SubdividedMesh(
        np.ascontiguousarray(template.faces, np.int32), len(template.vertices), 1
    )
    part_of = np.asarray(template.part_names)[template.part[body.parent_face]]
    eye = np.unique(body.faces[part_of == "eye.L"])
    outer = np.unique(mesh.triangles[mesh.triangle_part == "skin"])
    rest = np.linalg.norm(mesh.vertices[outer] - centre, axis=1)
    lids = outer[rest < 1.4 * template.eye_radius]

    def measure(displacement):
        arm = body.positions(np.ascontiguousarray(template.vertices + displacement))[eye] - centre
        moved = multiply(mesh.stencils, displacement[: len(skin.free)])
        lid = (mesh.vertices + moved)[lids] - centre
        lid = lid[lid[:, 2] > 0.006]
        assert len(lid) > 50
        toward = arm / np.linalg.norm(arm, axis=1, keepdims=True)
        length = np.linalg.norm(lid, axis=1)
        below = np.argmax((lid / length[:, None]) @ toward.T, axis=1)
        return (length - np.linalg.norm(arm, axis=1)[below]).min()

    return measure


def test_a_point_is_found_in_its_triangle():
    corners = [np.array([p]) for p in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])]
    face, weights = faces_at(np.array([[0.25, 0.5], [0.8, 0.8]]), *corners)
    assert face.tolist() == [0, -1]
    np.testing.assert_allclose(weights[0], [0.25, 0.25, 0.5], atol=1e-12)


def test_what_does_not_touch_is_left_alone(contact, modes):
    for displacement in (np.zeros_like(modes["jaw_open"]), modes["jaw_open"]):
        assert contact.depth(displacement) < 2e-5
        np.testing.assert_array_equal(contact.relieve(displacement), displacement)


def test_pressed_lips_rest_on_each_other(skin, contact, modes):
    pressed = modes["oris_close_upper"] + modes["oris_close_lower"]
    relieved = contact.relieve(pressed)
    assert contact.depth(pressed) > 0.004
    assert contact.depth(relieved) < 1e-4
    mesh = skin.mesh
    upper, lower = (mesh.landmark(f"lip_{lip}_inner") for lip in ("upper", "lower"))
    height = (mesh.neutral + relieved)[[upper, lower], 1]
    assert 0 < height[0] - height[1] < 0.002  # closed
    mirrored = relieved[mesh.template.mirror] * SYMMETRY
    assert np.abs(mirrored - relieved).max() < 2e-4
    far = mesh.in_region("forehead") | mesh.in_region("ear")
    change = (relieved - pressed)[: len(far)]
    assert np.linalg.norm(change[far], axis=1).max() < 1e-5


@pytest.mark.parametrize("title", EXPRESSIONS)
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_lips_and_lids_of_expressions_do_not_pass_through_each_other(
    skin, contact, modes, title, share
):
    relieved = contact.relieve(expression(modes, title, share))
    assert contact.depth(relieved) < 1e-4
    assert before_teeth(skin.mesh, relieved) > 0.003


def test_both_lids_closed_meet_and_stay_on_the_eye(contact, modes, clearance):
    closed = sum(modes[name] for name in LIDS)
    relieved = contact.relieve(closed)
    assert contact.depth(closed) > 0.001
    assert contact.depth(relieved) < 1e-4
    assert clearance(relieved) > 2e-4


@pytest.mark.parametrize("value", np.linspace(0.1, 1, 10))
def test_lids_never_go_through_the_eye_also_when_it_turns(contact, modes, clearance, value):
    for lids in (LIDS[:2], LIDS[2:], LIDS):
        for gaze in ("look_up", "look_down", "look_in", "look_out"):
            eyes = modes[f"{gaze}.L"] + modes[f"{gaze}.R"]
            turned = contact.relieve(sum(value * modes[name] for name in lids) + eyes)
            assert clearance(turned) > 2e-4
            assert contact.depth(turned) < 1e-4
    assert clearance(-0.4 * value * (modes[LIDS[0]] + modes[LIDS[1]])) > 2e-4


def test_a_lid_that_follows_an_eye_alone_needs_no_contact(contact, modes, clearance):
    for gaze in ("look_up", "look_down"):
        for value in np.linspace(0.1, 1, 10):
            turned = value * (modes[f"{gaze}.L"] + modes[f"{gaze}.R"])
            assert clearance(turned) > 2e-4
            np.testing.assert_array_equal(contact.relieve(turned), turned)


def test_a_lip_behind_the_teeth_is_seen(skin):
    pushed_in = np.zeros_like(skin.mesh.neutral)
    lip = skin.mesh.in_region("lower_lip") | skin.mesh.in_region("chin")
    pushed_in[np.flatnonzero(lip)] = [0.0, 0.0, -0.03]
    assert before_teeth(skin.mesh, pushed_in) < -0.005
