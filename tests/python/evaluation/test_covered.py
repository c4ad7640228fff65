# SPDX-License-Identifier: GPL-3.0-or-later
"""What is painted before faces: where it lies, and when."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.score.scores import project
from mimetic.template.face_template import load_template
from sample_performance import make_performance

from evaluation.runs.covered import WAYS, figures
from evaluation.synthetic.motion import HeadMotion

NUM_FRAMES = 8
# Metres about an eye's centre that rims reach: 26 mm before it, they are aside in turned heads
REACH = 0.038


@pytest.fixture(scope="module")
def wearer():
    """A drawn person who turns the head before a wide camera of 320 x 240 pixels."""
    poses = HeadMotion(yaw=20).poses(np.arange(4 * NUM_FRAMES) / 30, 0.6, seed=3)
    return SimpleNamespace(
        head_pose=poses[::4],
        intrinsics=np.array([[250.0, 0, 159.5], [0, 250.0, 119.5], [0, 0, 1]]),
        neutral_vertices=np.asarray(load_template().vertices),
    )


def covered(way, wearer):
    """N x H x W: which pixels of grey pictures are painted over."""
    frames = np.full((NUM_FRAMES, 240, 320, 3), 200, np.uint8)
    shown = WAYS[way](frames, wearer)
    assert shown.shape == frames.shape and shown.dtype == np.uint8 and (frames == 200).all()
    return (shown != frames).any(3)


def pixels_to(points, wearer, i):
    """Points x H x W: how far each pixel is from each point (K,3) of the head, in its metres."""
    pose = wearer.head_pose[i]
    metre = wearer.intrinsics[0, 0] / (points @ pose[:3, :3].T + pose[:3, 3])[:, 2]
    places = np.stack(np.meshgrid(np.arange(320), np.arange(240)), -1)
    apart = places - project(points, pose, wearer.intrinsics)[:, None, None]
    return np.linalg.norm(apart, axis=-1) / metre[:, None, None]


def mouth_of(wearer):
    template = load_template()
    corners = [template.landmark(f"mouth_corner.{side}") for side in "LR"]
    return wearer.neutral_vertices[corners]


def test_glasses_lie_about_the_eyes_and_nowhere_else(wearer):
    eyes, _ = load_template().eye_spheres(wearer.neutral_vertices)
    thick, thin = (covered(way, wearer) for way in ("glasses", "thin glasses"))
    assert 0.2 * thick.mean() < thin.mean() < 0.7 * thick.mean()
    for i in range(NUM_FRAMES):
        from_eyes = pixels_to(eyes, wearer, i)
        for painted in (thick[i], thin[i]):
            assert (painted & (from_eyes < REACH)).any((1, 2)).all()
            assert not painted[(from_eyes > REACH).all(0)].any()
            assert not painted[(from_eyes < 0.004).any(0)].any()  # seen through the lens


def test_the_hand_covers_the_mouth_in_the_middle_third_alone(wearer):
    painted, mouth = covered("hand", wearer), mouth_of(wearer)
    times = np.arange(NUM_FRAMES) / (NUM_FRAMES - 1)
    for i in np.flatnonzero((times >= 1 / 3) & (times <= 2 / 3)):
        from_corners = pixels_to(mouth, wearer, i)
        assert painted[i][(from_corners < 0.005).any(0)].all()
    assert not painted[(times < 0.2) | (times > 0.8)].any()


def test_the_microphone_stands_still_before_the_chin(wearer):
    frames = np.full((NUM_FRAMES, 240, 320, 3), 200, np.uint8)
    shown = WAYS["microphone"](frames, wearer)
    assert (shown == shown[0]).all()
    painted = (shown[0] != 200).any(2)
    below = mouth_of(wearer).mean(0) - (0, 0.02, 0)
    assert painted[pixels_to(below[None], wearer, NUM_FRAMES // 2)[0] < 0.006].all()
    assert painted[-1].any()  # the stand
    assert 0.005 < painted.mean() < 0.1


def test_figures_say_how_far_the_head_is_turned_and_what_is_held():
    std = {"articulator_values_std": np.full((12, 2), 0.05)}
    first = make_performance(quality=np.ones(12), **std)
    turn, cosine, sine = np.eye(4), np.cos(np.radians(3)), np.sin(np.radians(3))
    turn[:2, :2] = [[cosine, -sine], [sine, cosine]]
    quality = np.where(np.arange(12) < 5, 0.1, 1.0)
    second = make_performance(quality=quality, head_pose=first.head_pose @ turn, **std)
    found = figures(first, second)
    assert found["turn"] == pytest.approx(3)
    assert found["held"] == 5
    assert found["within"] == 1
