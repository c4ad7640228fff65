# SPDX-License-Identifier: GPL-3.0-or-later
import time

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.muscles import anatomy
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.skin.mesh import SkinMesh, find_place
from mimetic.template.face_template import load_template

SYMMETRY = np.array([-1.0, 1.0, 1.0])
# Where each muscle of the left side takes the place at which it is measured: outwards, up,
# forwards; 0 is not tested.
DIRECTIONS = {
    "frontalis_medial": (0, 1, 0),
    "frontalis_middle": (0, 1, 0),
    "frontalis_lateral": (0, 1, 0),
    "corrugator_supercilii": (-1, -1, 0),
    "procerus": (0, -1, 0),
    "depressor_supercilii": (-1, -1, 0),
    "orbicularis_oculi_inferior": (0, 1, 0),
    "orbicularis_oculi_lateral": (-1, 0, 0),
    "levator_labii_superioris_alaeque_nasi": (0, 1, 0),
    "levator_labii_superioris": (0, 1, 0),
    "zygomaticus_minor": (1, 1, 0),
    "zygomaticus_major": (1, 1, -1),
    "levator_anguli_oris": (0, 1, 0),
    "risorius": (1, 0, -1),
    "depressor_anguli_oris": (0, -1, 0),
    "depressor_labii_inferioris": (0, -1, 0),
    "mentalis": (0, 1, 0),
    "orbicularis_oris": (-1, 0, 1),
}


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def attached(template):
    start = time.process_time()
    result = anatomy.attach(template.vertices, template)
    print(f"attach: {time.process_time() - start:.2f} s of processor time")
    return result


@pytest.fixture(scope="module")
def skin(template):
    return SkinMesh(template, template.vertices)


def measured(skin, attached, name):
    """Displacement at activation 1 of the place at which a left muscle is measured, metres."""
    row = next(row for row in anatomy.muscle_table() if row["name"] == name)
    anchor, x, y = row["measured_at"]
    vertex = find_place(skin, anchor, x, y, 0, "L").vertex
    count = int(skin.template.num_skin_vertices)
    mode = attached.muscle_modes[attached.muscle_names.index(f"{name}.L")]
    return skin.refinement.positions(np.ascontiguousarray(mode[:count]))[vertex]


def articulator(attached, name):
    return attached.articulator_modes[attached.articulator_names.index(name)]


def part(template, *names):
    chosen = [list(template.part_names).index(name) for name in names]
    return np.unique(template.faces[np.isin(template.part, chosen)])


def test_there_are_36_muscles_in_seven_groups(template, attached):
    assert len(set(attached.muscle_names)) == 36
    assert all(name[-2:] in (".L", ".R") for name in attached.muscle_names)
    assert np.bincount(attached.groups).tolist() == [0, 8, 4, 4, 4, 6, 6, 4]
    assert attached.muscle_modes.shape == (36, *np.shape(template.vertices))
    assert attached.articulator_modes.shape == (7, *np.shape(template.vertices))
    assert (attached.articulator_limits[:, 0] <= 0).all()
    assert (attached.articulator_limits[:, 1] == 1).all()
    assert np.isfinite(attached.muscle_modes).all()
    assert np.isfinite(attached.articulator_modes).all()


def test_left_and_right_mirror(template, attached):
    left, right = attached.muscle_modes[::2], attached.muscle_modes[1::2]
    assert np.abs(right[:, template.mirror] * SYMMETRY - left).max() < 1e-9
    for name in ("lid_upper", "lid_lower"):
        left, right = (articulator(attached, f"{name}.{side}") for side in "LR")
        assert np.abs(right[template.mirror] * SYMMETRY - left).max() < 1e-9
    for name in ("jaw_open", "jaw_thrust"):
        mode = articulator(attached, name)
        assert np.abs(mode[template.mirror] * SYMMETRY - mode).max() < 1e-9


@pytest.mark.parametrize("row", anatomy.muscle_table(), ids=lambda row: row["name"])
def test_muscle_moves_its_place_as_far_as_published_and_the_right_way(skin, attached, row):
    motion = measured(skin, attached, row["name"])
    assert np.linalg.norm(motion) == pytest.approx(1e-3 * row["excursion_mm"], rel=1e-6)
    direction = np.array(DIRECTIONS[row["name"]])
    tested = direction != 0
    assert (direction * motion)[tested].min() > 0.15 * np.linalg.norm(motion)


def test_excursions_lie_in_the_published_ranges(skin, attached):
    smile = np.linalg.norm(measured(skin, attached, "zygomaticus_major"))
    assert 0.011 <= smile <= 0.014  # Flynn et al., face FE
    whole = [f"frontalis_{third}.L" for third in ("medial", "middle", "lateral")]
    raised = sum(attached.muscle_modes[attached.muscle_names.index(name)] for name in whole)
    for name in ("brow_inner.L", "brow_middle.L", "brow_outer.L"):
        assert 0.008 <= raised[skin.landmark(name), 1] <= 0.012


def test_modes_are_smooth_and_stay_in_proportion(template, attached):
    faces = template.faces[: int(template.num_skin_faces)]
    faces = faces[template.part[: len(faces)] == list(template.part_names).index("skin")]
    edges = np.vstack([faces[:, [k, (k + 1) % 4]] for k in range(4)])
    lengths = np.linalg.norm(
        template.vertices[edges[:, 0]] - template.vertices[edges[:, 1]], axis=1
    )
    for name, mode in zip(attached.muscle_names, attached.muscle_modes, strict=True):
        moved = np.linalg.norm(mode, axis=1)
        assert moved.max() < 0.016, name
        step = np.linalg.norm(mode[edges[:, 0]] - mode[edges[:, 1]], axis=1)
        # No vertex leaves its neighbours: nothing beyond a steep, even slope over 5 mm.
        assert (step / np.maximum(lengths, 0.005)).max() < 1.0, name


def test_brow_raisers_leave_the_lids_on_the_eye(skin, attached):
    margin = skin.vertices_between("skin", "eye_socket")
    for name, mode in zip(attached.muscle_names, attached.muscle_modes, strict=True):
        if name.startswith("frontalis"):
            assert np.linalg.norm(mode[margin], axis=1).max() < 1e-3, name


def test_lid_closes_over_the_eye_and_not_through_it(template, skin, attached):
    for frame in eye_frames(skin):
        lids = EyeLids(frame)
        mode = articulator(attached, f"lid_upper.{frame.side}")
        closed = template.vertices + mode
        middle = skin.landmark(f"lid_upper.{frame.side}")
        assert np.linalg.norm(mode[middle]) > 0.008
        gap = closed[lids.upper][:, None] - template.vertices[lids.lower][None]
        assert np.linalg.norm(gap, axis=2).min(axis=1).max() < 2.5e-3  # vertices lie 4 mm apart
        up = frame.polar(closed[lids.upper])[1]
        where, low, _ = frame.polar(template.vertices[lids.lower])
        order = np.argsort(where)
        along = frame.polar(closed[lids.upper])[0]
        opening = np.interp(along, where[order], low[order]) - up
        assert np.abs(opening).max() < np.radians(3)
        for value in (-0.4, 0.25, 0.5, 0.75, 1.0):
            lid = template.vertices[lids.upper] + value * mode[lids.upper]
            assert np.linalg.norm(lid - frame.centre, axis=1).min() > float(template.eye_radius)


def test_lashes_follow_their_lids(template, attached):
    lashes = part(template, "lashes.L")
    closing = np.linalg.norm(articulator(attached, "lid_upper.L")[lashes], axis=1)
    assert closing.max() > 0.008
    assert closing.min() < 0.001  # those of the lower lid stay
    assert not articulator(attached, "lid_upper.L")[part(template, "lashes.R")].any()


def test_jaw_opens_the_mouth_and_takes_teeth_and_tongue_along(template, skin, attached):
    mode = articulator(attached, "jaw_open")
    upper, lower = (skin.landmark(f"lip_{lip}_inner") for lip in ("upper", "lower"))
    gap = (template.vertices + mode)[upper] - (template.vertices + mode)[lower]
    assert gap[1] > 0.018
    assert np.linalg.norm(mode[upper]) < 0.008
    assert mode[skin.landmark("chin"), 1] < -0.02
    bone = part(template, "teeth_lower", "tongue")
    before = template.vertices[bone] - template.vertices[bone[0]]
    after = (template.vertices + mode)[bone] - (template.vertices + mode)[bone[0]]
    np.testing.assert_allclose(
        np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1), atol=1e-12
    )
    still = part(template, "teeth_upper", "eye.L", "eye.R")
    assert not attached.articulator_modes[:, still].any()
    assert not attached.muscle_modes[:, still].any()


def test_jaw_goes_to_the_subjects_left_and_forwards(skin, attached):
    chin = skin.landmark("chin")
    assert articulator(attached, "jaw_side")[chin, 0] > 0.004
    assert articulator(attached, "jaw_thrust")[chin, 2] > 0.004


def test_another_person_gets_the_same_muscles_on_their_own_face(template, attached):
    random = np.random.default_rng(4)
    limits = np.asarray(template.identity_limits)
    values = 0.25 * random.uniform(limits[:, 0], limits[:, 1])
    neutral = template.vertices + np.einsum("i,ivc->vc", values, template.identity_modes)
    other = anatomy.attach(neutral, template)
    assert np.isfinite(other.muscle_modes).all()
    person = SkinMesh(template, neutral)
    canonical = SkinMesh(template, template.vertices)
    row = next(row for row in anatomy.muscle_table() if row["name"] == "zygomaticus_major")
    place = find_place(canonical, *row["measured_at"], 0, "L")
    mode = other.muscle_modes[other.muscle_names.index("zygomaticus_major.L")]
    count = int(template.num_skin_vertices)
    moved = person.refinement.positions(np.ascontiguousarray(mode[:count]))[place.vertex]
    assert np.linalg.norm(moved) == pytest.approx(0.012 * place.scale(person), rel=1e-6)
    for own, template_mode in zip(other.muscle_modes, attached.muscle_modes, strict=True):
        cosine = (own * template_mode).sum() / np.linalg.norm(own) / np.linalg.norm(template_mode)
        assert 0.8 < cosine < 1 - 1e-9


def test_perturbed_anatomy_is_seeded_and_different(template, attached):
    shifted, again, other = (
        anatomy.attach(
            template.vertices,
            template,
            perturbation=anatomy.AnatomyPerturbation(insertion_mm=3, stiffness_factor=2, seed=seed),
        ).muscle_modes
        for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(shifted, again)
    assert np.abs(shifted - other).max() > 5e-4
    assert np.abs(shifted - attached.muscle_modes).max() > 1e-3


def test_bad_input_is_refused_with_the_reason(template):
    with pytest.raises(InvalidInput, match="needed are"):
        anatomy.attach(template.vertices[:-1], template)
    broken = template.vertices.copy()
    broken[10, 1] = np.nan
    with pytest.raises(InvalidInput, match="NaN"):
        anatomy.attach(broken, template)
    with pytest.raises(InvalidInput, match="insertion_mm"):
        anatomy.AnatomyPerturbation(insertion_mm=-1)
    with pytest.raises(InvalidInput, match="stiffness_factor"):
        anatomy.AnatomyPerturbation(stiffness_factor=0)
    with pytest.raises(InvalidInput, match="no landmark 'third_eye'"):
        SkinMesh(template, template.vertices).landmark("third_eye")


def test_the_jaw_moves_any_head_as_it_moves_the_templates(template, skin, attached):
    own = anatomy.AttachedSkin(skin, 1.0)
    jaw = _core.Jaw(skin)
    # As a head of another make: its vertices in another order, and one that follows no skin
    order = np.random.default_rng(2).permutation(len(template.vertices))
    back = np.argsort(order)
    teeth = np.flatnonzero(np.isin(order, part(template, "teeth_lower", "tongue")))
    head = _core.HeadOnJaw(
        skin=skin.vertices,
        influence=jaw.influence,
        vertices=np.vstack([template.vertices[order], [[0, 0, 0]]]),
        moves_with=np.append(own.moves_with[order], -1),
        rigid=teeth.tolist(),
    )
    modes = _core.jaw_modes(own, jaw, head)
    np.testing.assert_allclose(modes[:, back], attached.articulator_modes[:3], atol=1e-12)
    np.testing.assert_array_equal(modes[:, -1], 0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"influence": np.ones(3)}, "influence on 3 vertices"),
        ({"rigid": [-1]}, "not among the head's"),
        ({"rigid": [10**6]}, "not among the head's"),
        ({"moves_with": np.zeros(2, np.int32)}, "not among the head's"),
    ],
)
def test_a_jaw_refuses_a_head_that_does_not_fit(template, skin, changes, message):
    own = anatomy.AttachedSkin(skin, 1.0)
    jaw = _core.Jaw(skin)
    fields = {
        "skin": skin.vertices,
        "influence": jaw.influence,
        "vertices": template.vertices,
        "moves_with": own.moves_with,
        "rigid": [0],
    }
    with pytest.raises(InvalidInput, match=message):
        _core.jaw_modes(own, jaw, _core.HeadOnJaw(**(fields | changes)))


def test_a_skin_is_not_spread_from_vertices_that_it_has_not():
    with pytest.raises(InvalidInput, match="vertex 2 of the skin is followed, it has 2"):
        _core.spread(np.zeros((1, 2, 3)), np.array([0, -1, 2], np.int32))
