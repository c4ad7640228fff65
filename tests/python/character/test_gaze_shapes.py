"""Eyes that turn: rigid in the file, rigid by shapes, sliders of heads, lids that go along."""

import dataclasses

import numpy as np
import pytest
from looking_performance import LIDS, RADIUS, make_looking
from mimetic import InvalidInput, _core
from mimetic.character.gaze_shapes import angles_of_keys, turned_keys
from mimetic.character.shapes import shapes_of, slider_shapes_of
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, expression_of, gaze_of, iris_circles
from mimetic.performance.projection import reference_index


@pytest.fixture
def looking():
    return make_looking()


def test_eyeballs_turn_rigidly_to_where_the_gaze_is(looking):
    i, left = 8, looking.eye_of_vertex == 1
    before = looking.neutral_vertices[left] - looking.eye_centers[0]
    after = looking.surface(i)[left] - looking.eye_centers[0]
    np.testing.assert_allclose(after @ after.T, before @ before.T, atol=1e-12)
    yaw, pitch = gaze_of(looking)[i, :2]
    rotation = np.linalg.lstsq(before, after, rcond=None)[0].T
    np.testing.assert_allclose(rotation[:, 2], _core.gaze_direction(yaw, pitch), atol=1e-9)
    np.testing.assert_allclose(rotation[0, 1], rotation[1, 0], atol=1e-9)  # no torsion


def test_positive_angles_are_to_the_subjects_left_and_up():
    np.testing.assert_allclose(_core.gaze_direction(90, 0), [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(_core.gaze_direction(0, 90), [0, 1, 0], atol=1e-12)


def test_shapes_add_up_to_the_surface_with_turned_eyes(looking):
    shapes = shapes_of(looking)
    assert {"eye_down.L", "eye_left_left.R"} <= {shape.name for shape in shapes}
    assert not {shape.name for shape in shapes} & set(GAZE)
    for i in (0, 5, 11):
        total = looking.neutral_vertices + sum(s.values[i] * s.offsets for s in shapes)
        np.testing.assert_allclose(total, looking.surface(i), atol=1e-7)


def test_a_look_downwards_lowers_the_lid_and_is_no_closure(looking):
    looks_down = looking.surface(11)[:10, 1] - looking.surface(0)[:10, 1]
    other = dataclasses.replace(
        looking, articulator_values=looking.articulator_values * np.r_[1, 1, 1, 1, np.zeros(4)]
    )
    by_muscles = other.surface(11)[:10, 1] - other.surface(0)[:10, 1]
    carried = 0.02 * np.clip([-3 + 25, -3 - 20], -30, 35) * 0.8  # of what the lid leaves open
    np.testing.assert_allclose(
        looks_down - by_muscles, -0.01 * (carried[0] - carried[1]), atol=1e-6
    )


def test_shut_lids_stay_shut_wherever_the_eye_looks():
    values = make_looking().articulator_values.copy()
    values[:, 2:4] = 1
    shut = make_looking(articulator_values=values)
    lids = [shape.values for shape in shapes_of(shut) if shape.name in LIDS]
    np.testing.assert_allclose(lids, 1, atol=1e-12)


def test_heads_with_sliders_look_by_them(looking):
    shapes = {shape.name: shape.values for shape in slider_shapes_of(looking)}
    assert not any(name.startswith("eye_") for name in shapes)
    yaw, pitch = gaze_of(looking).T[:2]
    np.testing.assert_allclose(shapes["look_out.L"], np.maximum(yaw, 0) / 35)
    np.testing.assert_allclose(shapes["look_in.R"], np.maximum(yaw, 0) / 35)
    np.testing.assert_allclose(shapes["look_down.R"], np.maximum(-pitch, 0) / 30)
    np.testing.assert_allclose(shapes["look_up.R"], np.maximum(pitch, 0) / 25)
    seen = next(shape.values for shape in shapes_of(looking) if shape.name == "lid_upper.L")
    np.testing.assert_allclose(shapes["lid_upper.L"] - 0.02 * pitch, seen, atol=1e-12)


def test_faces_that_five_shapes_an_eye_turn_look_by_those(looking):
    of_its_own = shapes_of(looking)
    played = slider_shapes_of(looking, [shape.name for shape in of_its_own])
    assert [shape.name for shape in played] == [shape.name for shape in of_its_own]
    for shape, own in zip(played, of_its_own, strict=True):
        np.testing.assert_array_equal(shape.values, own.values)


def test_sliders_in_degrees_are_what_the_keys_turn():
    yaw, pitch = np.radians([-23.0, 14.0])
    assert angles_of_keys("L", turned_keys("L", yaw, pitch)) == pytest.approx((yaw, pitch))
    assert angles_of_keys("R", {}) == (0, 0)


def test_the_iris_is_on_the_turned_ball(looking):
    circles = iris_circles(looking, 3)
    np.testing.assert_allclose(
        np.linalg.norm(circles - looking.eye_centers[:, None], axis=2), RADIUS, atol=1e-9
    )
    yaw, pitch = gaze_of(looking)[3, 2:]
    np.testing.assert_allclose(
        circles[1, 0], looking.eye_centers[1] + RADIUS * _core.gaze_direction(yaw, pitch)
    )


def test_a_performance_keeps_its_eyes(looking, tmp_path):
    looking.save(tmp_path / "performance.npz")
    loaded = Performance.load(tmp_path / "performance.npz")
    np.testing.assert_array_equal(loaded.surface(7), looking.surface(7))


@pytest.mark.parametrize("key", ["eye_centers", "iris_centers", "eye_of_vertex", "lid_following"])
def test_eyes_need_all_their_keys(key):
    with pytest.raises(InvalidInput, match=f"without {key}"):
        make_looking(**{key: None})


def test_eyes_need_their_angles(looking):
    with pytest.raises(InvalidInput, match=r"without gaze_yaw\.L"):
        make_looking(articulators=[*looking.articulators[:4], "a", "b", "c", "d"])


def test_vertices_belong_to_one_of_two_eyes(looking):
    with pytest.raises(InvalidInput, match="eye_of_vertex"):
        make_looking(eye_of_vertex=looking.eye_of_vertex + 1)


def test_degrees_do_not_count_as_expression():
    """Colours are taken from a frame at rest; a glance of 20 degrees is no grimace of 20."""
    still = make_looking()
    values = still.articulator_values.copy()
    values[:, -4:] = 0
    values[:, :2] = 0.5
    values[4, :2] = 0
    values[4, -4:] = 3.0
    one = make_looking(articulator_values=values, quality=np.ones(still.num_frames))
    one = dataclasses.replace(one, activations=np.zeros_like(one.activations))
    assert np.abs(expression_of(one)[4]).sum() < 1
    assert reference_index(dataclasses.replace(one, head_pose=one.head_pose[[0] * 12])) == 4
