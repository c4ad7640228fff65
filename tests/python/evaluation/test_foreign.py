# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads of another make: how they are filmed, moved and scored."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core

from evaluation.runs import foreign
from evaluation.synthetic.characters import FETCHED
from evaluation.synthetic.foreign import films, head_mesh, recipes, shapes


def points_of_a_face(seed=3):
    random = np.random.default_rng(seed)
    across = random.uniform(-0.07, 0.07, (400, 2))
    return np.column_stack([across, 0.06 - 8 * (across**2).sum(1)])


def test_depth_is_compared_once_the_head_is_turned_moved_and_scaled():
    points = points_of_a_face()
    turn = _core.from_rotation_vectors(np.array([[0.1, -0.2, 0.05]]))[0]
    elsewhere = 1.3 * points @ turn.T + (0.2, 0.1, 0.9)
    depth, _ = foreign.depth_errors(points, elsewhere)
    assert np.abs(depth).max() < 1e-6


def test_depth_that_is_wrong_at_the_sides_is_told_as_such():
    points = points_of_a_face()
    flat = points.copy()
    flat[np.abs(points[:, 0]) > 0.05, 2] += 0.004
    flat[7] = np.nan  # no surface there
    depth, is_side = foreign.depth_errors(points, flat)
    assert np.isnan(depth[7])
    known = np.isfinite(depth)
    assert np.sqrt((depth[is_side & known] ** 2).mean()) > 1.5 * np.sqrt(
        (depth[~is_side & known] ** 2).mean()
    )
    in_middle = np.abs(points[:, 0]) < 0.03
    assert is_side[in_middle & (points[:, 1] < -0.055)].all()
    assert not is_side[in_middle & (points[:, 1] > 0)].any()


def turned(*degrees):
    poses = np.tile(np.eye(4), (len(degrees), 1, 1))
    vectors = np.radians([(0, angle, 0) for angle in degrees])
    poses[:, :3, :3] = _core.from_rotation_vectors(np.ascontiguousarray(vectors))
    return poses


def test_turns_are_compared_since_the_first_frame():
    axes = turned(25)[0]  # of the other head frame
    assert np.abs(foreign.turn_errors(turned(0, 10, 30), turned(0, 10, 30) @ axes)).max() < 1e-5
    errors = foreign.turn_errors(turned(0, 10, 30), turned(5, 15, 38) @ axes)
    assert np.allclose(errors, (0, 0, 3), atol=1e-5)


def test_nobody_is_in_two_sets():
    seeds = [{film.seed for film in some} for some in recipes.SETS.values()]
    assert len(set.union(*seeds)) == sum(map(len, seeds))


@pytest.mark.parametrize("which", ["tuning", "held-out"])
def test_heads_turn_by_thirty_to_forty_degrees_and_stay_there(which):
    times = np.arange(recipes.NUM_FRAMES) / recipes.FPS
    for film in recipes.SETS[which]:
        poses = film.poses(times, 0.8)
        angles = np.degrees(_core.angles_from(poses, poses[0]))
        if film.head == "turned":
            last_half = angles[len(angles) // 2 :]
            assert last_half.min() > 25 and last_half.max() < 46
        else:
            assert angles.max() < 8


def test_both_sizes_show_the_same():
    film = recipes.SETS["tuning"][0]
    poses, small = films._camera(film, "320x240")
    large_poses, large = films._camera(film, "640x480")
    assert np.allclose(poses, large_poses)
    point = np.array([0.02, -0.03, 0.9])
    places = [(k @ point)[:2] / point[2] for k in (small, large)]
    assert np.allclose((places[1] + 0.5) / 2 - 0.5, places[0])


def test_a_halved_frame_keeps_the_colour_of_what_is_covered():
    frames = np.zeros((1, 2, 4, 4), np.uint8)
    frames[0, 0, 0] = (200, 100, 50, 255)
    frames[0, :, 2:] = (40, 40, 40, 255)
    small = films._halved(frames)[0, 0]
    assert small[0].tolist() == [200, 100, 50, 64]
    assert small[1].tolist() == [40, 40, 40, 255]


def test_a_sheet_follows_its_points_and_stops_at_a_slit():
    rows, cols = 6, 10
    across, up = np.meshgrid(np.arange(cols), np.arange(rows))
    vertices = np.column_stack([across.ravel(), up.ravel(), 0 * up.ravel()]) / 100.0
    corner = np.array(
        [r * cols + c for r in range(rows - 1) for c in range(cols - 1) if r != 2]  # the slit
    )
    triangles = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + cols], 1),
            np.stack([corner + 1, corner + cols + 1, corner + cols], 1),
        ]
    )
    part = np.zeros(len(triangles), int)
    sheet = head_mesh.HeadMesh(vertices, triangles, part, {}, len(vertices))
    goal = np.array([0, -0.004, 0])
    moved = shapes._sheet(sheet, {cols + 5: goal}, 4.0)
    assert np.allclose(moved[cols + 5], goal, atol=4e-4)
    assert moved[cols + 4, 1] < -0.001
    assert np.abs(moved[3 * cols :]).max() < 1e-9


@pytest.mark.skipif(
    not (FETCHED / "face.obj").is_file(), reason="scripts/fetch_foreign_face fetches this face"
)
def test_a_head_of_the_fetched_mask_opens_its_mouth_and_differs_from_others():
    one, other = head_mesh.person(1), head_mesh.person(2)
    assert 0.001 < np.abs(one.vertices - other.vertices)[: one.num_mask].max() < 0.03
    surprise = shapes.shapes(one, 1)[shapes.NAMES.index("surprise")]
    apart = (one.vertices + surprise)[[13, 14], 1]
    assert apart[0] - apart[1] > 0.006
    eyes = [part in (4, 5) for part in one.part]
    assert np.abs(surprise[np.unique(one.triangles[eyes])]).max() == 0


def test_settings_of_the_tracker_are_numbers_that_it_has():
    variant = foreign.variant_of(["crop_height=400", "model_error=2e-4"])
    assert variant.tracker == {"crop_height": 400, "model_error": 2e-4}
    for wrong in ("crop_heigth=3", "crop_height=x", "check=1"):
        with pytest.raises(InvalidInput, match="--tracker"):
            foreign.variant_of([wrong])
