# SPDX-License-Identifier: GPL-3.0-or-later
"""Which bones turn the eyes, and by what values."""

import numpy as np
import pytest
from mimetic.retarget.bone_channels import TURN, BoneChannel
from mimetic.retarget.gaze_controls import GazeControls, gaze_channel

DISTANCE = 25.0  # centimetres, of what eyes look at
GAZE = np.array([[0.0, 0, 0, 0], [20, 10, 24, 10], [-30, -15, -26, -15]])
LEFT, UP = np.array([0.0, 0, 1]), np.array([-1.0, 0, 0])  # turns of a head that looks along -y


def aim(bone: str, axis: int, turn: np.ndarray, eyes: tuple[int, ...]):
    """A channel by which eyes follow what is a centimetre aside."""
    turns = np.zeros((2, 3))
    turns[list(eyes)] = 2 * np.arctan(1 / DISTANCE) * turn
    return gaze_channel(BoneChannel(bone, axis, False, True), turns, 1.0)


def own_and_common() -> list:
    return [
        *(aim("eyes", axis, way, (0, 1)) for axis, way in ((0, LEFT), (1, UP))),
        *(
            aim(f"eye.{side}", axis, way, (eye,))
            for eye, side in enumerate("LR")
            for axis, way in ((0, LEFT), (1, UP))
        ),
    ]


def look(x: float, z: float) -> np.ndarray:
    """Where an eye looks whose target is so many centimetres aside and up."""
    way = np.array([x, -DISTANCE, z])
    return way / np.linalg.norm(way)


def wanted(yaw: float, pitch: float) -> np.ndarray:
    yaw, pitch = np.radians([yaw, pitch])
    return np.array([np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)])


def test_each_eye_looks_at_its_own_bone():
    controls = GazeControls(own_and_common(), np.eye(4))
    values = dict(zip(controls.names, controls.values(GAZE).T, strict=True))
    assert not values["eyes along x"].any() and not values["eyes along y"].any()
    for row, angles in enumerate(GAZE):
        for eye, side in enumerate("LR"):
            seen = look(values[f"eye.{side} along x"][row], values[f"eye.{side} along y"][row])
            np.testing.assert_allclose(seen, wanted(*angles[2 * eye : 2 * eye + 2]), atol=1e-9)
    assert controls.undriven() == []


def test_a_common_bone_stands_in_and_eyes_without_one_are_told():
    controls = GazeControls(own_and_common(), np.eye(4))
    both = controls.without(["eye.L along x", "eye.L along y"])
    values = dict(zip(both.names, both.values(GAZE).T, strict=True))
    assert not values["eye.R along x"].any()
    mean = DISTANCE * np.tan(np.radians(22.0))
    assert values["eyes along x"][1] == pytest.approx(mean, rel=0.03)
    assert both.without(["eyes along x", "eyes along y"]).undriven() == ["L"]


def test_an_eye_turns_about_axes_that_lie_anyhow():
    axes = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    channels = [
        gaze_channel(BoneChannel("eye.L", axis, True, True), np.array([2 * TURN * way, 0 * way]), 1)
        for axis, way in enumerate(axes)
    ]
    controls = GazeControls(channels, np.eye(4), ("L",))
    vectors = TURN * controls.values(GAZE) @ axes
    np.testing.assert_allclose(vectors, controls.turn_of(GAZE, 0), atol=1e-12)
